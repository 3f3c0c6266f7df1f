#include "cli/job_options.h"

#include <gtest/gtest.h>

#include "tests/cli/scene_folder.h"

namespace strata {
namespace {

using test::SceneFolder;

JobSpec Resolve(const JobOptions& options, const FrameDefaults& defaults,
                std::vector<std::string>* notes) {
  const absl::StatusOr<JobSpec> spec = ResolveJobSpec(options, defaults, notes);
  EXPECT_TRUE(spec.ok()) << spec.status();
  return spec.value_or(JobSpec{});
}

JobSpec Resolve(const JobOptions& options, const FrameDefaults& defaults = {}) {
  std::vector<std::string> notes;
  return Resolve(options, defaults, &notes);
}

std::string Refusal(const JobOptions& options) {
  std::vector<std::string> notes;
  const absl::StatusOr<JobSpec> spec = ResolveJobSpec(options, {}, &notes);
  EXPECT_TRUE(absl::IsInvalidArgument(spec.status())) << spec.status();
  return std::string(spec.status().message());
}

TEST(JobOptions, WhatIsNotGivenComesFromTheSceneFile) {
  FrameDefaults defaults;
  defaults.width = 64;
  defaults.height = 48;
  defaults.crop = PixelRect{8, 8, 16, 24};
  defaults.filter = DefaultFilter(FilterKind::kMitchell);
  defaults.sampler = SamplerKind::kIndependent;
  defaults.spp = 24;
  defaults.max_depth = 9;
  const JobSpec spec = Resolve({.scene = "room/kitchen.pbrt"}, defaults);
  EXPECT_EQ(spec.name, "kitchen");
  EXPECT_EQ(spec.width, 64);
  EXPECT_EQ(spec.height, 48);
  EXPECT_EQ(spec.crop, (PixelRect{8, 8, 16, 24}));
  EXPECT_EQ(spec.filter, DefaultFilter(FilterKind::kMitchell));
  EXPECT_EQ(spec.sampler, SamplerKind::kIndependent);
  EXPECT_EQ(spec.spp, 24u);
  EXPECT_EQ(spec.max_depth, 9);
}

TEST(JobOptions, WhatIsGivenWinsOverTheSceneFile) {
  JobOptions options;
  options.scene = "kitchen.pbrt";
  options.resolution = "320x200";
  options.crop = "1,2,30,40";
  options.max_depth = 0;
  options.sampler = "independent";
  options.strategy = "light";
  options.mis_beta = 1;
  options.routines = "rejection";
  options.roulette = "off";
  options.kernel = "reference";
  options.filter = "triangle:1.5";
  options.spp = 32;
  options.tile = 16;
  options.seed = 7;
  options.frame = 3;
  options.channels = "depth,alpha";
  options.reproducible = false;
  options.name = "try";
  options.priority = -4;
  const JobSpec spec = Resolve(options);
  EXPECT_EQ(spec.width, 320);
  EXPECT_EQ(spec.height, 200);
  EXPECT_EQ(spec.crop, (PixelRect{1, 2, 30, 40}));
  EXPECT_EQ(spec.max_depth, 0);
  EXPECT_EQ(spec.sampler, SamplerKind::kIndependent);
  EXPECT_EQ(spec.strategy, DirectStrategy::kLightOnly);
  EXPECT_EQ(spec.mis_beta, 1);
  EXPECT_EQ(spec.routines, SamplingRoutines::kRejection);
  EXPECT_EQ(spec.roulette, RouletteKind::kOff);
  EXPECT_EQ(spec.kernel, KernelKind::kReference);
  EXPECT_EQ(spec.filter.kind, FilterKind::kTriangle);
  EXPECT_EQ(spec.filter.radius_x, 1.5);
  EXPECT_EQ(spec.filter.radius_y, 1.5);
  EXPECT_EQ(spec.spp, 32u);
  EXPECT_EQ(spec.tile, 16);
  EXPECT_EQ(spec.seed, 7u);
  EXPECT_EQ(spec.frame, 3u);
  EXPECT_EQ(spec.channels, (ExtraChannels{.alpha = true, .depth = true}));
  EXPECT_FALSE(spec.reproducible);
  EXPECT_EQ(spec.name, "try");
  EXPECT_EQ(spec.priority, -4);
}

TEST(JobOptions, SamplesAreRoundedUpToAMultipleOfEightAndThatIsSaid) {
  JobOptions options;
  options.scene = "a.pbrt";
  options.spp = 9;
  std::vector<std::string> notes;
  EXPECT_EQ(Resolve(options, {}, &notes).spp, 16u);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("--spp 9 is rounded up to 16"), std::string::npos) << notes[0];

