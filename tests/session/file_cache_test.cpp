#include "worker/session/file_cache.h"

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "tests/session/memory_farm.h"
#include "worker/session/bundle_fetch.h"

namespace strata {
namespace {

std::string Content(const BundleFile& file) { return std::string(file.bytes, file.path.front()); }

BundleFile FileOf(const std::string& path, uint64_t bytes) {
  BundleFile file{path, {}, bytes};
  file.digest = DigestOf(Content(file));
  return file;
}

absl::Status Store(FileCache& cache, const BundleFile& file) {
  STRATA_ASSIGN_OR_RETURN(const auto download, cache.Begin(file));
  STRATA_RETURN_IF_ERROR(download->Write(0, Content(file)));
  return download->Finish();
}

size_t FilesIn(const std::filesystem::path& directory) {
  size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
    count += entry.is_regular_file() ? 1 : 0;
  }
  return count;
}

TEST(FileCache, KeepsFilesWithTheirExtensionBetweenRuns) {
  ScratchDirectory directory;
  const BundleFile file = FileOf("textures/a.png", 100);
  {
    const auto cache = *FileCache::Open(directory / "cache", 1000);
    EXPECT_EQ(cache->Find(file).status().code(), absl::StatusCode::kNotFound);
    ASSERT_TRUE(Store(*cache, file).ok());
  }
  const auto cache = *FileCache::Open(directory / "cache", 1000);
  const absl::StatusOr<std::filesystem::path> path = cache->Find(file);
  ASSERT_TRUE(path.ok());
  EXPECT_EQ(path->extension(), ".png");
  EXPECT_EQ(*DigestOfFile(*path), file.digest);
}

TEST(FileCache, DamagedFilesAreFoundOutAndRemoved) {
  ScratchDirectory directory;
  const BundleFile file = FileOf("a.ply", 100);
  const auto cache = *FileCache::Open(directory / "cache", 1000);
  ASSERT_TRUE(Store(*cache, file).ok());
  std::ofstream(*cache->Find(file), std::ios::app) << "x";
  EXPECT_EQ(cache->Find(file).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(FilesIn(directory / "cache"), 0u);
  ASSERT_TRUE(Store(*cache, file).ok());
  EXPECT_TRUE(cache->Find(file).ok());
}

TEST(FileCache, WhatIsNotOfItsDigestIsNotKept) {
  ScratchDirectory directory;
  BundleFile file = FileOf("a.ply", 100);
  file.digest = DigestOf("other");
  const auto cache = *FileCache::Open(directory / "cache", 1000);
  EXPECT_EQ(Store(*cache, file).code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(FilesIn(directory / "cache"), 0u);
}

TEST(FileCache, TheOldestGoButNoneThatIsHeld) {
  ScratchDirectory directory;
  const auto cache = *FileCache::Open(directory / "cache", 250);
  const BundleFile a = FileOf("a", 100), b = FileOf("b", 100), c = FileOf("c", 100);
  ASSERT_TRUE(Store(*cache, a).ok());
  ASSERT_TRUE(Store(*cache, b).ok());
  ASSERT_TRUE(cache->Find(a).ok());  // Now b was used longest ago.
  ASSERT_TRUE(Store(*cache, c).ok());
  EXPECT_TRUE(cache->Find(a).ok());
  EXPECT_FALSE(cache->Find(b).ok());
  EXPECT_TRUE(cache->Find(c).ok());
  {
    const FileCache::Hold hold(*cache, {a, b, c});
    ASSERT_TRUE(Store(*cache, b).ok());
    for (const BundleFile& file : {a, b, c}) EXPECT_TRUE(cache->Find(file).ok());
  }
  EXPECT_EQ(FilesIn(directory / "cache"), 2u);
}

TEST(FileCache, LeftoversOfBrokenDownloadsAreRemoved) {
  ScratchDirectory directory;
  std::filesystem::create_directories(directory / "cache/ab");
  const std::filesystem::path old = directory / "cache/ab/abcd.000000.part";
  const std::filesystem::path recent = directory / "cache/ab/abcd.111111.part";
  std::ofstream(old) << "x";
  std::ofstream(recent) << "x";  // Another process may be at it.
  std::filesystem::last_write_time(
      old, std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  const auto cache = *FileCache::Open(directory / "cache", 250);
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(recent));
}

/// Answers requests out of order and some of them twice.
class Answerer {
 public:
  explicit Answerer(const Bundle& bundle) : bundle_(bundle) {}

  void Answer(const FileRequest& request, BundleFetch& fetch) {
    for (const BundleFile& file : bundle_.files) {
      if (file.digest != request.digest) continue;
      const std::string data = Content(file).substr(request.offset, kFileChunkBytes);
      waiting_.push_back({file.digest, request.offset, file.bytes, data, ""});
    }
    asked_ += 1;
    EXPECT_LE(waiting_.size(), 8u);
    // The whole window is asked for before anything is answered, the last one first.
    if (waiting_.size() < 8 && asked_ < Requests()) return;
    while (!waiting_.empty()) {
      fetch.Offer(waiting_.back());
      if (waiting_.size() % 3 == 0) fetch.Offer(waiting_.back());
      waiting_.pop_back();
    }
  }

 private:
  size_t Requests() const {
    size_t requests = 0;
    for (const BundleFile& file : bundle_.files) {
      requests += std::max<size_t>(1, (file.bytes + kFileChunkBytes - 1) / kFileChunkBytes);
    }
    return requests;
  }

  const Bundle& bundle_;
  size_t asked_ = 0;
  std::vector<FileChunk> waiting_;
};

TEST(BundleFetch, FilesOfAllSizesArriveInAnyOrder) {
  ScratchDirectory directory;
  const auto cache = *FileCache::Open(directory / "cache", uint64_t{1} << 30);
  Bundle bundle{"a.pbrt", {}};
  const uint64_t mebibyte = kFileChunkBytes;
  const std::pair<const char*, uint64_t> sizes[] = {
      {"a.pbrt", 10},          {"b.ply", 0},
      {"c.png", mebibyte},     {"d.png", mebibyte + 1},
      {"e.png", 9 * mebibyte}, {"f.png", 3 * mebibyte - 1},
      {"g/same.png", 5},       {"g/same2.exr", 5}};
  for (const auto& [path, bytes] : sizes) bundle.files.push_back(FileOf(path, bytes));
  Answerer answerer(bundle);
  std::unique_ptr<BundleFetch> fetch;
  fetch = std::make_unique<BundleFetch>(
      *cache, bundle, [&](const FileRequest& request) { answerer.Answer(request, *fetch); });
  const absl::StatusOr<CacheSource> source = fetch->Run();
  ASSERT_TRUE(source.ok()) << source.status().message();
  for (const BundleFile& file : bundle.files) {
    const absl::StatusOr<std::filesystem::path> path = source->Locate(file.path);
    ASSERT_TRUE(path.ok()) << path.status().message();
    EXPECT_EQ(*DigestOfFile(*path), file.digest);
  }
  EXPECT_EQ(source->Locate("z").status().code(), absl::StatusCode::kNotFound);
}

TEST(BundleFetch, ErrorsAndAborts) {
  ScratchDirectory directory;
  const auto cache = *FileCache::Open(directory / "cache", uint64_t{1} << 30);
  const Bundle bundle{"a.pbrt", {FileOf("a.pbrt", 10)}};
  std::unique_ptr<BundleFetch> fetch;
  const auto run = [&](auto answer) {
    fetch = std::make_unique<BundleFetch>(*cache, bundle, answer);
    return fetch->Run().status();
  };
  const Digest digest = bundle.files[0].digest;
  EXPECT_EQ(run([&](const FileRequest&) {
              fetch->Offer({digest, 0, 10, "", "gone"});
            }).code(),
            absl::StatusCode::kNotFound);
  EXPECT_EQ(run([&](const FileRequest&) {
              fetch->Offer({digest, 0, 9, "123456789", ""});
            }).code(),
            absl::StatusCode::kDataLoss);
  EXPECT_EQ(run([&](const FileRequest&) {
              fetch->Offer({digest, 0, 10, "1234567890", ""});
            }).code(),
            absl::StatusCode::kDataLoss);
  EXPECT_EQ(run([&](const FileRequest&) { fetch->Abort(absl::CancelledError("x")); }).code(),
            absl::StatusCode::kCancelled);
  fetch.reset();
  EXPECT_EQ(FilesIn(directory / "cache"), 0u);
}

}  // namespace
}  // namespace strata
