// A job's way through the farm, and that its result does not depend on who rendered what when.

#include <gmock/gmock.h>

#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

using ::testing::HasSubstr;

TEST_F(FarmTest, RendersAJobToItsEnd) {
  const JobSpec spec = Spec(40, 24, 512);
  const JobId job = Submit(spec);
  EXPECT_EQ(Status(job).state, JobState::kQueued);
  EXPECT_THAT(Status(job).message, HasSubstr("waits for a worker"));
  Join();
  RunAll();
  const JobStatus status = Status(job);
  EXPECT_EQ(status.state, JobState::kDone);
  EXPECT_EQ(status.fraction, 1);
  EXPECT_EQ(status.samples, 40u * 24 * 512);
  EXPECT_EQ(status.spp_mean, 512);
  EXPECT_GT(status.rel_error, 0);
  EXPECT_GT(status.render_s, 0);
  EXPECT_EQ(status.worst_tiles.size(), 5u);
  EXPECT_NE(status.result, Digest());
  // The mean of the fake picture: (0.2 + 0.01 x + 0.1 c) for x from 0 to 39.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(status.mean_rgb[c], 0.395 + 0.1 * c, 1e-3);
}

TEST_F(AnyWorkers, GiveTheSameDigest) {
  JobSpec spec = Spec(50, 34, 1024, 16);
  spec.crop = {3, 5, 48, 34};
  spec.channels.alpha = true;
  const Digest expected = DigestWith(spec, 1, 1);
  EXPECT_EQ(farm_->List().back().samples, static_cast<uint64_t>(spec.crop.Pixels()) * spec.spp);
  for (const size_t workers : {2, 3, 7}) EXPECT_EQ(DigestWith(spec, workers, workers), expected);
  for (const int tile : {8, 32, 64}) {
    spec.tile = tile;
    EXPECT_EQ(DigestWith(spec, 3, 100 + static_cast<uint64_t>(tile)), expected) << "tile " << tile;
  }
  spec.seed = 1;
  EXPECT_NE(DigestWith(spec, 2, 1), expected);
}

TEST_F(FarmTest, MakesOneJobOfARepeatedRequest) {
  const JobId job = Submit(Spec(16, 16, 8), "request");
  EXPECT_EQ(Submit(Spec(16, 16, 8), "request"), job);
  EXPECT_NE(Submit(Spec(16, 16, 8), "another"), job);
  EXPECT_NE(Submit(Spec(16, 16, 8)), Submit(Spec(16, 16, 8)));
  EXPECT_EQ(farm_->List().size(), 4u);
}

TEST_F(FarmTest, RefusesOtherJobUnderTheSameRequest) {
  Submit(Spec(16, 16, 8), "request");
  const auto other = farm_->Submit(Spec(16, 16, 16), "request", now_);
  EXPECT_EQ(other.status().code(), absl::StatusCode::kAlreadyExists);
}

TEST_F(FarmTest, RefusesAJobWhoseFilesAreMissing) {
  JobSpec spec = Spec(16, 16, 8);
  spec.bundle.files.push_back({"texture.png", DigestOf("never sent"), 10});
  const auto job = farm_->Submit(spec, "", now_);
  EXPECT_EQ(job.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(job.status().message()), HasSubstr("texture.png"));
}

TEST_F(FarmTest, ServesFilesInChunksAsTheyAreAskedFor) {
  std::string content(kFileChunkBytes + 1000, 'x');
  content.back() = 'y';
  auto upload = farm_->BeginUpload(DigestOf(content), content.size());
  ASSERT_TRUE((*upload)->Append(content).ok());
  ASSERT_TRUE((*upload)->Finish().ok());
  FakeWorker& worker = Join();
  worker.link().Take();
  std::string got;
  while (got.size() < content.size()) {
    worker.Send(FileRequest{DigestOf(content), got.size()}, now_);
    const auto messages = worker.link().Take();
    ASSERT_EQ(messages.size(), 1u);
    const FileChunk& chunk = std::get<FileChunk>(messages[0]);
    ASSERT_EQ(chunk.error, "");
    ASSERT_EQ(chunk.total, content.size());
    ASSERT_EQ(chunk.offset, got.size());
    got += chunk.data;
  }
  EXPECT_EQ(got, content);
  worker.Send(FileRequest{DigestOf("unknown"), 0}, now_);
  EXPECT_NE(std::get<FileChunk>(worker.link().Take()[0]).error, "");
}

TEST_F(FarmTest, TellsSubscribersUntilTheEnd) {
  const JobId job = Submit(Spec(64, 64, 256));
  std::vector<JobStatus> told;
  ASSERT_TRUE(farm_->Subscribe(job, [&](const JobStatus& s) { told.push_back(s); }).ok());
  Join();
  const SteadyTime start = now_;
  RunAll();
  Pass(std::chrono::seconds(2));
  ASSERT_GE(told.size(), 3u);
  EXPECT_EQ(told.back().state, JobState::kDone);
  const auto final_calls =
      std::count_if(told.begin(), told.end(), [](const JobStatus& s) { return IsFinal(s.state); });
  EXPECT_EQ(final_calls, 1);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end(),
                             [](const auto& a, const auto& b) { return a.fraction < b.fraction; }));
  // At most four a second beside the changes of state.
  EXPECT_LE(told.size(), 4 * SecondsBetween(start, now_) + 3);
}

