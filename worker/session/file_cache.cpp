#include "worker/session/file_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPartSuffix = ".part";
constexpr size_t kMaxExtension = 16;
constexpr auto kLeftoverAge = std::chrono::hours(1);

absl::Status WriteError(const fs::path& path, int error) {
  const std::string text = absl::StrCat(path.string(), ": ", std::strerror(error));
  return error == ENOSPC || error == EDQUOT ? absl::ResourceExhaustedError(text)
                                            : absl::UnavailableError(text);
}

/// Whether nothing was written to this temporary file for so long that its download is broken. The
/// process that made it may be one of another machine or container that shares the directory.
bool IsLeftover(const fs::path& path) {
  std::error_code error;
  const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path, error);
  return !error && age > kLeftoverAge;
}

}  // namespace

absl::StatusOr<std::unique_ptr<FileCache>> FileCache::Open(fs::path directory,
                                                           uint64_t limit_bytes) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) {
    return absl::UnavailableError(
        absl::StrCat(directory.string(), ": cannot be made: ", error.message()));
  }
  std::unique_ptr<FileCache> cache(new FileCache(std::move(directory), limit_bytes));
  STRATA_RETURN_IF_ERROR(cache->Scan());
  return cache;
}

absl::Status FileCache::Scan() {
  struct Found {
    fs::file_time_type used;
    std::string name;
    uint64_t bytes;
  };
  std::vector<Found> found;
  std::error_code error;
  for (fs::recursive_directory_iterator it(directory_, error), end; !error && it != end;
       it.increment(error)) {
    std::error_code ignored;
    if (!it->is_regular_file(ignored)) continue;
    if (it->path().extension() == kPartSuffix) {
      if (IsLeftover(it->path())) fs::remove(it->path(), ignored);
    } else if (PathOf(it->path().filename().string()) == it->path()) {
      found.push_back(
          {it->last_write_time(ignored), it->path().filename().string(), it->file_size(ignored)});
    }
  }
  if (error) {
    return absl::UnavailableError(
        absl::StrCat(directory_.string(), ": cannot be read: ", error.message()));
  }
  std::sort(found.begin(), found.end(),
            [](const Found& a, const Found& b) { return a.used < b.used; });
  for (const Found& file : found) Add(file.name, file.bytes);
  return absl::OkStatus();
}

std::string FileCache::NameOf(const BundleFile& file) {
  std::string extension = fs::path(file.path).extension().string();
  const auto is_plain = [](char c) {
    return c == '.' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  if (extension.size() > kMaxExtension || extension == kPartSuffix ||
      !std::all_of(extension.begin(), extension.end(), is_plain)) {
    extension.clear();
  }
  return file.digest.Hex() + extension;
}

fs::path FileCache::PathOf(const std::string& name) const {
  return directory_ / name.substr(0, 2) / name;
}

FileCache::Hold::Hold(FileCache& cache, const std::vector<BundleFile>& files) : cache_(cache) {
  MutexLock lock(cache_.mutex_);
  for (const BundleFile& file : files) {
    names_.push_back(NameOf(file));
    ++cache_.entries_[names_.back()].holds;
  }
}

FileCache::Hold::~Hold() {
  MutexLock lock(cache_.mutex_);
  for (const std::string& name : names_) {
    const auto entry = cache_.entries_.find(name);
    if (--entry->second.holds == 0 && entry->second.bytes == 0) cache_.entries_.erase(entry);
  }
  cache_.MakeRoom();
}

absl::StatusOr<fs::path> FileCache::Find(const BundleFile& file) {
  const std::string name = NameOf(file);
  const fs::path path = PathOf(name);
  const absl::StatusOr<Digest> digest = DigestOfFile(path);
  if (digest.ok() && *digest == file.digest) {
    Add(name, file.bytes);
    std::error_code ignored;  // A cache that may not be touched is still good.
    fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
    return path;
  }
  if (digest.ok()) {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  Forget(name);
  return absl::NotFoundError(absl::StrCat(path.string(), ": not in the cache"));
}

void FileCache::Add(const std::string& name, uint64_t bytes) {
  MutexLock lock(mutex_);
  Entry& entry = entries_[name];
  bytes_ += bytes - entry.bytes;
  entry.bytes = bytes;
  entry.last_use = ++uses_;
  MakeRoom();
}

void FileCache::Forget(const std::string& name) {
  MutexLock lock(mutex_);
  const auto entry = entries_.find(name);
  if (entry == entries_.end()) return;
  bytes_ -= entry->second.bytes;
  entry->second.bytes = 0;
  if (entry->second.holds == 0) entries_.erase(entry);
}

void FileCache::MakeRoom() {
  while (bytes_ > limit_bytes_) {
    auto oldest = entries_.end();
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      if (it->second.holds > 0 || it->second.bytes == 0) continue;
      if (oldest == entries_.end() || it->second.last_use < oldest->second.last_use) oldest = it;
    }
    if (oldest == entries_.end()) return;
    std::error_code ignored;
    fs::remove(PathOf(oldest->first), ignored);
    bytes_ -= oldest->second.bytes;
    entries_.erase(oldest);
  }
}

absl::StatusOr<std::unique_ptr<FileCache::Download>> FileCache::Begin(const BundleFile& file) {
  const std::string name = NameOf(file);
  // A name that no process has, on whatever machine or in whatever container.
  std::string temporary = PathOf(absl::StrCat(name, ".XXXXXX", std::string(kPartSuffix))).string();
  std::error_code error;
  fs::create_directories(fs::path(temporary).parent_path(), error);
  const int descriptor =
      mkostemps(temporary.data(), static_cast<int>(kPartSuffix.size()), O_CLOEXEC);
  if (descriptor < 0) return WriteError(temporary, errno);
  fchmod(descriptor, 0644);
  return std::unique_ptr<Download>(new Download(*this, file, temporary, descriptor));
}

FileCache::Download::Download(FileCache& cache, BundleFile file, fs::path temporary, int descriptor)
    : cache_(cache),
      file_(std::move(file)),
      temporary_(std::move(temporary)),
      descriptor_(descriptor) {}

FileCache::Download::~Download() {
  Close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void FileCache::Download::Close() {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

absl::Status FileCache::Download::Write(uint64_t offset, std::string_view data) {
  while (!data.empty()) {
    const ssize_t written =
        pwrite(descriptor_, data.data(), data.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return WriteError(temporary_, errno);
    offset += static_cast<uint64_t>(written);
    data.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status FileCache::Download::Finish() {
  Close();
  STRATA_ASSIGN_OR_RETURN(const Digest digest, DigestOfFile(temporary_));
  if (digest != file_.digest) {
    return absl::DataLossError(
        absl::StrCat(file_.path, ": what was sent is not the file of this digest"));
  }
  const std::string name = NameOf(file_);
  std::error_code error;
  std::filesystem::rename(temporary_, cache_.PathOf(name), error);
  if (error) return WriteError(temporary_, error.value());
  cache_.Add(name, file_.bytes);
  return absl::OkStatus();
}

absl::StatusOr<fs::path> CacheSource::Locate(const std::string& bundle_path) const {
  const auto found = paths_.find(bundle_path);
  if (found == paths_.end()) {
    return absl::NotFoundError(absl::StrCat(bundle_path, ": not in the bundle"));
  }
  return found->second;
}

}  // namespace strata