  notes.clear();
  options.spp = 16;
  EXPECT_EQ(Resolve(options, {}, &notes).spp, 16u);
  EXPECT_TRUE(notes.empty());
}

TEST(JobOptions, ACropOfTheSceneKeepsItsPlaceAtAnotherResolution) {
  FrameDefaults defaults;
  defaults.width = 100;
  defaults.height = 50;
  defaults.crop = PixelRect{25, 10, 75, 40};
  JobOptions options;
  options.scene = "a.pbrt";
  options.resolution = "200x25";
  EXPECT_EQ(Resolve(options, defaults).crop, (PixelRect{50, 5, 150, 20}));
}

TEST(JobOptions, AFileCalledSceneLendsItsFoldersName) {
  EXPECT_EQ(Resolve({.scene = "coffee/scene.pbrt"}).name, "coffee");
}

TEST(JobOptions, ValuesThatAreNotUnderstoodAreNamedWithWhatIsWanted) {
  EXPECT_NE(Refusal({.scene = "a", .resolution = "12"}).find("--resolution: '12'"),
            std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .crop = "1,2,3"}).find("--crop: '1,2,3'"), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .channels = "beauty"}).find("--channels: 'beauty'"),
            std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .filter = "box:wide"}).find("--filter: 'box:wide'"),
            std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .filter = "sinc"}).find("--filter: "), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .sampler = "dice"}).find("--sampler: "), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .strategy = "luck"}).find("--strategy: "), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .mis_beta = -1}).find("--mis-beta"), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .routines = "rough"}).find("--routines: "), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .roulette = "red"}).find("--roulette: "), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .kernel = "quick"}).find("--kernel: "), std::string::npos);
  EXPECT_NE(Refusal({.scene = "a", .spp = 0}).find("--spp: 0"), std::string::npos);
}

TEST(JobOptions, SamplersThatClaimNoIntervalSayItAndAreRefusedTargets) {
  for (const std::string sampler : {"halton_plain", "drand48"}) {
    std::vector<std::string> notes;
    const auto spec = ResolveJobSpec({.scene = "a", .sampler = sampler}, {}, &notes);
    ASSERT_TRUE(spec.ok()) << spec.status();
    EXPECT_EQ(spec->allocation, AllocationKind::kUniform);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find(sampler + " claims no interval"), std::string::npos) << notes[0];
    const auto refused = [&](JobOptions options, const std::string& start) {
      options.scene = "a";
      options.sampler = sampler;
      const std::string why = Refusal(options);
      EXPECT_EQ(why.rfind(start, 0), 0u) << why;
      EXPECT_NE(why.find("claims no interval"), std::string::npos) << why;
    };
    refused({.error = "2%"}, "--error: ");
    refused({.rmse = "0.1"}, "--rmse: ");
    refused({.allocation = "ring"}, "--allocation: ");
  }
  EXPECT_EQ(Resolve({.scene = "a", .sampler = "halton"}).allocation, AllocationKind::kRing);
}

