// Job specs: what is accepted, and what the messages name.

#include "common/job.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "common/report.h"

namespace strata {
namespace {

JobSpec GoodSpec() {
  JobSpec spec;
  spec.name = "a job";
  spec.bundle = {"scene.pbrt", {{"scene.pbrt", DigestOf("scene"), 5}}};
  spec.width = 64;
  spec.height = 48;
  spec.crop = {0, 0, 64, 48};
  return spec;
}

struct BadField {
  const char* field;  ///< The message must name it.
  std::function<void(JobSpec&)> spoil;
};

TEST(JobSpecTest, AcceptsItsDefaults) { EXPECT_TRUE(ValidateJobSpec(GoodSpec()).ok()); }

TEST(JobSpecTest, NamesTheFieldThatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<BadField> bad = {
      {"name", [](JobSpec& s) { s.name = "two\nlines"; }},
      {"name", [](JobSpec& s) { s.name = std::string(300, 'x'); }},
      {"priority", [](JobSpec& s) { s.priority = 101; }},
      {"bundle", [](JobSpec& s) { s.bundle.files[0].path = "../outside.pbrt"; }},
      {"width", [](JobSpec& s) { s.width = 0; }},
      {"height", [](JobSpec& s) { s.height = 65537; }},
      {"crop", [](JobSpec& s) { s.crop.x1 = 65; }},
      {"crop", [](JobSpec& s) { s.crop.y0 = -1; }},
      {"crop", [](JobSpec& s) { s.crop.x0 = 64; }},
      {"max_depth", [](JobSpec& s) { s.max_depth = -1; }},
      {"sampler", [](JobSpec& s) { s.sampler = static_cast<SamplerKind>(9); }},
      {"mis_beta", [](JobSpec& s) { s.mis_beta = -0.5; }},
      {"mis_beta", [](JobSpec& s) { s.mis_beta = 101; }},
      {"mis_beta", [](JobSpec& s) { s.mis_beta = std::nan(""); }},
      {"strategy", [](JobSpec& s) { s.strategy = static_cast<DirectStrategy>(9); }},
      {"roulette", [](JobSpec& s) { s.roulette = static_cast<RouletteKind>(9); }},
      {"kernel", [](JobSpec& s) { s.kernel = static_cast<KernelKind>(9); }},
      {"filter.kind", [](JobSpec& s) { s.filter.kind = static_cast<FilterKind>(9); }},
      {"filter.radius_x", [](JobSpec& s) { s.filter.radius_x = 0; }},
      {"filter.radius_y", [nan](JobSpec& s) { s.filter.radius_y = nan; }},
      {"filter.sigma", [](JobSpec& s) { s.filter.sigma = -1; }},
      {"filter.b", [nan](JobSpec& s) { s.filter.b = nan; }},
      {"spp", [](JobSpec& s) { s.spp = 0; }},
      {"spp", [](JobSpec& s) { s.spp = 12; }},
      {"spp", [](JobSpec& s) { s.spp = 0xfffffff8; }},
      {"tile", [](JobSpec& s) { s.tile = 4; }},
  };
  for (const BadField& field : bad) {
    JobSpec spec = GoodSpec();
    field.spoil(spec);
    const absl::Status status = ValidateJobSpec(spec);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << field.field;
    EXPECT_EQ(std::string(status.message()).rfind(field.field, 0), 0u) << status;
  }
}

TEST(JobSpecTest, LayoutFollowsTheChannels) {
  JobSpec spec = GoodSpec();
  EXPECT_EQ(LayoutOf(spec), (PixelLayout{3, 0}));
  spec.channels = {true, true, true, true};
  EXPECT_EQ(LayoutOf(spec), (PixelLayout{3, 8}));
  const std::vector<std::string> names = {"A",        "albedo.R", "albedo.G", "albedo.B",
                                          "normal.X", "normal.Y", "normal.Z", "depth.Z"};
  EXPECT_EQ(PlainChannelNames(spec.channels), names);
}

TEST(JobSpecTest, LayoutPlacesEveryDoubleOnce) {
  const PixelLayout layout{3, 2};
  std::vector<int> uses(static_cast<size_t>(layout.Doubles()));
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < kReplicates; ++r) ++uses[static_cast<size_t>(layout.Mean(r, c))];
    ++uses[static_cast<size_t>(layout.M2(c))];
    ++uses[static_cast<size_t>(layout.M3(c))];
  }
  for (int c = 0; c < 2; ++c) ++uses[static_cast<size_t>(layout.Plain(c))];
  EXPECT_EQ(uses, std::vector<int>(uses.size(), 1));
}

