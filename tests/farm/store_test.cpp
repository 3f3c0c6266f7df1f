// The stores of jobs and files.

#include <gmock/gmock.h>

#include <fstream>

#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

using ::testing::HasSubstr;

TEST(MemoryJobStoreTest, KeepsWhatItIsGiven) {
  const auto store = NewMemoryJobStore();
  JobSpec spec;
  spec.name = "a";
  const JobId first = *store->AddJob(spec, "request", 12.5);
  const JobId second = *store->AddJob(spec, "", 13);
  EXPECT_EQ(*store->FindRequest("request"), first);
  EXPECT_EQ(*store->FindRequest("another"), std::nullopt);
  ASSERT_TRUE(store->SetState(first, JobState::kFailed, "why").ok());
  ASSERT_TRUE(store->SetPriority(first, 7).ok());
  ASSERT_TRUE(store->SaveRound(first, 0, "plan").ok());
  EXPECT_FALSE(store->SaveRound(first, 0, "plan").ok()) << "a round is saved once";
  EXPECT_EQ(*store->Rounds(first), std::vector<std::string>{"plan"});
  const std::vector<StoredJob> jobs = *store->Jobs();
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].state, JobState::kFailed);
  EXPECT_EQ(jobs[0].message, "why");
  EXPECT_EQ(jobs[0].spec.priority, 7);
  EXPECT_EQ(jobs[0].submitted_unix_s, 12.5);
  ASSERT_TRUE(store->DeleteJob(first).ok());
  EXPECT_EQ(store->SetState(first, JobState::kDone, "").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(*store->FindRequest("request"), std::nullopt);
  EXPECT_EQ(store->Jobs()->size(), 1u);
  EXPECT_EQ(store->Jobs()->front().id, second);
}

TEST(MemoryJobStoreTest, BoundsTheLog) {
  const auto store = NewMemoryJobStore();
  const JobId job = *store->AddJob({}, "", 0);
  for (size_t i = 0; i < JobStore::kMaxLogLines + 10; ++i) {
    ASSERT_TRUE(store->AppendLog(job, {0, "info", std::to_string(i)}).ok());
  }
  const std::vector<LogLine> log = *store->Log(job);
  ASSERT_EQ(log.size(), JobStore::kMaxLogLines);
  EXPECT_EQ(log.front().text, "10");
}

TEST(MemoryJobStoreTest, DoesNotUseAnIdAgainAfterARestart) {
  const TestDirectory directory;
  const std::filesystem::path file = directory.path() / "last-job";
  EXPECT_EQ(*NewMemoryJobStore(file)->AddJob({}, "", 0), "j-1");
  const auto again = NewMemoryJobStore(file);
  EXPECT_TRUE(again->Jobs()->empty());
  EXPECT_EQ(*again->AddJob({}, "", 0), "j-2");
}

class FileStoreTest : public ::testing::Test {
 protected:
  std::filesystem::path Kept() const { return directory_.path() / "files"; }
  size_t FilesOnDisk() const {
    size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(Kept())) {
      files += entry.is_regular_file();
    }
    return files;
  }
  TestDirectory directory_;
  FileStore store_ = *FileStore::Create(Kept());
};

TEST_F(FileStoreTest, KeepsAFileByItsContent) {
  const std::string content = "some bytes";
  auto upload = *store_.BeginUpload(DigestOf(content), content.size());
  EXPECT_FALSE(store_.Contains(DigestOf(content)));
  ASSERT_TRUE(upload->Append("some ").ok());
  ASSERT_TRUE(upload->Append("bytes").ok());
  ASSERT_TRUE(upload->Finish().ok());
  EXPECT_TRUE(store_.Contains(DigestOf(content)));
  EXPECT_EQ(store_.Read(DigestOf(content), 5, 3)->data, "byt");
  EXPECT_EQ(store_.Read(DigestOf(content), 5, 300)->data, "bytes");
  EXPECT_EQ(store_.Read(DigestOf(content), 10, 3)->data, "");
  EXPECT_EQ(store_.Read(DigestOf(content), 11, 3).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(store_.Read(DigestOf(""), 0, 3).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(FileStoreTest, KeepsNothingThatIsNotWhatWasAnnounced) {
  const Digest digest = DigestOf("right");
  EXPECT_EQ((*store_.BeginUpload(digest, 5))->Append("too long").code(),
            absl::StatusCode::kOutOfRange);
  auto short_one = *store_.BeginUpload(digest, 5);
  ASSERT_TRUE(short_one->Append("rig").ok());
  EXPECT_EQ(short_one->Finish().code(), absl::StatusCode::kDataLoss);
  auto wrong = *store_.BeginUpload(digest, 5);
  ASSERT_TRUE(wrong->Append("wrong").ok());
  EXPECT_THAT(std::string(wrong->Finish().message()), HasSubstr("digest"));
  short_one.reset();
  wrong.reset();
  EXPECT_FALSE(store_.Contains(digest));
  EXPECT_EQ(FilesOnDisk(), 0u);
}

TEST_F(FileStoreTest, TakesTheSameFileTwiceAtOnce) {
  auto a = *store_.BeginUpload(DigestOf("x"), 1);
  auto b = *store_.BeginUpload(DigestOf("x"), 1);
  ASSERT_TRUE(a->Append("x").ok());
  ASSERT_TRUE(b->Append("x").ok());
  EXPECT_TRUE(a->Finish().ok());
  EXPECT_TRUE(b->Finish().ok());
  EXPECT_EQ(FilesOnDisk(), 1u);
}

TEST_F(FileStoreTest, ForgetsUploadsOfAnEarlierLife) {
  std::ofstream(Kept() / "incoming" / "half") << "half";
  EXPECT_EQ(FilesOnDisk(), 1u);
  EXPECT_TRUE(FileStore::Create(Kept()).ok());
  EXPECT_EQ(FilesOnDisk(), 0u);
}

}  // namespace
}  // namespace strata
