#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bundle.h"
#include "common/status.h"
#include "common/sync.h"
#include "worker/scene/file_source.h"

namespace strata {

/// Files of scenes on disk, by content, kept between runs: DIRECTORY/ab/abcdef... with the
/// extension of the path in the bundle, by which image readers know the format. Files appear by
/// rename, whole and verified. When they take more than the limit, those used longest ago go, but
/// none that is held. Several workers may share a directory. Thread-safe.
class FileCache {
 public:
  /// UNAVAILABLE when the directory cannot be made or read. Takes up what is there; leftovers of
  /// broken downloads are removed.
  static absl::StatusOr<std::unique_ptr<FileCache>> Open(std::filesystem::path directory,
                                                         uint64_t limit_bytes);

  /// The name of a bundle's file in the cache: its digest and the extension of its path.
  static std::string NameOf(const BundleFile& file);

  /// Keeps files from being removed to make room, whether they are there yet or not.
  class Hold {
   public:
    Hold(FileCache& cache, const std::vector<BundleFile>& files);
    ~Hold();
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    FileCache& cache_;
    std::vector<std::string> names_;
  };

  /// Where a file lies. Reads it and compares the digest: NOT_FOUND when it is not there or was
  /// found damaged, and then removed.
  absl::StatusOr<std::filesystem::path> Find(const BundleFile& file);

  /// One file on its way in; dropped without a trace unless Finish succeeds.
  class Download {
   public:
    ~Download();
    Download(const Download&) = delete;
    Download& operator=(const Download&) = delete;

    /// Blocks may come in any order. RESOURCE_EXHAUSTED when the disk is full.
    absl::Status Write(uint64_t offset, std::string_view data);
    /// DATA_LOSS when the content is not that of the digest.
    absl::Status Finish();

   private:
    friend class FileCache;
    Download(FileCache& cache, BundleFile file, std::filesystem::path temporary, int descriptor);
    void Close();

    FileCache& cache_;
    BundleFile file_;
    std::filesystem::path temporary_;
    int descriptor_;
  };
  absl::StatusOr<std::unique_ptr<Download>> Begin(const BundleFile& file);

 private:
  struct Entry {
    uint64_t bytes = 0;  ///< 0: not there yet.
    uint64_t last_use = 0;
    int holds = 0;
  };

  FileCache(std::filesystem::path directory, uint64_t limit_bytes)
      : directory_(std::move(directory)), limit_bytes_(limit_bytes) {}
  absl::Status Scan() STRATA_EXCLUDES(mutex_);
  std::filesystem::path PathOf(const std::string& name) const;
  void Add(const std::string& name, uint64_t bytes) STRATA_EXCLUDES(mutex_);
  void Forget(const std::string& name) STRATA_EXCLUDES(mutex_);
  void MakeRoom() STRATA_REQUIRES(mutex_);

  const std::filesystem::path directory_;
  const uint64_t limit_bytes_;
  Mutex mutex_;
  std::map<std::string, Entry> entries_ STRATA_GUARDED_BY(mutex_);
  uint64_t bytes_ STRATA_GUARDED_BY(mutex_) = 0;
  uint64_t uses_ STRATA_GUARDED_BY(mutex_) = 0;  ///< Counts up: the order of uses.
};

/// A bundle whose files were all found in a cache, as the reader of scenes wants it.
class CacheSource : public FileSource {
 public:
  /// `paths` leads from bundle paths to files.
  explicit CacheSource(std::map<std::string, std::filesystem::path> paths)
      : paths_(std::move(paths)) {}
  absl::StatusOr<std::filesystem::path> Locate(const std::string& bundle_path) const override;

 private:
  std::map<std::string, std::filesystem::path> paths_;
};

}  // namespace strata
