#include <gtest/gtest.h>

#include "tests/bsdf/cases.h"
#include "tests/statistics/density_checks.h"
#include "tests/statistics/random.h"

// Sample, Pdf and Eval of every BSDF agree with each other. By hand, ten million directions of each
// against an error of 1 %:
//
//   test_bsdf --gtest_also_run_disabled_tests --gtest_filter='*OnePercentOfShape*'

namespace strata {
namespace {

/// Draws the directions that have a density.
auto Sampling(const Bsdf& bsdf, Vec3f wo, TestRandom* random) {
  return [&bsdf, wo, random]() -> std::optional<Vec3f> {
    const float u_lobe = random->Float();
    const std::optional<BsdfSample> s = Sample(bsdf, wo, u_lobe, random->Float2());
    if (!s || s->delta) return std::nullopt;
    return s->wi;
  };
}

bool HasContinuousPart(const Bsdf& bsdf) { return !IsDelta(bsdf); }

/// At each angle, and the directions of a BSDF at all angles together.
void ExpectDensities(const DensityEffort& effort) {
  std::vector<BsdfCase> cases = AllBsdfCases();
  // Not reciprocal in these terms, where wo is the z axis, so not among those.
  for (const float g : {-0.7f, 0.0f, 0.9f})
    cases.push_back({"phase function of g " + std::to_string(g), PhaseFunction{g}});
  DensityChecks checks(cases.size() * (TestAngles().size() + 1), effort);
  uint64_t seed = 1;
  for (const BsdfCase& c : cases) {
    if (!HasContinuousPart(c.bsdf)) continue;
    double statistic = 0, degrees = 0;
    for (const double angle : TestAngles()) {
      const Vec3f wo = DirectionAt(angle);
      const std::string name = c.name + " at " + std::to_string(angle) + " degrees";
      TestRandom random(seed++);
      const auto result = checks.ExpectDirections(name, Sampling(c.bsdf, wo, &random),
                                                  [&](Vec3f wi) { return Pdf(c.bsdf, wo, wi); });
      EXPECT_LE(result.integral, 1 + 1e-3) << name;
      statistic += result.chi_square.statistic;
      degrees += result.chi_square.degrees;
    }
    EXPECT_GT(ChiSquareTail(statistic, degrees), checks.level()) << c.name << " at all angles";
  }
}
TEST(BsdfSampling, DirectionsFollowTheDensity) { ExpectDensities({50000, {}}); }
TEST(BsdfSampling, DISABLED_DirectionsAreToldFromOnePercentOfShape) { ExpectDensities(kByHand); }

// The test above must see a density that is off by a tenth in roughness, or in a lobe's share.
TEST(BsdfSamplingControl, AWrongDensityIsCaught) {
  const Vec3f wo = DirectionAt(40);
  const auto p_value = [&](const Bsdf& bsdf, const auto& pdf, uint64_t seed) {
    TestRandom random(seed);
    return TestDirections(Sampling(bsdf, wo, &random), pdf, 200000).chi_square.p;
  };
  const Bsdf truth = ConductorBsdf{kCopperEta, kCopperK, Ggx::FromAlpha(0.2f, 0.2f)};
  const Bsdf wrong = ConductorBsdf{kCopperEta, kCopperK, Ggx::FromAlpha(0.205f, 0.205f)};
  EXPECT_LT(p_value(
                truth, [&](Vec3f wi) { return Pdf(wrong, wo, wi); }, 1),
            1e-6);
  const Bsdf glass = DielectricBsdf{1.5f, Ggx::FromAlpha(0.2f, 0.2f)};
  const Bsdf denser = DielectricBsdf{1.55f, Ggx::FromAlpha(0.2f, 0.2f)};
  EXPECT_LT(p_value(
                glass, [&](Vec3f wi) { return Pdf(denser, wo, wi); }, 2),
            1e-6);
  const Bsdf plastic = CoatedDiffuseBsdf(TestCoat(0.2f), Rgb::Gray(0.5f));
  const auto missing_a_tenth = [&](Vec3f wi) { return 0.97f * Pdf(plastic, wo, wi); };
  EXPECT_LT(p_value(plastic, missing_a_tenth, 3), 1e-6);
}

TEST(BsdfSampling, WeightIsValueOverDensity) {
  TestRandom random(7);
  for (const BsdfCase& c : AllBsdfCases()) {
    for (const double angle : TestAngles()) {
      const Vec3f wo = DirectionAt(angle);
      int continuous = 0, off = 0;
      for (int i = 0; i < 5000; ++i) {
        const float u_lobe = random.Float();
        const std::optional<BsdfSample> s = Sample(c.bsdf, wo, u_lobe, random.Float2());
        if (!s) continue;
        ASSERT_TRUE(IsFinite(s->weight) && IsFinite(s->wi) && std::isfinite(s->pdf)) << c.name;
        ASSERT_GT(s->pdf, 0) << c.name;
        ASSERT_NEAR(LengthSquared(s->wi), 1, 1e-4) << c.name << " at " << angle;
        ASSERT_EQ(s->transmission, s->wi.z * wo.z < 0) << c.name;
        if (s->delta) continue;
        ++continuous;
        const float pdf = Pdf(c.bsdf, wo, s->wi);
        const Rgb value = Eval(c.bsdf, wo, s->wi);
        // A direction of single precision is a few 1e-7 off, sharp lobes magnify that.
        const bool agrees =
            std::fabs(pdf - s->pdf) <= 0.01f * s->pdf &&
            MaxComponent(value - s->weight * s->pdf) <= 0.01f * MaxComponent(value) &&
            MaxComponent(s->weight * s->pdf - value) <= 0.01f * MaxComponent(value);
        off += !agrees;
      }
      EXPECT_LE(off, continuous / 200) << c.name << " at " << angle << " degrees";
    }
  }
}

TEST(BsdfSampling, DeltaPartsHaveNoValueOrDensity) {
  for (const BsdfCase& c : AllBsdfCases()) {
    if (!IsDelta(c.bsdf)) continue;
    for (const double angle : TestAngles()) {
      const Vec3f wo = DirectionAt(angle);
      const std::optional<BsdfSample> s = Sample(c.bsdf, wo, 0.999f, {0.3f, 0.4f});
      ASSERT_TRUE(s.has_value()) << c.name;
      EXPECT_TRUE(s->delta) << c.name;
      EXPECT_EQ(Pdf(c.bsdf, wo, s->wi), 0) << c.name;
      EXPECT_EQ(Eval(c.bsdf, wo, s->wi), Rgb{}) << c.name;
    }
  }
}

// Random and degenerate directions, alphas down to the threshold, extreme indices.
TEST(BsdfSampling, NothingIsNegativeOrNotANumber) {
  TestRandom random(11);
  std::vector<BsdfCase> cases = AllBsdfCases();
  for (const float eta : {1.0001f, 1.01f, 3.0f, 0.3f}) {
    for (const float alpha : {1e-3f, 0.3f}) {
      cases.push_back(
          {"eta " + std::to_string(eta), DielectricBsdf{eta, Ggx::FromAlpha(alpha, alpha)}});
    }
  }
  cases.push_back(
      {"one smooth axis", ConductorBsdf{kCopperEta, kCopperK, Ggx::FromAlpha(0.5f, 0)}});
  const auto direction = [&](int i) {
    const float z = i % 3 == 0   ? 1e-6f * random.Float()
                    : i % 3 == 1 ? 1 - 1e-6f * random.Float()
                                 : random.Float();
    const SinCosResult<float> phi = SinCos2Pi(random.Float());
    const float s = std::sqrt(1 - z * z);
    return Vec3f{s * phi.cos, s * phi.sin, random.Float() < 0.5f ? z : -z};
  };
  constexpr float kLast = 1 - 0x1p-24f;
  for (const BsdfCase& c : cases) {
    for (int i = 0; i < 3000; ++i) {
      const Vec3f wo = direction(i), wi = direction(i / 3);
      const Rgb value = Eval(c.bsdf, wo, wi);
      const float pdf = Pdf(c.bsdf, wo, wi);
      ASSERT_TRUE(IsFinite(value) && std::isfinite(pdf)) << c.name << " " << wo.z << " " << wi.z;
      ASSERT_GE(std::min({value.r, value.g, value.b, pdf}), 0) << c.name;
      const Vec2f u = i % 5 == 0 ? Vec2f{0, 0} : i % 5 == 1 ? Vec2f{kLast, kLast} : random.Float2();
      const float u_lobe = i % 7 == 0 ? 0 : i % 7 == 1 ? kLast : random.Float();
      if (const std::optional<BsdfSample> s = Sample(c.bsdf, wo, u_lobe, u)) {
        ASSERT_TRUE(IsFinite(s->weight) && IsFinite(s->wi) && std::isfinite(s->pdf)) << c.name;
        ASSERT_GT(s->pdf, 0) << c.name;
        ASSERT_GE(std::min({s->weight.r, s->weight.g, s->weight.b}), 0) << c.name;
        ASSERT_NEAR(LengthSquared(s->wi), 1, 1e-4) << c.name;
      }
      ASSERT_TRUE(IsFinite(Albedo(c.bsdf, wo))) << c.name;
    }
  }
}

/// Both at once are the two one by one.
TEST(BsdfValueTest, IsEvalAndPdf) {
  TestRandom random(5);
  for (const BsdfCase& c : AllBsdfCases()) {
    for (int i = 0; i < 1000; ++i) {
      const Vec3f wo = SampleUniformSphere(random.Float2());
      // Sampled as well as any, so that sharp lobes are met.
      const float u_lobe = random.Float();
      const std::optional<BsdfSample> sample = Sample(c.bsdf, wo, u_lobe, random.Float2());
      const Vec3f wi = sample && i % 2 == 0 ? sample->wi : SampleUniformSphere(random.Float2());
      const BsdfValue both = EvalPdf(c.bsdf, wo, wi);
      ASSERT_EQ(both.f, Eval(c.bsdf, wo, wi)) << c.name;
      ASSERT_EQ(both.pdf, Pdf(c.bsdf, wo, wi)) << c.name;
    }
  }
}

}  // namespace
}  // namespace strata
