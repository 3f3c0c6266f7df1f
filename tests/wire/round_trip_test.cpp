#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <set>

#include "common/wire/job.h"
#include "common/wire/report.h"
#include "common/wire/worker_messages.h"
#include "tests/wire/samples.h"

namespace strata {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::util::MessageDifferencer;

/// Fields, at any depth, that hold their default: conversions that forgot them. Scalars whose
/// sample value is zero by nature are named in `zero`.
std::vector<std::string> UnsetFields(const Message& message, const std::set<std::string>& zero) {
  std::vector<std::string> unset;
  const auto* reflection = message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message.GetDescriptor()->field(i);
    if (field->real_containing_oneof() != nullptr && !reflection->HasField(message, field))
      continue;
    const bool set = field->is_repeated() ? reflection->FieldSize(message, field) > 0
                                          : reflection->HasField(message, field);
    if (!set && !zero.contains(field->full_name())) unset.push_back(field->full_name());
    if (!set || field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE || field->is_map()) continue;
    const int count = field->is_repeated() ? 1 : 0;
    const Message& inner = count > 0 ? reflection->GetRepeatedMessage(message, field, 0)
                                     : reflection->GetMessage(message, field);
    const std::vector<std::string> more = UnsetFields(inner, zero);
    unset.insert(unset.end(), more.begin(), more.end());
  }
  return unset;
}

TEST(RoundTrip, JobSpec) {
  JobSpec spec = SampleSpec();
  v1::JobSpec message;
  wire::ToWire(spec, &message);
  EXPECT_EQ(UnsetFields(message, {}), std::vector<std::string>());
  const absl::StatusOr<JobSpec> back = wire::FromWire(message);
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(*back, spec);
}

/// Clients, and jobs kept on disk, of before there was a choice.
TEST(RoundTrip, JobsThatNameNoChoicesHaveTheDefaults) {
  v1::JobSpec message;
  wire::ToWire(SampleSpec(), &message);
  message.clear_strategy();
  message.clear_mis_beta();
  message.clear_routines();
  message.mutable_bundle()->clear_light_selection();
  message.clear_roulette();
  const absl::StatusOr<JobSpec> spec = wire::FromWire(message);
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_EQ(spec->strategy, DirectStrategy::kMis);
  EXPECT_EQ(spec->mis_beta, 2);
  EXPECT_EQ(spec->routines, SamplingRoutines::kPreserving);
  EXPECT_EQ(spec->bundle.options.light_selection, LightSelection::kTree);
  EXPECT_EQ(spec->roulette, RouletteKind::kThroughput);
}

TEST(RoundTrip, EveryEnumValue) {
  for (const SamplerKind sampler :
       {SamplerKind::kSobol, SamplerKind::kIndependent, SamplerKind::kHalton,
        SamplerKind::kHaltonPlain, SamplerKind::kStratified, SamplerKind::kLatinHypercube,
        SamplerKind::kPoissonDisk, SamplerKind::kDrand48}) {
    for (const FilterKind filter :
         {FilterKind::kBox, FilterKind::kTriangle, FilterKind::kGaussian, FilterKind::kMitchell}) {
      JobSpec spec = SampleSpec();
      spec.sampler = sampler;
      spec.filter.kind = filter;
      v1::JobSpec message;
      wire::ToWire(spec, &message);
      EXPECT_EQ(*wire::FromWire(message), spec);
    }
  }
  for (const DirectStrategy strategy :
       {DirectStrategy::kMis, DirectStrategy::kLightOnly, DirectStrategy::kBsdfOnly,
        DirectStrategy::kCosine, DirectStrategy::kUniform}) {
    JobSpec spec = SampleSpec();
    spec.strategy = strategy;
    v1::JobSpec message;
    wire::ToWire(spec, &message);
    EXPECT_EQ(*wire::FromWire(message), spec);
  }
  for (const RouletteKind roulette :
       {RouletteKind::kThroughput, RouletteKind::kOff, RouletteKind::kEfficiency}) {
    JobSpec spec = SampleSpec();
    spec.roulette = roulette;
    v1::JobSpec message;
    wire::ToWire(spec, &message);
    EXPECT_EQ(*wire::FromWire(message), spec);
  }
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    JobSpec spec = SampleSpec();
    spec.kernel = kernel;
    v1::JobSpec message;
    wire::ToWire(spec, &message);
    EXPECT_EQ(*wire::FromWire(message), spec);
  }
  for (const AllocationKind allocation :
       {AllocationKind::kUniform, AllocationKind::kRing, AllocationKind::kGreedy}) {
    for (const TargetKind target :
         {TargetKind::kSamples, TargetKind::kRelativeError, TargetKind::kRmse, TargetKind::kTime}) {
      JobSpec spec = SampleSpec();
      spec.allocation = allocation;
      spec.target = target;
      v1::JobSpec message;
      wire::ToWire(spec, &message);
      EXPECT_EQ(*wire::FromWire(message), spec);
    }
  }
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kPaused,
                               JobState::kDone, JobState::kFailed, JobState::kCancelled}) {
    JobStatus status = SampleStatus();
    status.state = state;
    v1::JobStatus message;
    wire::ToWire(status, &message, true);
    EXPECT_EQ(wire::FromWire(message)->state, state);
  }
}

