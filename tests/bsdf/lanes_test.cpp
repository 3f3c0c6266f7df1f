#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/bsdf/cases.h"
#include "tests/statistics/random.h"
#include "worker/bsdf/coated_diffuse_lanes.h"
#include "worker/bsdf/dielectric.h"
#include "worker/bsdf/dielectric_lanes.h"
#include "worker/sampling/warp.h"

// Eight coated bases, and eight smooth borders, at once against one at a time.

namespace strata {
namespace {

const std::vector<Coat>& Coats() {
  static const CoatInterface none(1), diamond(2.4f);
  static const std::vector<Coat> coats = {
      TestCoat(0),
      TestCoat(0, {0.01f, 0.3f, 1}),
      TestCoat(0.001f),
      TestCoat(0.1f, Rgb::Gray(0.01f)),
      TestCoat(1, {0, 0.2f, 2}),
      {&none, Ggx::FromAlpha(0.3f, 0.3f), {}},
      {&diamond, {}, {}},
      {&diamond, Ggx::FromAlpha(0.5f, 0.5f), Rgb::Gray(0.5f)},
  };
  return coats;
}

Vec3f AnyDirection(TestRandom& random) { return SampleUniformSphere(random.Float2()); }

/// Equal but for a few roundings. Densities of narrow lobes are steep: they have the larger bound.
void ExpectSame(float a, float b, float bound = 1e-5f) {
  EXPECT_NEAR(a, b, bound * std::max(std::fabs(b), 1e-3f));
}
void ExpectSame(Rgb a, Rgb b, float bound = 1e-5f) {
  ExpectSame(a.r, b.r, bound);
  ExpectSame(a.g, b.g, bound);
  ExpectSame(a.b, b.b, bound);
}

/// Eight vertices, each with a coat of its own.
class CoatedVertices {
 public:
  explicit CoatedVertices(TestRandom& random) {
    for (int lane = 0; lane < kLanes; ++lane) {
      rows_[lane].SetCoat(CoatedDiffuseBsdf(Coats()[lane], {}));
      materials_[lane] = lane;
      const Rgb reflectance = {random.Float(), random.Float(), lane == 3 ? 1.0f : 0.0f};
      reflectances_.Set(lane, reflectance);
      bsdfs[lane] = CoatedDiffuseBsdf(Coats()[lane], reflectance);
      wo[lane] = AnyDirection(random);
      wo_lanes_.Set(lane, wo[lane]);
    }
    lanes = CoatedDiffuseLanes(rows_.data(), materials_, reflectances_, wo_lanes_, SameInt(-1));
  }

  std::array<CoatedDiffuseBsdf, kLanes> bsdfs;
  std::array<Vec3f, kLanes> wo;
  CoatedDiffuseLanes lanes;

 private:
  std::array<BaseRow, kLanes> rows_;
  IntLanes materials_ = {};
  RgbLanes reflectances_;
  Vec3Lanes wo_lanes_;
};

TEST(CoatedDiffuseLanes, AreWorthWhatEachIs) {
  TestRandom random(1);
  int lit = 0;
  for (int i = 0; i < 2000; ++i) {
    const CoatedVertices vertices(random);
    Vec3Lanes wi;
    for (int lane = 0; lane < kLanes; ++lane) wi.Set(lane, AnyDirection(random));
    const BsdfValueLanes values = vertices.lanes.EvalPdf(wi);
    const RgbLanes albedo = vertices.lanes.Albedo();
    for (int lane = 0; lane < kLanes; ++lane) {
      const BsdfValue one = EvalPdf(vertices.bsdfs[lane], vertices.wo[lane], wi.Get(lane));
      ExpectSame(values.f.Get(lane), one.f);
      ExpectSame(values.pdf[lane], one.pdf);
      ExpectSame(albedo.Get(lane), Albedo(vertices.bsdfs[lane], vertices.wo[lane]));
      lit += one.pdf > 0;
    }
  }
  EXPECT_GT(lit, 2000 * kLanes / 3);
}

TEST(CoatedDiffuseLanes, GoWhereEachGoes) {
  TestRandom random(2);
  int deltas = 0, valid = 0;
  for (int i = 0; i < 2000; ++i) {
    const CoatedVertices vertices(random);
    FloatLanes u_lobe = {};
    Vec2Lanes u;
    for (int lane = 0; lane < kLanes; ++lane) {
      u_lobe[lane] = random.Float();
      u.x[lane] = random.Float();
      u.y[lane] = random.Float();
    }
    const BsdfSampleLanes samples = vertices.lanes.Sample(u_lobe, u, SampleCosineHemisphere(u));
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto one =
          Sample(vertices.bsdfs[lane], vertices.wo[lane], u_lobe[lane], {u.x[lane], u.y[lane]});
      EXPECT_EQ(samples.valid[lane] != 0, one.has_value());
      if (!one) continue;
      ++valid;
      deltas += one->delta;
      EXPECT_EQ(samples.delta[lane] != 0, one->delta);
      EXPECT_LT(Length(samples.wi.Get(lane) - one->wi), 1e-5f);
      ExpectSame(samples.weight.Get(lane), one->weight);
      ExpectSame(samples.pdf[lane], one->pdf, 1e-4f);
    }
  }
  EXPECT_GT(valid, 2000 * kLanes / 2);
  EXPECT_GT(deltas, 200);
}

TEST(SmoothDielectricLanes, GoWhereEachGoes) {
  TestRandom random(3);
  int transmitted = 0, reflected = 0, refused = 0;
  for (int i = 0; i < 4000; ++i) {
    FloatLanes eta = {}, u_lobe = {};
    Vec3Lanes wo;
    for (int lane = 0; lane < kLanes; ++lane) {
      eta[lane] = std::array{1.0f, 1.5f, 1 / 1.5f, 2.4f}[random.Bits() % 4];
      u_lobe[lane] = random.Float();
      wo.Set(lane, random.Float() < 0.01f ? Vec3f{1, 0, 0} : AnyDirection(random));
    }
    const SmoothDielectricSampleLanes samples = SampleSmoothDielectric(eta, wo, u_lobe);
    for (int lane = 0; lane < kLanes; ++lane) {
      const DielectricBsdf bsdf = {.eta = eta[lane]};
      const auto one = Sample(bsdf, wo.Get(lane), u_lobe[lane], {0.5f, 0.5f});
      ASSERT_EQ(samples.valid[lane] != 0, one.has_value());
      refused += !one;
      if (!one) continue;
      (one->transmission ? transmitted : reflected) += 1;
      EXPECT_EQ(samples.delta[lane] != 0, one->delta);
      EXPECT_LT(Length(samples.wi.Get(lane) - one->wi), 1e-6f);
      ExpectSame(samples.weight.Get(lane), one->weight, 1e-6f);
      ExpectSame(samples.pdf[lane], one->pdf, 1e-6f);
      ExpectSame(samples.eta2[lane], one->transmission ? one->eta * one->eta : 1, 1e-6f);
    }
  }
  EXPECT_GT(transmitted, 10000);
  EXPECT_GT(reflected, 4000);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace strata
