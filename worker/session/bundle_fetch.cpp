#include "worker/session/bundle_fetch.h"

#include <algorithm>
#include <set>
#include <utility>

namespace strata {
namespace {

constexpr int kWindow = 8;

}  // namespace

absl::StatusOr<CacheSource> BundleFetch::Run() {
  std::map<std::string, std::filesystem::path> paths;
  std::vector<const BundleFile*> missing;
  std::set<std::string> missing_names;
  for (const BundleFile& file : bundle_.files) {
    const absl::StatusOr<std::filesystem::path> path = cache_.Find(file);
    if (path.ok()) {
      paths[file.path] = *path;
    } else if (missing_names.insert(FileCache::NameOf(file)).second) {
      missing.push_back(&file);
    }
  }
  STRATA_RETURN_IF_ERROR(FetchMissing(missing));
  for (const BundleFile& file : bundle_.files) {
    if (paths.contains(file.path)) continue;
    const absl::StatusOr<std::filesystem::path> path = cache_.Find(file);
    // Another process that shares the directory may have made room.
    if (!path.ok()) return absl::UnavailableError(path.status().message());
    paths[file.path] = *path;
  }
  return CacheSource(std::move(paths));
}

absl::Status BundleFetch::FetchMissing(const std::vector<const BundleFile*>& files) {
  auto next = files.begin();
  while (next != files.end() || !incoming_.empty()) {
    while (unanswered_ < kWindow) {
      if (!incoming_.empty() && !incoming_.back().asked) {
        STRATA_RETURN_IF_ERROR(AskMore(incoming_.back()));
      } else if (next != files.end()) {
        Incoming& file = incoming_.emplace_back();
        file.file = *next++;
        STRATA_ASSIGN_OR_RETURN(file.download, cache_.Begin(*file.file));
      } else {
        break;
      }
    }
    STRATA_ASSIGN_OR_RETURN(const FileChunk chunk, NextChunk());
    STRATA_RETURN_IF_ERROR(Accept(chunk));
  }
  return absl::OkStatus();
}

absl::Status BundleFetch::AskMore(Incoming& file) {
  ask_({file.file->digest, file.next});
  file.unanswered.insert(file.next);
  ++unanswered_;
  file.next += kFileChunkBytes;
  file.asked = file.next >= file.file->bytes;
  MutexLock lock(mutex_);
  return aborted_;
}

absl::Status BundleFetch::Accept(const FileChunk& chunk) {
  const auto file = std::find_if(incoming_.begin(), incoming_.end(), [&](const Incoming& f) {
    return f.file->digest == chunk.digest && f.unanswered.contains(chunk.offset);
  });
  if (file == incoming_.end()) return absl::OkStatus();  // Asked for before a link broke.
  if (!chunk.error.empty()) {
    return absl::NotFoundError(absl::StrCat(file->file->path, ": ", chunk.error));
  }
  const uint64_t expected = std::min(kFileChunkBytes, file->file->bytes - chunk.offset);
  if (chunk.total != file->file->bytes || chunk.data.size() != expected) {
    return absl::DataLossError(absl::StrCat(file->file->path,
                                            ": has another size than its job "
                                            "says; upload it again"));
  }
  STRATA_RETURN_IF_ERROR(file->download->Write(chunk.offset, chunk.data));
  file->unanswered.erase(chunk.offset);
  --unanswered_;
  if (!file->asked || !file->unanswered.empty()) return absl::OkStatus();
  STRATA_RETURN_IF_ERROR(file->download->Finish());
  incoming_.erase(file);
  return absl::OkStatus();
}

absl::StatusOr<FileChunk> BundleFetch::NextChunk() {
  MutexLock lock(mutex_);
  while (chunks_.empty() && aborted_.ok()) changed_.Wait(mutex_);
  if (!aborted_.ok()) return aborted_;
  FileChunk chunk = std::move(chunks_.front());
  chunks_.pop_front();
  return chunk;
}

void BundleFetch::Offer(FileChunk chunk) {
  MutexLock lock(mutex_);
  // More than the window was never asked for.
  if (chunks_.size() < 2 * kWindow) chunks_.push_back(std::move(chunk));
  changed_.NotifyAll();
}

void BundleFetch::Abort(absl::Status reason) {
  MutexLock lock(mutex_);
  aborted_ = std::move(reason);
  changed_.NotifyAll();
}

}  // namespace strata
