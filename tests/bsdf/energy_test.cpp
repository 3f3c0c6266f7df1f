#include <gtest/gtest.h>

#include "tests/bsdf/cases.h"
#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"

// Reciprocity, and where the light goes.

namespace strata {
namespace {

/// Scattered power over incident power by channel, with the error of its mean.
struct Furnace {
  MeanWithError r, g, b;
};
Furnace MeasureAlbedo(const Bsdf& bsdf, Vec3f wo, uint64_t seed, int samples = 40000) {
  TestRandom random(seed);
  Furnace furnace;
  for (int i = 0; i < samples; ++i) {
    const float u_lobe = random.Float();
    const std::optional<BsdfSample> s = Sample(bsdf, wo, u_lobe, random.Float2());
    // Power, not radiance: refraction concentrates the latter.
    const Rgb weight = s ? s->weight * (s->eta * s->eta) : Rgb{};
    furnace.r.Add(weight.r);
    furnace.g.Add(weight.g);
    furnace.b.Add(weight.b);
  }
  return furnace;
}

TEST(BsdfEnergy, NothingGainsPower) {
  uint64_t seed = 1;
  for (const BsdfCase& c : AllBsdfCases()) {
    for (const double angle : TestAngles()) {
      const Furnace furnace = MeasureAlbedo(c.bsdf, DirectionAt(angle), seed++);
      for (const MeanWithError& m : {furnace.r, furnace.g, furnace.b}) {
        EXPECT_LE(m.mean(), 1 + 1e-4 + 5 * m.error()) << c.name << " at " << angle << " degrees";
      }
    }
  }
}

TEST(BsdfEnergy, LosslessSurfacesReturnAll) {
  constexpr float kMirror = 1e4f;  // An index of i infinity reflects all.
  const std::vector<BsdfCase> cases = {
      {"white", DiffuseBsdf{Rgb::Gray(1)}},
      {"white transmission", DiffuseTransmissionBsdf{Rgb::Gray(0.4f), Rgb::Gray(0.6f)}},
      {"glass", DielectricBsdf{1.5f, {}}},
      {"index 1", DielectricBsdf{1, Ggx::FromAlpha(0.5f, 0.5f)}},
      {"pane", ThinDielectricBsdf{1.5f}},
      {"mirror", ConductorBsdf{Rgb::Gray(1), Rgb::Gray(kMirror), {}}},
      {"smooth coat on white", CoatedDiffuseBsdf(TestCoat(0), Rgb::Gray(1))},
      {"smooth coat on mirror",
       CoatedConductorBsdf(TestCoat(0), TestTrappedLight(), Rgb::Gray(1), Rgb::Gray(kMirror), {})},
  };
  uint64_t seed = 1;
  for (const BsdfCase& c : cases) {
    for (const double angle : TestAngles()) {
      const Furnace furnace = MeasureAlbedo(c.bsdf, DirectionAt(angle), seed++);
      EXPECT_NEAR(furnace.g.mean(), 1, 1e-3 + 5 * furnace.g.error())
          << c.name << " at " << angle << " degrees";
    }
  }
}

// What the microfacets of a rough coat do not reflect goes to the base, so white stays white; the
// tables behind it are interpolated.
TEST(BsdfEnergy, RoughCoatOnWhiteReturnsAll) {
  uint64_t seed = 1;
  for (const float alpha : {0.002f, 0.01f, 0.05f, 0.2f, 0.6f, 1.0f}) {
    const Bsdf bsdf = CoatedDiffuseBsdf(TestCoat(alpha), Rgb::Gray(1));
    for (const double angle : {0.0, 30.0, 60.0, 80.0, 87.0}) {
      const Furnace furnace = MeasureAlbedo(bsdf, DirectionAt(angle), seed++);
      EXPECT_NEAR(furnace.g.mean(), 1, 0.01 + 5 * furnace.g.error())
          << "alpha " << alpha << " at " << angle << " degrees";
    }
  }
}

// The weights of a metallic-roughness surface leave a white dielectric white at every angle, coated
// or passing light as well; the specification's own weights, by the microfacet's Fresnel term, do
// not: they are the control.
TEST(BsdfEnergy, WhiteMetallicRoughnessDielectricReturnsAll) {
  uint64_t seed = 1;
  for (const float alpha : {0.0f, 0.002f, 0.05f, 0.3f, 1.0f}) {
    const Bsdf bsdf =
        MetallicRoughnessBsdf(TestSchlickAlbedo(), {.base_color = Rgb::Gray(1), .alpha = alpha});
    for (const double angle : {0.0, 30.0, 60.0, 80.0, 87.0}) {
      const Furnace furnace = MeasureAlbedo(bsdf, DirectionAt(angle), seed++);
      EXPECT_NEAR(furnace.g.mean(), 1, 0.01 + 5 * furnace.g.error())
          << "alpha " << alpha << " at " << angle << " degrees";
    }
  }
  // By the specification's formula, at 80 degrees: reflection plus (1 - F(wo . m)) / pi.
  const Vec3f wo = DirectionAt(80);
  TestRandom random(seed);
  MeanWithError diffuse;
  for (int i = 0; i < 40000; ++i) {
    const Vec3f wi = SampleCosineHemisphere(random.Float2());
    const float grazing = MetallicRoughnessBsdf::Grazing(Dot(wo, Normalize(wo + wi)));
    diffuse.Add(1 - MetallicRoughnessBsdf::Fresnel(0.04f, 1, grazing));
  }
  const float mirror =
      MetallicRoughnessBsdf::Fresnel(0.04f, 1, MetallicRoughnessBsdf::Grazing(wo.z));
  EXPECT_GT(diffuse.mean() + mirror, 1.2);
}

// What its tables say of a metal is what the lobe returns.
TEST(MetallicRoughness, SpecularColoursMayExceedOne) {
  // KHR_materials_specular: f0 is min(0.04 colour, 1) specular.
  const auto f0 = [](float color, float specular) {
    return MetallicRoughnessBsdf(TestSchlickAlbedo(),
                                 {.specular_color = Rgb::Gray(color), .specular = specular})
        .f0.g;
  };
  EXPECT_FLOAT_EQ(f0(2, 1), 0.08f);
  EXPECT_FLOAT_EQ(f0(10, 0.5f), 0.2f);
  EXPECT_FLOAT_EQ(f0(100, 0.5f), 0.5f);
}

TEST(BsdfEnergy, SchlickTablesAreTheLobesAlbedo) {
  uint64_t seed = 1;
  const Rgb color = {0.9f, 0.5f, 0.1f};
  for (const float alpha : {0.05f, 0.3f, 1.0f}) {
    const Bsdf bsdf = MetallicRoughnessBsdf(TestSchlickAlbedo(),
                                            {.base_color = color, .metallic = 1, .alpha = alpha});
    for (const double angle : {0.0, 45.0, 75.0}) {
      const Vec3f wo = DirectionAt(angle);
      const Furnace furnace = MeasureAlbedo(bsdf, wo, seed++);
      EXPECT_NEAR(furnace.g.mean(), Albedo(bsdf, wo).g, 0.004 + 5 * furnace.g.error())
          << "alpha " << alpha << " at " << angle << " degrees";
    }
  }
}

// The like for a metal that reflects all: what it spreads beyond the critical angle comes out.
TEST(BsdfEnergy, CoatOnPerfectMetalReturnsAll) {
  uint64_t seed = 1;
  for (const float border : {0.0f, 0.05f, 0.3f}) {
    for (const float alpha : {0.003f, 0.03f, 0.3f, 1.0f}) {
      const Bsdf bsdf = CoatedConductorBsdf(TestCoat(border), TestTrappedLight(), Rgb::Gray(1),
                                            Rgb::Gray(1e4f), Ggx::FromAlpha(alpha, alpha));
      for (const double angle : {0.0, 30.0, 60.0, 80.0}) {
        const Furnace furnace = MeasureAlbedo(bsdf, DirectionAt(angle), seed++);
        EXPECT_NEAR(furnace.g.mean(), 1, 0.02 + 5 * furnace.g.error())
            << "alphas " << border << " and " << alpha << " at " << angle << " degrees";
      }
    }
  }
}

TEST(BsdfEnergy, AlbedoIsCloseToWhatSamplesSay) {
  uint64_t seed = 1;
  for (const BsdfCase& c : AllBsdfCases()) {
    for (const double angle : {0.0, 40.0, 75.0}) {
      const Vec3f wo = DirectionAt(angle);
      const Furnace furnace = MeasureAlbedo(c.bsdf, wo, seed++);
      const Rgb claimed = Albedo(c.bsdf, wo);
      // That of bare microfacets is an upper bound: it leaves out what single scattering loses.
      const bool bare = std::holds_alternative<ConductorBsdf>(c.bsdf) ||
                        std::holds_alternative<DielectricBsdf>(c.bsdf) ||
                        std::holds_alternative<BlinnBsdf>(c.bsdf) ||
                        std::holds_alternative<AshikhminShirleyBsdf>(c.bsdf);
      const double below = bare ? 1 : 0.1;
      for (const auto& [m, value] :
           {std::pair{furnace.r, claimed.r}, {furnace.g, claimed.g}, {furnace.b, claimed.b}}) {
        EXPECT_GE(value, m.mean() - 0.01 - 5 * m.error()) << c.name << " at " << angle;
        EXPECT_LE(value, m.mean() + below + 5 * m.error()) << c.name << " at " << angle;
      }
    }
  }
  // Where nothing is left out the claim is exact.
  const Bsdf plastic = CoatedDiffuseBsdf(TestCoat(0), {0.8f, 0.5f, 0.2f});
  for (const double angle : {0.0, 40.0, 75.0, 140.0}) {
    const Furnace furnace = MeasureAlbedo(plastic, DirectionAt(angle), seed++);
    EXPECT_NEAR(Albedo(plastic, DirectionAt(angle)).g, furnace.g.mean(),
                2e-3 + 5 * furnace.g.error());
  }
}

TEST(BsdfEnergy, ScatteringIsReciprocal) {
  TestRandom random(3);
  for (const BsdfCase& c : AllBsdfCases()) {
    if (IsDelta(c.bsdf)) continue;
    const auto* glass = std::get_if<DielectricBsdf>(&c.bsdf);
    const auto index = [&](Vec3f w) { return glass && w.z < 0 ? glass->eta : 1; };
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
      const float z0 = 2 * random.Float() - 1;
      const SinCosResult<float> phi = SinCos2Pi(random.Float());
      const float s = std::sqrt(1 - z0 * z0);
      const Vec3f wo = {s * phi.cos, s * phi.sin, z0};
      // Sampled, so that sharp lobes are met.
      const float u_lobe = random.Float();
      const std::optional<BsdfSample> sample = Sample(c.bsdf, wo, u_lobe, random.Float2());
      if (!sample || sample->delta) continue;
      const Vec3f wi = sample->wi;
      if (std::fabs(wi.z) < 0.02f || std::fabs(wo.z) < 0.02f) continue;
      // Veach 1997, 5.2: f(wo, wi) / eta_o^2 is symmetric, with radiance along wo.
      const float there = Eval(c.bsdf, wo, wi).g / std::fabs(wi.z) / (index(wo) * index(wo));
      const float back = Eval(c.bsdf, wi, wo).g / std::fabs(wo.z) / (index(wi) * index(wi));
      ++compared;
      ASSERT_NEAR(there, back, 0.01f * std::max(there, back) + 1e-6f)
          << c.name << " " << wo.z << " " << wi.z;
    }
    EXPECT_GT(compared, 500) << c.name;
  }
}

// The measures above must see a percent that should not be there.
TEST(BsdfEnergyControl, AGainOfAPercentIsCaught) {
  const Furnace furnace = MeasureAlbedo(DiffuseBsdf{Rgb::Gray(1.01f)}, DirectionAt(40), 1);
  EXPECT_GT(furnace.g.mean(), 1 + 1e-4 + 5 * furnace.g.error());
}

TEST(BsdfFresnel, KnownValues) {
  EXPECT_NEAR(FresnelDielectric(1.0f, 1.5f).reflectance, 0.04, 1e-6);
  EXPECT_NEAR(FresnelDielectric(1.0f, 1 / 1.5f).reflectance, 0.04, 1e-6);
  EXPECT_EQ(FresnelDielectric(0.3f, 1 / 1.5f).reflectance, 1);  // Beyond the critical angle.
  EXPECT_EQ(FresnelDielectric(0.3f, 1.0f).reflectance, 0);
  EXPECT_NEAR(FresnelDielectric(0.0f, 1.5f).reflectance, 1, 1e-6);
  // Brewster's angle: tan = eta, where only the perpendicular part is reflected.
  const float brewster = 1 / std::sqrt(1 + 1.5f * 1.5f);
  const double perpendicular = (1 - 1.5 * 1.5) / (1 + 1.5 * 1.5);
  EXPECT_NEAR(FresnelDielectric(brewster, 1.5f).reflectance, 0.5 * perpendicular * perpendicular,
              1e-6);
  // At normal incidence ((n-1)^2 + k^2) / ((n+1)^2 + k^2).
  EXPECT_NEAR(FresnelConductor(1, 0.25f, 3.3f),
              (0.75 * 0.75 + 3.3 * 3.3) / (1.25 * 1.25 + 3.3 * 3.3), 1e-6);
  // Without absorption a metal is a dielectric.
  for (const float cosine : {0.05f, 0.3f, 0.7f, 0.99f}) {
    EXPECT_NEAR(FresnelConductor(cosine, 1.5f, 0), FresnelDielectric(cosine, 1.5f).reflectance,
                1e-5);
  }
}

TEST(BsdfEnergy, RefractionReportsTheIndexAndScalesRadiance) {
  const Bsdf glass = DielectricBsdf{1.5f, {}};
  const std::optional<BsdfSample> in = Sample(glass, DirectionAt(40), 0.9f, {});
  ASSERT_TRUE(in && in->transmission);
  EXPECT_FLOAT_EQ(in->eta, 1.5f);
  EXPECT_FLOAT_EQ(in->weight.g, 1 / 2.25f);
  const double sine = std::sqrt(in->wi.x * in->wi.x + in->wi.y * in->wi.y);
  EXPECT_NEAR(sine, std::sin(Radians(40)) / 1.5, 1e-6);
  const std::optional<BsdfSample> out = Sample(glass, -in->wi, 0.9f, {});
  ASSERT_TRUE(out.has_value());
}

}  // namespace
}  // namespace strata