TEST(JobSpecTest, SamplersThatClaimNoIntervalHaveNoErrorToAimAtNorToSpreadBy) {
  for (const SamplerKind sampler : {SamplerKind::kHaltonPlain, SamplerKind::kDrand48}) {
    JobSpec spec = GoodSpec();
    spec.sampler = sampler;
    EXPECT_TRUE(ValidateJobSpec(spec).ok());
    spec.target = TargetKind::kTime;
    spec.target_value = 1;
    EXPECT_TRUE(ValidateJobSpec(spec).ok());
    for (const TargetKind target : {TargetKind::kRelativeError, TargetKind::kRmse}) {
      spec.target = target;
      EXPECT_NE(ValidateJobSpec(spec).message().find("claims no interval"), std::string::npos);
    }
    spec = GoodSpec();
    spec.sampler = sampler;
    spec.allocation = AllocationKind::kRing;
    EXPECT_NE(ValidateJobSpec(spec).message().find("claims no interval"), std::string::npos);
  }
}

TEST(NamesTest, AreParsedAsTheyArePrinted) {
  for (const auto kind :
       {SamplerKind::kSobol, SamplerKind::kIndependent, SamplerKind::kHalton,
        SamplerKind::kHaltonPlain, SamplerKind::kStratified, SamplerKind::kLatinHypercube,
        SamplerKind::kPoissonDisk, SamplerKind::kDrand48}) {
    EXPECT_EQ(*ParseSamplerKind(ToString(kind)), kind);
  }
  for (const auto strategy :
       {DirectStrategy::kMis, DirectStrategy::kLightOnly, DirectStrategy::kBsdfOnly,
        DirectStrategy::kCosine, DirectStrategy::kUniform}) {
    EXPECT_EQ(*ParseDirectStrategy(ToString(strategy)), strategy);
  }
  for (const auto kind :
       {RouletteKind::kThroughput, RouletteKind::kOff, RouletteKind::kEfficiency}) {
    EXPECT_EQ(*ParseRouletteKind(ToString(kind)), kind);
  }
  for (const auto kind : {KernelKind::kFast, KernelKind::kReference}) {
    EXPECT_EQ(*ParseKernelKind(ToString(kind)), kind);
  }
  for (const auto kind :
       {FilterKind::kBox, FilterKind::kTriangle, FilterKind::kGaussian, FilterKind::kMitchell}) {
    EXPECT_EQ(*ParseFilterKind(ToString(kind)), kind);
    EXPECT_EQ(DefaultFilter(kind).kind, kind);
  }
  const absl::Status status = ParseFilterKind("sinc").status();
  EXPECT_EQ(status.message(),
            "filter \"sinc\" is not known; choose one of box, triangle, gaussian, mitchell");
}

// pbrt-v4's defaults, as its file format page gives them.
TEST(NamesTest, FiltersHavePbrtsDefaults) {
  EXPECT_EQ(DefaultFilter(FilterKind::kBox).radius_x, 0.5);
  EXPECT_EQ(DefaultFilter(FilterKind::kTriangle).radius_x, 2);
  EXPECT_EQ(DefaultFilter(FilterKind::kGaussian).radius_y, 1.5);
  EXPECT_EQ(DefaultFilter(FilterKind::kGaussian).sigma, 0.5);
  EXPECT_EQ(DefaultFilter(FilterKind::kMitchell).radius_y, 2);
  EXPECT_EQ(DefaultFilter(FilterKind::kMitchell).b, 1.0 / 3);
}

TEST(NamesTest, StatesHaveNames) {
  EXPECT_EQ(ToString(JobState::kQueued), "queued");
  EXPECT_EQ(ToString(JobState::kCancelled), "cancelled");
  EXPECT_TRUE(IsFinal(JobState::kFailed));
  EXPECT_FALSE(IsFinal(JobState::kPaused));
}

}  // namespace
}  // namespace strata
