#pragma once

#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <set>
#include <vector>

#include "common/messages.h"
#include "common/sync.h"
#include "worker/session/file_cache.h"

namespace strata {

/// Brings the files of a bundle into a cache over a link. Eight requests are kept on their way, so
/// that many small files do not wait for the network one by one, and memory stays bounded.
class BundleFetch {
 public:
  using Ask = std::function<void(const FileRequest&)>;

  /// `ask` sends a request; it is called from Run.
  BundleFetch(FileCache& cache, const Bundle& bundle, Ask ask)
      : cache_(cache), bundle_(bundle), ask_(std::move(ask)) {}

  /// Returns when every file is in the cache; who calls holds them there (FileCache::Hold) before
  /// and for as long as it reads them. NOT_FOUND or DATA_LOSS when the coordinator cannot
  /// give a file; UNAVAILABLE or RESOURCE_EXHAUSTED when this machine cannot keep it; the status of
  /// Abort when that was called.
  absl::StatusOr<CacheSource> Run();

  /// An answer. One that was not asked for is dropped. Any thread.
  void Offer(FileChunk chunk);
  /// Ends Run with this error. Any thread.
  void Abort(absl::Status reason);

 private:
  /// A file on its way.
  struct Incoming {
    const BundleFile* file = nullptr;
    std::unique_ptr<FileCache::Download> download;
    uint64_t next = 0;              ///< First byte not asked for.
    bool asked = false;             ///< All of it was asked for.
    std::set<uint64_t> unanswered;  ///< Offsets.
  };

  /// Fetches those of `files` that are not in the cache.
  absl::Status FetchMissing(const std::vector<const BundleFile*>& files);
  absl::Status AskMore(Incoming& file);
  absl::Status Accept(const FileChunk& chunk);
  absl::StatusOr<FileChunk> NextChunk();

  FileCache& cache_;
  const Bundle& bundle_;
  const Ask ask_;
  std::list<Incoming> incoming_;  ///< Run's alone, as is the next.
  int unanswered_ = 0;
  Mutex mutex_;
  CondVar changed_;
  std::deque<FileChunk> chunks_ STRATA_GUARDED_BY(mutex_);
  absl::Status aborted_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