TEST(RoundTrip, JobStatus) {
  v1::JobStatus message, again;
  wire::ToWire(SampleStatus(), &message, /*with_files=*/true);
  EXPECT_EQ(UnsetFields(message, {}), std::vector<std::string>());
  const absl::StatusOr<JobStatus> back = wire::FromWire(message);
  ASSERT_TRUE(back.ok()) << back.status().message();
  wire::ToWire(*back, &again, true);
  EXPECT_TRUE(MessageDifferencer::Equals(message, again));
}

TEST(RoundTrip, StatusWithoutFilesNamesTheSceneAlone) {
  v1::JobStatus message;
  wire::ToWire(SampleStatus(), &message, /*with_files=*/false);
  const absl::StatusOr<JobStatus> back = wire::FromWire(message);
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(back->spec.bundle.scene, "scene.pbrt");
  EXPECT_TRUE(back->spec.bundle.files.empty());
}

TEST(RoundTrip, WorkerStatusAndLogLine) {
  v1::WorkerStatus worker, worker_again;
  wire::ToWire(SampleWorker(), &worker);
  EXPECT_EQ(UnsetFields(worker, {}), std::vector<std::string>());
  wire::ToWire(wire::FromWire(worker), &worker_again);
  EXPECT_TRUE(MessageDifferencer::Equals(worker, worker_again));
  v1::LogLine line, line_again;
  wire::ToWire(LogLine{1.7e9, "warning", "slow"}, &line);
  EXPECT_EQ(UnsetFields(line, {}), std::vector<std::string>());
  wire::ToWire(wire::FromWire(line), &line_again);
  EXPECT_TRUE(MessageDifferencer::Equals(line, line_again));
}

TEST(RoundTrip, EveryMessageOfTheCoordinator) {
  std::set<int> kinds;
  for (const ToWorker& plain : SampleToWorker()) {
    v1::CoordinatorMessage message, again;
    wire::ToWire(plain, &message);
    kinds.insert(message.message_case());
    EXPECT_EQ(UnsetFields(message, {}), std::vector<std::string>()) << message.ShortDebugString();
    const absl::StatusOr<ToWorker> back = wire::FromWire(message);
    ASSERT_TRUE(back.ok()) << back.status().message();
    EXPECT_EQ(back->index(), plain.index());
    wire::ToWire(*back, &again);
    EXPECT_TRUE(MessageDifferencer::Equals(message, again)) << message.ShortDebugString();
  }
  EXPECT_EQ(static_cast<int>(kinds.size()), v1::CoordinatorMessage::descriptor()->field_count());
}

TEST(RoundTrip, EveryMessageOfAWorker) {
  std::set<int> kinds;
  wire::WorkerMessageReader reader;
  for (const FromWorker& plain : SampleFromWorker()) {
    wire::WorkerMessageWriter writer(plain);
    v1::WorkerMessage message, again;
    writer.Next(&message);
    EXPECT_TRUE(writer.Done());
    kinds.insert(message.message_case());
    // Layer 0 is the path layer; the first chunk begins with pixel 0.
    EXPECT_EQ(UnsetFields(message,
                          {"strata.v1.PartialHeader.layer", "strata.v1.PartialChunk.first_pixel"}),
              std::vector<std::string>());
    const absl::StatusOr<std::optional<FromWorker>> back = reader.Add(message);
    ASSERT_TRUE(back.ok()) << back.status().message();
    ASSERT_TRUE(back->has_value());
    EXPECT_EQ((*back)->index(), plain.index());
    wire::WorkerMessageWriter(**back).Next(&again);
    EXPECT_TRUE(MessageDifferencer::Equals(message, again)) << message.ShortDebugString();
  }
  EXPECT_EQ(static_cast<int>(kinds.size()), v1::WorkerMessage::descriptor()->field_count());
}

