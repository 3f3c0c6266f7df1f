#include "common/replay_command.h"

#include <gtest/gtest.h>

namespace strata {
namespace {

TEST(ReplayCommand, SaysAllThatDecidesASample) {
  JobSpec spec;
  spec.bundle.scene = "scene.pbrt";
  spec.width = 640;
  spec.height = 480;
  spec.max_depth = 3;
  spec.seed = 11;
  spec.frame = 2;
  spec.sampler = SamplerKind::kIndependent;
  spec.filter = DefaultFilter(FilterKind::kGaussian);
  spec.filter.radius_y = 0.1;
  spec.filter.sigma = 1.0 / 3;
  EXPECT_EQ(ReplayCommand(spec, 4, 5, 6, 7),
            "strata replay scene.pbrt --pixel 4,5 --replicate 6 --sample 7 --seed 11 --frame 2 "
            "--resolution 640x480 --max-depth 3 --sampler independent "
            "--filter gaussian:1.5,0.1,0.3333333333333333");
  spec.strategy = DirectStrategy::kUniform;
  spec.mis_beta = 1;
  spec.routines = SamplingRoutines::kPlain;
  spec.roulette = RouletteKind::kEfficiency;
  EXPECT_NE(ReplayCommand(spec, 4, 5, 6, 7)
                .find(" --strategy uniform --mis-beta 1 --routines plain --roulette efficiency"),
            std::string::npos);
}

TEST(ReplayCommand, NamesScenesAsAShellReadsThem) {
  JobSpec spec;
  spec.bundle.scene = "my room/it's.pbrt";
  EXPECT_EQ(CheckCommand(spec), "strata check 'my room/it'\\''s.pbrt' --root .");
  spec.bundle.scene = "-x.pbrt";
  EXPECT_EQ(CheckCommand(spec), "strata check ./-x.pbrt");
}

TEST(ReplayCommand, KeepsTheScenesOptions) {
  JobSpec spec;
  spec.bundle.scene = "helmet.glb";
  spec.bundle.options = {"sky.exr", "-1,2,3,0,0,0"};
  EXPECT_EQ(CheckCommand(spec), "strata check helmet.glb --env=sky.exr --camera=-1,2,3,0,0,0");
  spec.bundle.options = {.light_selection = LightSelection::kIntensity};
  EXPECT_EQ(CheckCommand(spec), "strata check helmet.glb --light-selection intensity");
}

TEST(ShellQuoted, LeavesPlainWordsAlone) {
  EXPECT_EQ(ShellQuoted("a/b-1.pbrt"), "a/b-1.pbrt");
  EXPECT_EQ(ShellQuoted(""), "''");
  EXPECT_EQ(ShellQuoted("$(rm x)"), "'$(rm x)'");
  EXPECT_EQ(ShellQuoted("~"), "'~'");
}

}  // namespace
}  // namespace strata
