#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

#include "common/digest.h"
#include "common/status.h"

namespace strata {

/// Files by content, one file per digest in a directory (files/ab/cdef...). Thread-safe: a file
/// appears whole, by rename, or not at all.
class FileStore {
 public:
  static absl::StatusOr<FileStore> Create(std::filesystem::path directory);

  bool Contains(const Digest& digest) const;

  /// One file on its way in. Dropped without a trace unless Finish succeeds.
  class Upload {
   public:
    ~Upload();
    Upload(const Upload&) = delete;
    Upload& operator=(const Upload&) = delete;

    /// The next bytes of the file. OUT_OF_RANGE beyond the announced size.
    absl::Status Append(std::string_view data);
    /// DATA_LOSS when size or digest are not as announced; the file is then not kept.
    absl::Status Finish();

   private:
    friend class FileStore;
    Upload(std::filesystem::path temporary, std::filesystem::path target, const Digest& digest,
           uint64_t bytes);

    std::filesystem::path temporary_, target_;
    Digest digest_;
    uint64_t expected_ = 0, written_ = 0;
    std::ofstream file_;
    Sha256 sha_;
  };
  absl::StatusOr<std::unique_ptr<Upload>> BeginUpload(const Digest& digest, uint64_t bytes) const;

  struct Chunk {
    uint64_t total = 0;  ///< Bytes of the whole file.
    std::string data;    ///< Shorter than asked for at the end of the file alone.
  };
  /// NOT_FOUND for an unknown digest, OUT_OF_RANGE for an offset beyond the end.
  absl::StatusOr<Chunk> Read(const Digest& digest, uint64_t offset, uint64_t bytes) const;

 private:
  explicit FileStore(std::filesystem::path directory) : directory_(std::move(directory)) {}
  std::filesystem::path PathOf(const Digest& digest) const;

  std::filesystem::path directory_;
  std::unique_ptr<std::atomic<uint64_t>> serial_ =
      std::make_unique<std::atomic<uint64_t>>(0);  ///< Keeps the names of uploads apart.
};

}  // namespace strata