void ExpectEqual(const UnitResult& a, const UnitResult& b) {
  EXPECT_EQ(a.job, b.job);
  EXPECT_EQ(a.lease, b.lease);
  EXPECT_EQ(a.load_seconds, b.load_seconds);
  EXPECT_EQ(a.background_pixels, b.background_pixels);
  EXPECT_EQ(a.partial.unit, b.partial.unit);
  EXPECT_EQ(a.partial.pixels, b.partial.pixels);
  EXPECT_EQ(a.partial.layout, b.partial.layout);
  EXPECT_EQ(a.partial.samples, b.partial.samples);
  EXPECT_EQ(a.partial.values, b.partial.values);
  EXPECT_EQ(a.partial.rays, b.partial.rays);
  EXPECT_EQ(a.partial.nonfinite, b.partial.nonfinite);
  EXPECT_EQ(a.partial.replays, b.partial.replays);
  EXPECT_EQ(a.partial.render_seconds, b.partial.render_seconds);
}

TEST(Chunks, LargePartialsTravelInMebibytes) {
  for (const bool varied : {false, true}) {
    for (const int edge : {1, 2, 63, 128, 200}) {
      const UnitResult result = SampleResult(edge, edge, varied);
      wire::WorkerMessageWriter writer(result);
      wire::WorkerMessageReader reader;
      std::optional<FromWorker> whole;
      v1::WorkerMessage message;
      while (!writer.Done()) {
        ASSERT_FALSE(whole.has_value());
        writer.Next(&message);
        EXPECT_LE(message.partial().ByteSizeLong(), wire::kPartialChunkBytes);
        // As on the wire: through bytes.
        v1::WorkerMessage received;
        ASSERT_TRUE(received.ParseFromString(message.SerializeAsString()));
        absl::StatusOr<std::optional<FromWorker>> added = reader.Add(received);
        ASSERT_TRUE(added.ok()) << added.status().message();
        whole = *std::move(added);
        // Other messages may come between the chunks.
        message.mutable_heartbeat();
        EXPECT_TRUE(reader.Add(message)->has_value());
      }
      ASSERT_TRUE(whole.has_value());
      ExpectEqual(std::get<UnitResult>(*whole), result);
    }
  }
}

TEST(Chunks, TheWidestPixelsFit) {
  UnitResult result = SampleResult(64, 64, true);
  result.partial.layout = {16, 64};
  const size_t doubles = 64 * 64 * static_cast<size_t>(result.partial.layout.Doubles());
  result.partial.values.assign(doubles, 0.1);
  result.partial.rays.assign(64 * 64, ~uint64_t{0});
  result.partial.replays.assign(40, std::string(4096, 'x'));
  wire::PartialChunker chunker(result);
  wire::PartialAssembler assembler;
  v1::PartialChunk chunk;
  std::optional<UnitResult> whole;
  while (!chunker.Done()) {
    chunker.Next(&chunk);
    EXPECT_LE(chunk.ByteSizeLong(), wire::kPartialChunkBytes);
    whole = *assembler.Add(chunk);
  }
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->partial.replays.size(), wire::kMaxReplays);
  EXPECT_EQ(whole->partial.values, result.partial.values);
}

TEST(Chunks, ImagesComeWhole) {
  ImageLayers image;
  image.full_width = 300;
  image.full_height = 200;
  image.crop = {10, 20, 210, 120};
  image.channels = {"R", "G", "B"};
  for (int i = 0; i < 200 * 100 * 3; ++i) image.values.push_back(static_cast<float>(i));
  image.metadata = {{"seed", "1"}, {"build", "x"}};
  v1::FetchImageResponse header, rows;
  wire::ToWire(image, header.mutable_header());
  EXPECT_EQ(UnsetFields(header, {}), std::vector<std::string>());
  wire::ImageReader reader;
  ASSERT_TRUE(reader.Add(header).ok());
  rows.mutable_rows()->mutable_values()->Add(image.values.begin(), image.values.begin() + 1000);
  ASSERT_TRUE(reader.Add(rows).ok());
  EXPECT_EQ(std::move(wire::ImageReader(reader)).Finish().status().code(),
            absl::StatusCode::kDataLoss);
  rows.mutable_rows()->mutable_values()->Clear();
  rows.mutable_rows()->mutable_values()->Add(image.values.begin() + 1000, image.values.end());
  ASSERT_TRUE(reader.Add(rows).ok());
  EXPECT_FALSE(wire::ImageReader(reader).Add(rows).ok());
  const absl::StatusOr<ImageLayers> back = std::move(reader).Finish();
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->values, image.values);
  EXPECT_EQ(back->channels, image.channels);
  EXPECT_EQ(back->metadata, image.metadata);
  EXPECT_EQ(back->crop, image.crop);
  EXPECT_EQ(back->full_width, 300);
  EXPECT_EQ(back->full_height, 200);
}

}  // namespace
}  // namespace strata
