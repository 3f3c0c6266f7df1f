#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/bsdf/cases.h"
#include "tests/statistics/chi_square.h"
#include "tests/statistics/direction_test.h"
#include "tests/statistics/random.h"
#include "tests/statistics/sphere_quadrature.h"
#include "worker/bsdf/power_cosine.h"

// Lobes by powers of the cosine (Blinn; Ashikhmin and Shirley) and sums of lobes, against closed
// forms. That sampling follows the densities of their BSDFs is tested with all others in
// sampling_test.cpp; here the controls are errors of shape of one per cent.

namespace strata {
namespace {

constexpr double kPiDouble = std::numbers::pi;

Vec3f DirectionOf(double cos_theta, double phi) {
  const double s = std::sqrt(1 - cos_theta * cos_theta);
  return {static_cast<float>(s * std::cos(phi)), static_cast<float>(s * std::sin(phi)),
          static_cast<float>(cos_theta)};
}

const PowerCosine kPowers[] = {{0, 0}, {1, 1}, {10, 1000}, {300, 2}, {1e5f, 1e5f}};

TEST(PowerCosine, IsThePower) {
  for (const PowerCosine& lobe : kPowers) {
    for (const double phi : {0.1, 1.2, 4.0}) {
      const double n = lobe.nu * std::pow(std::cos(phi), 2) + lobe.nv * std::pow(std::sin(phi), 2);
      for (const double wanted : {0.9, 0.5, 0.1}) {
        const double cosine = n > 0 ? std::pow(wanted, 1 / n) : wanted;
        EXPECT_NEAR(lobe.Power(DirectionOf(cosine, phi)), std::pow(cosine, n), 1e-4 * wanted)
            << lobe.nu << " " << lobe.nv;
      }
    }
  }
}

TEST(PowerCosine, DensitiesAreNormalized) {
  for (const PowerCosine& lobe : kPowers) {
    if (lobe.nu > 1e4f) continue;  // Too narrow to be met by plain quadrature.
    const auto upper = [&](const auto& f) {
      return IntegrateSphere([&](Vec3f m) { return m.z > 0 ? f(m) : 0.0f; });
    };
    EXPECT_NEAR(upper([&](Vec3f m) { return lobe.Pdf(m); }), 1, 1e-3) << lobe.nu;
    if (lobe.nu != lobe.nv) continue;
    // Blinn's microfacets cover the surface once.
    EXPECT_NEAR(upper([&](Vec3f m) { return (lobe.nu + 2) * 0.5f * kInvPi * lobe.Power(m) * m.z; }),
                1, 1e-3)
        << lobe.nu;
  }
}

template <typename Pdf>
ChiSquareResult TestNormals(const PowerCosine& lobe, const Pdf& pdf, uint64_t seed, int samples) {
  TestRandom random(seed);
  const auto sample = [&]() -> std::optional<Vec3f> { return lobe.Sample(random.Float2()); };
  return TestDirections(
             sample, [&](Vec3f m) { return m.z > 0 ? pdf(m) : 0.0f; }, samples)
      .chi_square;
}

TEST(PowerCosine, NormalsFollowTheDensity) {
  const double level = SidakLevel(0.01, static_cast<int>(std::size(kPowers)));
  uint64_t seed = 1;
  for (const PowerCosine& lobe : kPowers) {
    const ChiSquareResult result = TestNormals(
        lobe, [&](Vec3f m) { return lobe.Pdf(m); }, seed++, 200000);
    EXPECT_GT(result.p, level) << lobe.nu << " " << lobe.nv << ": " << result.statistic << " with "
                               << result.degrees << " degrees of freedom";
  }
}

TEST(PowerCosineControl, AnExponentThatIsOffByAPerCentIsCaught) {
  const PowerCosine lobe = {40, 200};
  for (const PowerCosine& wrong : {PowerCosine{40.4f, 200}, PowerCosine{40, 202}}) {
    EXPECT_LT(TestNormals(
                  lobe, [&](Vec3f m) { return wrong.Pdf(m); }, 1, 8000000)
                  .p,
              1e-6);
  }
}

TEST(Blinn, IsKnownAlongTheNormal) {
  // D (n + 2) / (2 pi), F 0.04, G 1, over 4 cos cos.
  const Vec3f z = {0, 0, 1};
  for (const float n : {0.0f, 3.0f, 50.0f}) {
    const BlinnBsdf glass = {Rgb::Gray(1.5f), {}, n};
    EXPECT_NEAR(Eval(glass, z, z).g, 0.04 * (n + 2) / (8 * kPiDouble), 1e-5 * (n + 2));
    EXPECT_NEAR(Pdf(glass, z, z), (n + 1) / (8 * kPiDouble), 1e-5 * (n + 2));
  }
}

TEST(Blinn, CavitiesMaskAtGrazingAngles) {
  // Where the far wall of a cavity hides the near one: G = 2 (m.z)(o.z) / (o.m).
  const BlinnBsdf mirror = {Rgb::Gray(1), Rgb::Gray(1e4f), 20};
  const Vec3f wo = DirectionOf(0.1, 0.3), wi = DirectionOf(0.8, 0.9);
  const Vec3f m = Normalize(wo + wi);
  const double g = std::min({1.0f, 2 * m.z * wo.z / Dot(wo, m), 2 * m.z * wi.z / Dot(wo, m)});
  ASSERT_LT(g, 0.9);
  const double d = 22 / (2 * kPiDouble) * std::pow(static_cast<double>(m.z), 20);
  EXPECT_NEAR(Eval(mirror, wo, wi).g, d * g / (4 * wo.z), 1e-3 * d * g / (4 * wo.z));
}

TEST(AshikhminShirley, IsKnownAlongTheNormal) {
  const Vec3f z = {0, 0, 1};
  const AshikhminShirleyBsdf bsdf = {Rgb::Gray(0.6f), Rgb::Gray(0.1f), {30, 200}};
  const double glossy = std::sqrt(31.0 * 201.0) / (8 * kPiDouble) * 0.1;
  const double diffuse = 28 * 0.6 * 0.9 / (23 * kPiDouble) * std::pow(31 / 32.0, 2);
  EXPECT_NEAR(Eval(bsdf, z, z).g, glossy + diffuse, 1e-5);
}

TEST(AshikhminShirley, DiffuseAlbedoIsExact) {
  // Without the glossy part: a Schlick term of Rs = 0 is left at grazing angles alone.
  const AshikhminShirleyBsdf bsdf = {Rgb::Gray(0.7f), Rgb::Gray(0.2f), {1e4f, 1e4f}};
  for (const double cosine : {1.0, 0.6, 0.2}) {
    const Vec3f wo = DirectionOf(cosine, 0.4);
    const double albedo = IntegrateSphere([&](Vec3f wi) {
      if (!(wi.z > 0)) return 0.0f;
      const float g = (1 - std::pow(1 - 0.5f * wi.z, 5.0f)) * (1 - std::pow(1 - 0.5f * wo.z, 5.0f));
      return 28 * 0.7f * 0.8f / 23 * kInvPi * g * wi.z;
    });
    EXPECT_NEAR(bsdf.DiffuseAlbedo(wo.z).g, albedo, 1e-3);
  }
}

TEST(AshikhminShirley, StretchesAcrossTheLargerExponent) {
  const AshikhminShirleyBsdf brushed = {{}, Rgb::Gray(1), {10, 1000}};
  const Vec3f wo = {0, 0, 1};
  EXPECT_GT(Eval(brushed, wo, DirectionOf(0.8, 0)).g,
            10 * Eval(brushed, wo, DirectionOf(0.8, kPiDouble / 2)).g);
}

// ---- the white furnace ----

/// The mean weight of samples: the albedo, for lobes that reflect all at each meeting.
MeanWithError WhiteAlbedo(const Bsdf& bsdf, double degrees, uint64_t seed) {
  TestRandom random(seed);
  const Vec3f wo = DirectionAt(degrees);
  MeanWithError mean;
  for (int i = 0; i < 40000; ++i) {
    const float u_lobe = random.Float();
    const std::optional<BsdfSample> s = Sample(bsdf, wo, u_lobe, random.Float2());
    mean.Add(s ? s->weight.g : 0);
  }
  return mean;
}

TEST(WhiteFurnace, NoLobeReturnsMoreThanItGets) {
  const Rgb white = Rgb::Gray(1), mirror = Rgb::Gray(1e4f);
  std::vector<BsdfCase> cases;
  for (const float n : {0.0f, 1.0f, 10.0f, 100.0f, 1e4f}) {
    cases.push_back({"Blinn " + std::to_string(n), BlinnBsdf{white, mirror, n}});
    for (const float rs : {0.0f, 0.05f, 0.5f, 1.0f}) {
      cases.push_back({"Ashikhmin-Shirley " + std::to_string(n) + " " + std::to_string(rs),
                       AshikhminShirleyBsdf{white, Rgb::Gray(rs), {n, 2 * n}}});
    }
  }
  for (const float alpha : {0.01f, 0.1f, 0.5f, 1.0f}) {
    cases.push_back({"GGX " + std::to_string(alpha),
                     ConductorBsdf{white, mirror, Ggx::FromAlpha(alpha, alpha)}});
    cases.push_back({"anisotropic GGX " + std::to_string(alpha),
                     ConductorBsdf{white, mirror, Ggx::FromAlpha(alpha, 0.1f * alpha)}});
  }
  uint64_t seed = 1;
  for (const BsdfCase& c : cases) {
    for (const double angle : {0.0, 45.0, 75.0, 88.0}) {
      const MeanWithError albedo = WhiteAlbedo(c.bsdf, angle, seed++);
      EXPECT_LE(albedo.mean(), 1 + 1e-4 + 5 * albedo.error())
          << c.name << " at " << angle << " degrees";
      EXPECT_GT(albedo.mean(), 0.1) << c.name << " at " << angle << " degrees";
    }
  }
}

TEST(WhiteFurnace, WhatScatteringOnceLosesIsKnownAlongTheNormal) {
  // GGX at alpha 1: 1 - ln 2 is left.
  const MeanWithError ggx =
      WhiteAlbedo(ConductorBsdf{Rgb::Gray(1), Rgb::Gray(1e4f), Ggx::FromAlpha(1, 1)}, 0, 1);
  EXPECT_NEAR(ggx.mean(), 1 - std::numbers::ln2, 5 * ggx.error());
  // Blinn: what a facet at the angle m reflects is hidden in part from 30 degrees on, G = 2 cos 2m,
  // and goes down from 45 on.
  for (const double n : {0.0, 4.0}) {
    const BlinnBsdf white = {Rgb::Gray(1), Rgb::Gray(1e4f), static_cast<float>(n)};
    double left = 0;
    constexpr int kSteps = 100000;
    for (int i = 0; i < kSteps; ++i) {
      const double c = std::sqrt(0.5) + (1 - std::sqrt(0.5)) * (i + 0.5) / kSteps;
      const double g = std::min(1.0, 2 * (2 * c * c - 1));
      left += (n + 2) * std::pow(c, n + 1) * g * (1 - std::sqrt(0.5)) / kSteps;
    }
    const MeanWithError blinn = WhiteAlbedo(white, 0, 2);
    EXPECT_NEAR(blinn.mean(), left, 5 * blinn.error() + 1e-3) << n;
  }
}

// ---- sums of lobes ----

TEST(Mixture, IsTheWeightedSum) {
  MixtureParts parts;
  const DiffuseBsdf paint = {{0.2f, 0.5f, 0.1f}};
  const ConductorBsdf metal = {kCopperEta, kCopperK, Ggx::FromAlpha(0.2f, 0.2f)};
  parts.Add(paint, 0.3f);
  parts.Add(metal, 0.7f);
  const Bsdf mixture = MixtureBsdf{&parts};
  const Vec3f wo = DirectionAt(40), wi = DirectionOf(0.7, 2.5);
  const Rgb sum = Eval(paint, wo, wi) * 0.3f + Eval(metal, wo, wi) * 0.7f;
  EXPECT_FLOAT_EQ(Eval(mixture, wo, wi).r, sum.r);
  EXPECT_FLOAT_EQ(Eval(mixture, wo, wi).g, sum.g);
  EXPECT_FALSE(IsDelta(mixture));
  EXPECT_FALSE(Transmits(mixture));
}

TEST(MixtureControl, AShareThatIsOffByAPerCentIsCaught) {
  // Shares go by weight and albedo, here about equal: one that is off by a per cent of itself must
  // not pass. The lobes hardly overlap, so that it shows in all of either.
  MixtureParts parts;
  const DiffuseBsdf paint = {Rgb::Gray(0.8f)};
  const AshikhminShirleyBsdf gloss = {{}, Rgb::Gray(0.8f), {100, 100}};
  parts.Add(paint, 0.5f);
  parts.Add(gloss, 0.5f);
  const Bsdf mixture = MixtureBsdf{&parts};
  const Vec3f wo = DirectionAt(40);
  const auto test = [&](auto pdf) {
    TestRandom random(3);
    const auto sample = [&]() -> std::optional<Vec3f> {
      const float u_lobe = random.Float();
      const auto s = Sample(mixture, wo, u_lobe, random.Float2());
      return s ? std::optional<Vec3f>(s->wi) : std::nullopt;
    };
    return TestDirections(sample, pdf, 2000000).chi_square.p;
  };
  const float share = Albedo(paint, wo).g / (Albedo(paint, wo).g + Albedo(gloss, wo).g);
  const auto density = [&](float part) {
    return
        [&, part](Vec3f wi) { return part * Pdf(paint, wo, wi) + (1 - part) * Pdf(gloss, wo, wi); };
  };
  EXPECT_GT(test(density(share)), 1e-3);
  EXPECT_LT(test(density(share * 1.01f)), 1e-6);
}

}  // namespace
}  // namespace strata