TEST(JobOptions, ATargetHasAKindAValueAndACap) {
  const JobSpec plain = Resolve({.scene = "a.pbrt"});
  EXPECT_EQ(plain.target, TargetKind::kSamples);
  EXPECT_EQ(plain.allocation, AllocationKind::kRing);
  const JobSpec error = Resolve({.scene = "a.pbrt", .error = "2%"});
  EXPECT_EQ(error.target, TargetKind::kRelativeError);
  EXPECT_DOUBLE_EQ(error.target_value, 0.02);
  EXPECT_EQ(error.spp, 65536u);
  EXPECT_EQ(Resolve({.scene = "a.pbrt", .spp = 1024, .error = "0.02"}).spp, 1024u);
  EXPECT_EQ(Resolve({.scene = "a.pbrt", .rmse = "1e-3"}).target, TargetKind::kRmse);
  const JobSpec time = Resolve({.scene = "a.pbrt", .time = "1.5m"});
  EXPECT_EQ(time.target, TargetKind::kTime);
  EXPECT_DOUBLE_EQ(time.target_value, 90);
  EXPECT_DOUBLE_EQ(Resolve({.scene = "a.pbrt", .time = "90"}).target_value, 90);
  EXPECT_DOUBLE_EQ(Resolve({.scene = "a.pbrt", .time = "2h"}).target_value, 7200);
  EXPECT_EQ(Resolve({.scene = "a.pbrt", .allocation = "uniform"}).allocation,
            AllocationKind::kUniform);
  std::vector<std::string> notes;
  Resolve({.scene = "a.pbrt", .allocation = "uniform"}, {}, &notes);
  EXPECT_TRUE(notes.empty());
  Resolve({.scene = "a.pbrt", .allocation = "greedy"}, {}, &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("biased"), std::string::npos) << notes[0];
}

TEST(JobOptions, TargetsThatMakeNoSenseAreNamed) {
  const auto refused = [](const JobOptions& options, const char* what) {
    EXPECT_NE(Refusal(options).find(what), std::string::npos) << Refusal(options);
  };
  refused({.scene = "a", .error = "-1"}, "--error: '-1'");
  refused({.scene = "a", .error = "0"}, "--error: '0'");
  refused({.scene = "a", .rmse = "2%"}, "--rmse: '2%'");
  refused({.scene = "a", .time = "soon"}, "--time: 'soon'");
  refused({.scene = "a", .error = "1%", .time = "9"}, "exclude each other");
  refused({.scene = "a", .allocation = "square"}, "--allocation: ");
}

TEST(FindScene, TheRootIsTheScenesFolderUnlessAnotherContainsIt) {
  const SceneFolder folder;
  const std::string scene = folder.Write("rooms/kitchen/scene.pbrt", "");
  const absl::StatusOr<ScenePath> alone = FindScene({.scene = scene});
  ASSERT_TRUE(alone.ok()) << alone.status();
  EXPECT_EQ(alone->scene, "scene.pbrt");

  const absl::StatusOr<ScenePath> rooted =
      FindScene({.scene = scene, .root = folder.Path("rooms")});
  ASSERT_TRUE(rooted.ok()) << rooted.status();
  EXPECT_EQ(rooted->scene, "kitchen/scene.pbrt");

  folder.Write("other/x.pbrt", "");
  const absl::Status refused = FindScene({.scene = scene, .root = folder.Path("other")}).status();
  EXPECT_TRUE(absl::IsInvalidArgument(refused));
  EXPECT_NE(refused.message().find("does not contain"), std::string::npos) << refused;
}

TEST(FindScene, MessagesNameFilesAsTheUserCanOpenThem) {
  const SceneFolder folder;
  folder.Write("s/scene.pbrt", "");
  const ScenePath path{folder.Path("s"), "scene.pbrt", "typed/s"};
  EXPECT_EQ(path.Located("scene.pbrt:3: bad"), "typed/s/scene.pbrt:3: bad");
  EXPECT_EQ(path.Located("the disk is full"), "the disk is full");
}

}  // namespace
}  // namespace strata
