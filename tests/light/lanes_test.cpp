#include <gtest/gtest.h>

#include <array>

#include "tests/light/lamps.h"
#include "tests/statistics/random.h"

// Eight points at once that choose and sample lights, against one at a time.

namespace strata {
namespace {

/// Points among the lamps, every third of which may be lit from behind.
class Receivers {
 public:
  explicit Receivers(TestRandom& random) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto coordinate = [&] { return 12 * random.Float() - 6; };
      const float x = coordinate(), y = coordinate(), z = coordinate();
      one[lane] = {{x, y, z},
                   Normalize(Vec3f{coordinate(), coordinate(), coordinate() + 20}),
                   lane % 3 != 0};
      all.p.Set(lane, one[lane].p);
      all.n.Set(lane, one[lane].n);
      all.one_sided[lane] = one[lane].one_sided ? -1 : 0;
      u.x[lane] = random.Float();
      u.y[lane] = random.Float();
    }
  }
  std::array<LightReceiver, kLanes> one;
  LightReceiverLanes all;
  Vec2Lanes u;
};

TEST(LightLanes, ChooseWhatEachChooses) {
  TestRandom random(1);
  for (const int count : {1, 2, 4, 5, 13, 100}) {
    for (const LightSelection selection :
         {LightSelection::kTree, LightSelection::kIntensity, LightSelection::kUniform}) {
      const LightScene scene(ManyLamps(count, 7), DirectorySource("."), {.selection = selection});
      int found = 0, same = 0;
      for (int i = 0; i < 500; ++i) {
        const Receivers receivers(random);
        const MaskLanes mask = {-1, -1, 0, -1, -1, -1, 0, -1};
        const auto choices = scene.lights.Select(receivers.all, receivers.u, mask);
        ForEachLane(mask, [&](int lane) {
          const LightSet::Choice one =
              scene.lights.Select(receivers.one[lane], receivers.u.x[lane], receivers.u.y[lane]);
          ++found;
          if (choices.light[lane] != static_cast<int32_t>(one.light)) return;
          ++same;
          EXPECT_NEAR(choices.probability[lane], one.probability, 1e-5f * one.probability);
          EXPECT_NEAR(choices.u[lane], one.u, 1e-5f);
        });
      }
      EXPECT_EQ(same, found) << count << " lights";
    }
  }
}

TEST(LightLanes, SampleWhatEachSamples) {
  // Half of the squares and triangles measure 10 units: points among them sample those by solid
  // angle.
  TestRandom random(2);
  SceneDescription scene = ManyLamps(50, 8);
  for (size_t i = 0; i < scene.shapes.size(); ++i) {
    if (i % 8 < 2)
      scene.shapes[i].to_world = scene.shapes[i].to_world * Transform::Scale(50, 50, 50);
  }
  const LightScene lights(std::move(scene));
  int quads = 0, near = 0, triangles = 0, near_triangles = 0;
  for (int i = 0; i < 4000; ++i) {
    const Receivers receivers(random);
    IntLanes light = {};
    for (int lane = 0; lane < kLanes; ++lane) light[lane] = (i * kLanes + lane) % 50;
    LightSampleLanes samples;
    lights.lights.Sample(light, receivers.all.p, receivers.u, SameInt(-1), &samples);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3f from = receivers.one[lane].p;
      const auto id = static_cast<uint32_t>(light[lane]);
      const auto one = lights.lights.Sample(id, from, {receivers.u.x[lane], receivers.u.y[lane]});
      if (const auto* quad = std::get_if<QuadLight>(&lights.lights.lights()[id])) {
        ++quads;
        near += quad_light_detail::IsNear(*quad, from);
      }
      if (const auto* triangle = std::get_if<TriangleLight>(&lights.lights.lights()[id])) {
        ++triangles;
        near_triangles += triangle_light_detail::IsNear(*triangle, from);
      }
      const bool valid = samples.valid[lane] != 0 && !IsBlack(samples.radiance.Get(lane));
      ASSERT_EQ(valid, one.has_value()) << "light " << id;
      if (!one) continue;
      EXPECT_LT(Length(samples.wi.Get(lane) - one->wi), 1e-5f);
      // The roundings of a cosine are large beside it where it is small.
      EXPECT_NEAR(1 / samples.pdf[lane], 1 / one->pdf, 1e-5f / one->pdf + 1e-7f) << "light " << id;
      EXPECT_EQ(samples.radiance.Get(lane), one->radiance);
      EXPECT_EQ(samples.delta[lane] != 0, one->delta);
      if (one->infinite) continue;
      EXPECT_LT(Length(samples.end.Get(lane) - one->end), 1e-4f) << "light " << id;
    }
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(quads - near, 1000);
  EXPECT_GT(near_triangles, 1000);
  EXPECT_GT(triangles - near_triangles, 1000);
}

}  // namespace
}  // namespace strata
