#include "coordinator/file_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace strata {
namespace {

absl::Status FileError(const std::filesystem::path& path, std::string_view what) {
  return absl::UnavailableError(fmt::format("{}: {}", path.string(), what));
}

}  // namespace

absl::StatusOr<FileStore> FileStore::Create(std::filesystem::path directory) {
  std::error_code error;
  const std::filesystem::path incoming = directory / "incoming";
  std::filesystem::remove_all(incoming, error);  // What an earlier life left half done.
  std::filesystem::create_directories(incoming, error);
  if (error) return FileError(incoming, error.message());
  return FileStore(std::move(directory));
}

std::filesystem::path FileStore::PathOf(const Digest& digest) const {
  const std::string hex = digest.Hex();
  return directory_ / hex.substr(0, 2) / hex.substr(2);
}

bool FileStore::Contains(const Digest& digest) const {
  std::error_code error;
  return std::filesystem::exists(PathOf(digest), error);
}

absl::StatusOr<std::unique_ptr<FileStore::Upload>> FileStore::BeginUpload(const Digest& digest,
                                                                          uint64_t bytes) const {
  const std::filesystem::path target = PathOf(digest);
  std::error_code error;
  std::filesystem::create_directories(target.parent_path(), error);
  if (error) return FileError(target.parent_path(), error.message());
  const std::filesystem::path temporary =
      directory_ / "incoming" / fmt::format("{}.{}", digest.Hex(), ++*serial_);
  std::unique_ptr<Upload> upload(new Upload(temporary, target, digest, bytes));
  if (!upload->file_) return FileError(temporary, "cannot be created");
  return upload;
}

FileStore::Upload::Upload(std::filesystem::path temporary, std::filesystem::path target,
                          const Digest& digest, uint64_t bytes)
    : temporary_(std::move(temporary)),
      target_(std::move(target)),
      digest_(digest),
      expected_(bytes),
      file_(temporary_, std::ios::binary | std::ios::trunc) {}

FileStore::Upload::~Upload() {
  std::error_code error;
  std::filesystem::remove(temporary_, error);
}

absl::Status FileStore::Upload::Append(std::string_view data) {
  if (data.size() > expected_ - written_) {
    return absl::OutOfRangeError(
        fmt::format("file {}: more than the announced {} bytes", digest_.Hex(), expected_));
  }
  file_.write(data.data(), static_cast<std::streamsize>(data.size()));
  if (!file_) return FileError(temporary_, "cannot be written");
  sha_.Update(data);
  written_ += data.size();
  return absl::OkStatus();
}

absl::Status FileStore::Upload::Finish() {
  file_.close();
  if (!file_) return FileError(temporary_, "cannot be written");
  if (written_ != expected_) {
    return absl::DataLossError(fmt::format("file {}: {} bytes came where {} were announced",
                                           digest_.Hex(), written_, expected_));
  }
  const Digest digest = sha_.Finish();
  if (digest != digest_) {
    return absl::DataLossError(fmt::format("file {}: its content has the digest {}; send it again",
                                           digest_.Hex(), digest.Hex()));
  }
  std::error_code error;
  std::filesystem::rename(temporary_, target_, error);
  if (error) return FileError(target_, error.message());
  return absl::OkStatus();
}

absl::StatusOr<FileStore::Chunk> FileStore::Read(const Digest& digest, uint64_t offset,
                                                 uint64_t bytes) const {
  const std::filesystem::path path = PathOf(digest);
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return absl::NotFoundError(fmt::format("file {} is not here", digest.Hex()));
  Chunk chunk;
  chunk.total = static_cast<uint64_t>(file.tellg());
  if (offset > chunk.total) {
    return absl::OutOfRangeError(
        fmt::format("file {}: offset {} is beyond its end", digest.Hex(), offset));
  }
  chunk.data.resize(std::min(bytes, chunk.total - offset));
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(chunk.data.data(), static_cast<std::streamsize>(chunk.data.size()));
  if (!file) return FileError(path, "cannot be read");
  return chunk;
}

}  // namespace strata