TEST_F(FarmTest, TellsSubscribersFourTimesASecondAtMost) {
  const JobId job = Submit(Spec(64, 64, 256));
  FakeWorker& worker = Join();
  size_t told = 0;
  ASSERT_TRUE(farm_->Subscribe(job, [&](const JobStatus&) { ++told; }).ok());
  for (int i = 0; i < 10; ++i) {
    // Failures, others that subscribe and changes of state are no reason to tell more often.
    ASSERT_TRUE(farm_->Pause(job, now_).ok());
    ASSERT_TRUE(farm_->Resume(job, now_).ok());
    ASSERT_TRUE(farm_->Subscribe(job, [](const JobStatus&) {}).ok());
    worker.Send(UnitFailure{job, 0, {9, 9, 9}, "nonsense", "", false}, now_);
    Pass(kTick);
  }
  EXPECT_GE(told, 3u);
  EXPECT_LE(told, 4u);
  ASSERT_TRUE(farm_->Cancel(job, now_).ok());
  EXPECT_LE(told, 5u);
}

TEST_F(FarmTest, TellsSubscribersTheEndOfAJobDeletedAtOnce) {
  const JobId job = Submit(Spec(16, 16, 8));
  FakeWorker& worker = Join();
  std::vector<JobState> told;
  ASSERT_TRUE(farm_->Subscribe(job, [&](const JobStatus& s) { told.push_back(s.state); }).ok());
  worker.Vanish(now_);
  for (int i = 0; i < 2; ++i) Join().Vanish(now_);
  ASSERT_EQ(Status(job).state, JobState::kFailed);
  ASSERT_TRUE(farm_->Delete(job).ok());
  EXPECT_THAT(told, ::testing::ElementsAre(JobState::kFailed));
}

TEST_F(FarmTest, TellsALateSubscriberTheEnd) {
  const JobId job = Submit(Spec(16, 16, 8));
  Join();
  RunAll();
  std::vector<JobState> told;
  const auto handle = farm_->Subscribe(job, [&](const JobStatus& s) { told.push_back(s.state); });
  Pass(std::chrono::seconds(1));
  EXPECT_THAT(told, ::testing::ElementsAre(JobState::kDone));
  farm_->Unsubscribe(*handle);
}

TEST_F(FarmTest, ReportsSamplesThatAreNotFinite) {
  const JobId job = Submit(Spec(16, 16, 8, 16));
  FakeWorker& worker = Join();
  UnitResult result = *worker.Render();
  result.partial.nonfinite[3] = 2;
  result.partial.replays = {"strata replay scene.pbrt --pixel 3,0"};
  worker.Send(result, now_);
  const JobStatus status = Status(job);
  EXPECT_EQ(status.state, JobState::kDone);
  EXPECT_EQ(status.nonfinite, 2u);
  EXPECT_THAT(status.message, HasSubstr("2 samples were not finite"));
  EXPECT_THAT(LogText(job), HasSubstr("strata replay scene.pbrt --pixel 3,0"));
  const ImageLayers image = *farm_->Image(job);
  const float* pixel = &image.values[3 * image.channels.size()];
  EXPECT_EQ(static_cast<uint32_t>(pixel[image.channels.size() - 1]) & kFlagNonFinite,
            kFlagNonFinite);
}

TEST_F(FarmTest, KeepsOthersOutOfItsDirectory) {
  const JobId job = Submit(Spec(16, 16, 8));
  const std::filesystem::path film = directory_.path() / "films" / (job + ".film");
  FarmOptions options;
  options.state_dir = directory_.path();
  const auto other = Farm::Create(options, NewMemoryJobStore());
  EXPECT_EQ(other.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(other.status().message()), HasSubstr("another coordinator"));
  EXPECT_TRUE(std::filesystem::exists(film));
  farm_.reset();
  EXPECT_TRUE(Farm::Create(options, NewMemoryJobStore()).ok());
}

TEST_F(FarmTest, DeletesEndedJobsAlone) {
  const JobId job = Submit(Spec(16, 16, 8));
  EXPECT_EQ(farm_->Delete(job).code(), absl::StatusCode::kFailedPrecondition);
  ASSERT_TRUE(farm_->Cancel(job, now_).ok());
  EXPECT_TRUE(std::filesystem::exists(directory_.path() / "films" / (job + ".film")));
  ASSERT_TRUE(farm_->Delete(job).ok());
  EXPECT_FALSE(std::filesystem::exists(directory_.path() / "films" / (job + ".film")));
  EXPECT_EQ(farm_->Get(job).status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace strata
