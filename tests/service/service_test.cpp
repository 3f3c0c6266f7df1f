#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <mutex>
#include <thread>

#include "common/wire/channel.h"
#include "common/wire/worker_messages.h"
#include "strata/v1/worker.grpc.pb.h"
#include "tests/service/farm_under_test.h"

namespace strata {
namespace {

using testing::HasSubstr;

TestScene SmallScene() { return OwnScene("cornell-box/cornell-box.pbrt"); }

/// More work than any test waits for.
TestScene EndlessJob() {
  TestScene scene = SmallScene();
  scene.spec.width = scene.spec.height = 1024;
  scene.spec.crop = {0, 0, 1024, 1024};
  scene.spec.spp = 1 << 16;
  return scene;
}

void ExpectError(const absl::Status& status, absl::StatusCode code, const std::string& text) {
  EXPECT_EQ(status.code(), code) << status.message();
  EXPECT_THAT(std::string(status.message()), HasSubstr(text));
}

TEST(Service, RefusesWhatMakesNoSense) {
  InProcessFarm farm(0, 1);
  FarmClient& client = farm.client();
  const TestScene good = SmallScene();
  ExpectError(client.Submit(good.spec, "r").status(), absl::StatusCode::kFailedPrecondition, "");
  ASSERT_TRUE(client.Upload(good.spec.bundle, good.root, nullptr).ok());
  ExpectError(client.Submit(good.spec, "").status(), absl::StatusCode::kInvalidArgument,
              "request_id");
  JobSpec spec = good.spec;
  spec.spp = 7;
  ExpectError(client.Submit(spec, "r").status(), absl::StatusCode::kInvalidArgument, "spp");
  spec = good.spec;
  spec.crop.x1 = 10'000;
  ExpectError(client.Submit(spec, "r").status(), absl::StatusCode::kInvalidArgument, "crop");
  spec = good.spec;
  spec.bundle.scene = "../outside.pbrt";
  ExpectError(client.Submit(spec, "r").status(), absl::StatusCode::kInvalidArgument, "outside");
  ExpectError(client.Get("j-99").status(), absl::StatusCode::kNotFound, "j-99");
  ExpectError(client.Get("j 1").status(), absl::StatusCode::kInvalidArgument, "job");
  ExpectError(client.Watch("j-99", [](const JobStatus&) { return true; }),
              absl::StatusCode::kNotFound, "j-99");
  ExpectError(client.Watch("", [](const JobStatus&) { return true; }),
              absl::StatusCode::kInvalidArgument, "job");
  ExpectError(client.FetchImage("j-99").status(), absl::StatusCode::kNotFound, "j-99");
  ExpectError(client.FetchImage("").status(), absl::StatusCode::kInvalidArgument, "job");
  ExpectError(client.SetPriority("j-1", 101), absl::StatusCode::kInvalidArgument, "priority");
  for (const auto change : {&FarmClient::Cancel, &FarmClient::Pause, &FarmClient::Resume,
                            &FarmClient::Retry, &FarmClient::Delete}) {
    ExpectError((client.*change)("j-99"), absl::StatusCode::kNotFound, "j-99");
  }
  ExpectError(client.Logs("j-99").status(), absl::StatusCode::kNotFound, "j-99");
}

TEST(Service, UploadsAreVerified) {
  InProcessFarm farm(0, 1);
  TestScene scene = SmallScene();
  const uint64_t bytes = scene.spec.bundle.files[0].bytes;
  uint64_t sent = 0, total = 0;
  ASSERT_TRUE(farm.client()
                  .Upload(scene.spec.bundle, scene.root,
                          [&](uint64_t s, uint64_t t) {
                            sent = s;
                            total = t;
                          })
                  .ok());
  EXPECT_EQ(sent, total);
  EXPECT_GE(total, bytes);
  sent = 0;
  ASSERT_TRUE(farm.client()
                  .Upload(scene.spec.bundle, scene.root, [&](uint64_t s, uint64_t) { sent = s; })
                  .ok());
  EXPECT_EQ(sent, 0u) << "what the server has is not sent again";
  BundleFile& file = scene.spec.bundle.files[0];
  file.digest = DigestOf("something else");
  const auto upload = [&] { return farm.client().Upload(scene.spec.bundle, scene.root, nullptr); };
  ExpectError(upload(), absl::StatusCode::kInvalidArgument,
              "file " + file.digest.Hex() + ": its content has the digest");
  file.bytes = bytes + 1;
  ExpectError(upload(), absl::StatusCode::kInvalidArgument, "were announced");
  file.bytes = bytes - 1;
  ExpectError(upload(), absl::StatusCode::kInvalidArgument, "more than the announced");
  file.bytes = bytes;
  scene.spec.bundle.files[0].path = "not-there.pbrt";
  ExpectError(farm.client().Upload(scene.spec.bundle, scene.root, nullptr),
              absl::StatusCode::kNotFound, "not-there.pbrt");
}

TEST(Service, OneRequestIsOneJob) {
  InProcessFarm farm(0, 1);
  const TestScene scene = SmallScene();
  ASSERT_TRUE(farm.client().Upload(scene.spec.bundle, scene.root, nullptr).ok());
  const absl::StatusOr<JobId> first = farm.client().Submit(scene.spec, "once");
  ASSERT_TRUE(first.ok()) << first.status().message();
  EXPECT_EQ(*farm.client().Submit(scene.spec, "once"), *first);
  EXPECT_NE(*farm.client().Submit(scene.spec, "twice"), *first);
  EXPECT_EQ(farm.client().List()->size(), 2u);
}

TEST(Service, AnImageHasAllItsLayers) {
  InProcessFarm farm(1, 2);
  TestScene scene = SmallScene();
  scene.spec.crop = {3, 5, 40, 31};
  scene.spec.channels = {true, true, true, true};
  const absl::StatusOr<JobId> job = SubmitJob(farm.client(), scene);
  ASSERT_TRUE(job.ok()) << job.status().message();
  const absl::StatusOr<JobStatus> end = AwaitEnd(farm.client(), *job);
  ASSERT_TRUE(end.ok() && end->state == JobState::kDone) << end->message;
  EXPECT_TRUE(end->spec.bundle.files.empty());
  EXPECT_EQ(farm.client().Get(*job)->spec, scene.spec);
  const absl::StatusOr<ImageLayers> image = farm.client().FetchImage(*job);
  ASSERT_TRUE(image.ok()) << image.status().message();
  EXPECT_EQ(image->crop, scene.spec.crop);
  EXPECT_EQ(image->values.size(), static_cast<size_t>(37 * 26) * image->channels.size());
  EXPECT_THAT(image->channels, testing::IsSupersetOf({"R", "A", "depth.Z", "stderr.G", "ci95.B",
                                                      "variance.R", "samples.Y", "flags.Y"}));
  EXPECT_FALSE(farm.client().Logs(*job)->empty());
}

TEST(Service, CancelPauseResumeRetryAndDelete) {
  TcpFarm farm;
  farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(1)) << farm.Logs();
  FarmClient& client = farm.client();
  const absl::StatusOr<JobId> job = SubmitJob(client, EndlessJob());
  ASSERT_TRUE(job.ok()) << job.status().message();
  const auto is = [&](JobState state) { return client.Get(*job)->state == state; };
  ASSERT_TRUE(Eventually([&] { return client.Get(*job)->samples > 0; })) << farm.Logs();
  ExpectError(client.Delete(*job), absl::StatusCode::kFailedPrecondition, "");
  ASSERT_TRUE(client.Pause(*job).ok());
  EXPECT_TRUE(is(JobState::kPaused));
  // A paused job leaves the worker to others.
  EXPECT_TRUE(RunJob(client, SmallScene()).ok());
  ASSERT_TRUE(client.Resume(*job).ok());
  const uint64_t paused_at = client.Get(*job)->samples;
  ASSERT_TRUE(Eventually([&] { return client.Get(*job)->samples > paused_at; }));
  ASSERT_TRUE(client.SetPriority(*job, -5).ok());
  EXPECT_EQ(client.Get(*job)->spec.priority, -5);
  // A watcher is told of the end.
  std::thread cancel([&] { EXPECT_TRUE(client.Cancel(*job).ok()); });
  EXPECT_EQ(AwaitEnd(client, *job)->state, JobState::kCancelled);
  cancel.join();
  // The worker lets go of it at once.
  EXPECT_TRUE(RunJob(client, SmallScene()).ok());
  ASSERT_TRUE(client.Retry(*job).ok());
  EXPECT_FALSE(is(JobState::kCancelled));
  ASSERT_TRUE(client.Cancel(*job).ok());
  EXPECT_TRUE(client.Delete(*job).ok());
  ExpectError(client.Get(*job).status(), absl::StatusCode::kNotFound, *job);
}

TEST(Service, ASceneThatDoesNotLoadFailsItsJobWithTheReason) {
  TcpFarm farm;
  farm.StartWorker(1);
  ScratchDirectory directory;
  std::ofstream(directory / "bad.pbrt") << "WorldBegin\nShape \"no such shape\"\n";
  TestScene scene = SmallScene();
  scene.root = directory / "";
  const absl::StatusOr<Digest> digest = DigestOfFile(directory / "bad.pbrt");
  scene.spec.bundle = {"bad.pbrt",
                       {{"bad.pbrt", *digest, std::filesystem::file_size(directory / "bad.pbrt")}}};
  const absl::StatusOr<Digest> result = RunJob(farm.client(), scene);
  ExpectError(result.status(), absl::StatusCode::kAborted, "bad.pbrt:2");
}

TEST(Service, HealthAndReflectionAnswer) {
  TcpFarm farm;
  EXPECT_TRUE(farm.client().Health().ok());
  const auto channel = wire::Dial(farm.server(), false);
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  const auto step = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  grpc::GenericStub stub(*channel);
  const auto call = stub.PrepareCall(
      &context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
  call->StartCall(nullptr);
  ASSERT_TRUE(step());
  // ServerReflectionRequest{list_services: "*"}
  const grpc::Slice request(std::string("\x3a\x01*"));
  call->Write(grpc::ByteBuffer(&request, 1), nullptr);
  ASSERT_TRUE(step());
  grpc::ByteBuffer response;
  call->Read(&response, nullptr);
  ASSERT_TRUE(step());
  grpc::Slice bytes;
  ASSERT_TRUE(response.DumpToSingleSlice(&bytes).ok());
  const std::string text(reinterpret_cast<const char*>(bytes.begin()), bytes.size());
  EXPECT_THAT(text, HasSubstr("strata.v1.FarmService"));
  EXPECT_THAT(text, HasSubstr("strata.v1.WorkerService"));
  EXPECT_THAT(text, HasSubstr("grpc.health.v1.Health"));
  context.TryCancel();
}

/// Opens a worker stream by hand, sends `messages` and returns how it ended, with what came back.
grpc::Status WorkerStreamOf(const std::string& server,
                            const std::vector<v1::WorkerMessage>& messages,
                            std::vector<v1::CoordinatorMessage>* answers) {
  const auto stub = v1::WorkerService::NewStub(*wire::Dial(server, false));
  grpc::ClientContext context;
  const auto stream = stub->Connect(&context);
  for (const v1::WorkerMessage& message : messages) stream->Write(message);
  v1::CoordinatorMessage answer;
  while (stream->Read(&answer)) answers->push_back(answer);
  return stream->Finish();
}

TEST(Service, WorkersThatSpeakOtherwiseAreRefusedWithASentence) {
  TcpFarm farm;
  std::vector<v1::CoordinatorMessage> answers;
  v1::WorkerMessage newer;
  newer.mutable_hello()->set_protocol(99);
  WorkerStreamOf(farm.server(), {newer}, &answers);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_THAT(answers[0].refusal().reason(), HasSubstr("99"));
  v1::WorkerMessage beat;
  beat.mutable_heartbeat();
  const grpc::Status early = WorkerStreamOf(farm.server(), {beat}, &answers);
  EXPECT_EQ(early.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(early.error_message(), HasSubstr("hello"));
  v1::WorkerMessage broken = newer;
  broken.mutable_hello()->set_protocol(kProtocol);
  const grpc::Status malformed = WorkerStreamOf(farm.server(), {broken}, &answers);
  EXPECT_EQ(malformed.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(malformed.error_message(), HasSubstr("hello.build"));
}

TEST(Service, BeyondLoopbackWantsInsecure) {
  ScratchDirectory directory;
  ServerOptions options;
  options.farm.state_dir = directory / "state";
  options.listen = "0.0.0.0:0";
  ExpectError(CoordinatorServer::Start(options).status(), absl::StatusCode::kFailedPrecondition,
              "--insecure");
  options.insecure = true;
  EXPECT_TRUE(CoordinatorServer::Start(options).ok());
  options.listen = "nonsense";
  ExpectError(CoordinatorServer::Start(options).status(), absl::StatusCode::kInvalidArgument,
              "nonsense");
}

TEST(Service, APortIsServedByOneCoordinator) {
  TcpFarm farm;
  ScratchDirectory directory;
  Process second("strata-coordinator", {"--listen", farm.server(), "--state", directory / "state"},
                 directory / "log");
  EXPECT_EQ(second.Wait(), 1);
}

TEST(Service, AnAbsentServerIsUnavailable) {
  const auto client = FarmClient::Dial("127.0.0.1:1", false);
  ASSERT_TRUE(client.ok());
  ExpectError((*client)->List().status(), absl::StatusCode::kUnavailable, "127.0.0.1:1");
}

TEST(Service, AWorkerMayComeBeforeItsCoordinatorAndTellsItsLink) {
  TcpFarm farm;
  farm.coordinator().Signal(SIGKILL);
  farm.coordinator().Wait();
  ScratchDirectory directory;
  const std::filesystem::path health = directory / "health";
  Process worker("strata-worker",
                 {"--server", farm.server(), "--cache", directory / "cache", "--threads", "1",
                  "--health-file", health},
                 directory / "log");
  ASSERT_TRUE(Eventually([&] { return std::filesystem::exists(health); }));
  EXPECT_FALSE(CheckHealthFile(health).ok());
  farm.StartCoordinator();
  EXPECT_TRUE(Eventually([&] { return CheckHealthFile(health).ok(); }));
  // As in a container, whose environment names the server.
  const auto check = [&] {
    return Process("strata-worker", {"--check", health}, directory / "check.log",
                   {{"STRATA_SERVER", farm.server()}})
        .Wait();
  };
  EXPECT_EQ(check(), 0);
  worker.Signal(SIGTERM);
  EXPECT_EQ(worker.Wait(), 0);
  EXPECT_FALSE(CheckHealthFile(health).ok());
  EXPECT_EQ(check(), 1);
}

}  // namespace
}  // namespace strata
