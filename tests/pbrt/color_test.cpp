// Spectra become linear Rec.709 by the CIE functions: against published values.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/pbrt/scene_folder.h"
#include "worker/pbrt/named_spectra.h"
#include "worker/pbrt/spectrum.h"

namespace strata {
namespace {

void ExpectNear(Rgb actual, Rgb expected, float tolerance) {
  EXPECT_NEAR(actual.r, expected.r, tolerance);
  EXPECT_NEAR(actual.g, expected.g, tolerance);
  EXPECT_NEAR(actual.b, expected.b, tolerance);
}

/// x, y of a linear Rec.709 colour (IEC 61966-2-1).
std::array<double, 2> Chromaticity(Rgb c) {
  const double x = 0.4124 * c.r + 0.3576 * c.g + 0.1805 * c.b;
  const double y = 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
  const double z = 0.0193 * c.r + 0.1192 * c.g + 0.9505 * c.b;
  return {x / (x + y + z), y / (x + y + z)};
}

void ExpectChromaticity(const Spectrum& spectrum, double x, double y) {
  const Rgb color = IlluminantColor(spectrum);
  EXPECT_NEAR(Luminance(color), 1, 2e-4);
  const auto xy = Chromaticity(color);
  EXPECT_NEAR(xy[0], x, 4e-4);
  EXPECT_NEAR(xy[1], y, 4e-4);
}

TEST(Illuminants, HaveTheirPublishedChromaticities) {
  // CIE 015:2018, tables of the illuminants; F2, F7 and F11 are the recommended ones.
  ExpectNear(IlluminantColor(*NamedSpectrum("stdillum-D65")), Rgb::Gray(1), 1e-5f);
  ExpectChromaticity(*NamedSpectrum("stdillum-D65"), 0.31272, 0.32903);
  ExpectChromaticity(*NamedSpectrum("stdillum-D50"), 0.34567, 0.35851);
  ExpectChromaticity(*NamedSpectrum("stdillum-A"), 0.44758, 0.40745);
  ExpectChromaticity(*NamedSpectrum("stdillum-F2"), 0.37208, 0.37529);
  ExpectChromaticity(*NamedSpectrum("stdillum-F7"), 0.31292, 0.32933);
  ExpectChromaticity(*NamedSpectrum("stdillum-F11"), 0.38052, 0.37713);
  // Academy TB-2018-001: the white of ACES.
  ExpectChromaticity(*NamedSpectrum("illum-acesD60"), 0.32168, 0.33767);
}

TEST(Illuminants, OfEqualEnergyIsTheReddishWhiteOfPoint33) {
  ExpectChromaticity(*Spectrum::Create({{360, 1}, {830, 1}}), 1.0 / 3, 1.0 / 3);
}

TEST(Blackbodies, LieOnThePlanckianLocus) {
  // Wyszecki and Stiles, Color Science, table 1(3.11): chromaticities of blackbodies.
  ExpectChromaticity(Spectrum::Blackbody(2856), 0.4475, 0.4074);
  ExpectChromaticity(Spectrum::Blackbody(6504), 0.3135, 0.3237);
  ExpectChromaticity(Spectrum::Blackbody(10000), 0.2807, 0.2884);
  // Near D65, which has that temperature, and yet not the same colour.
  const Rgb body = IlluminantColor(Spectrum::Blackbody(6504));
  ExpectNear(body, Rgb::Gray(1), 0.05f);
  EXPECT_GT(std::abs(body.g - 1), 0.005f);
}

TEST(Reflectances, OfAConstantAreThatConstant) {
  for (const double value : {0.0, 0.18, 1.0}) {
    const Spectrum constant = *Spectrum::Create({{360, value}, {830, value}});
    ExpectNear(ReflectanceColor(constant), Rgb::Gray(static_cast<float>(value)), 1e-6f);
  }
}

TEST(Reflectances, AndWhatTheyLeaveAddUpToWhite) {
  const Spectrum warm = *Spectrum::Create({{360, 0.2}, {830, 0.8}});
  const Spectrum rest = *Spectrum::Create({{360, 0.8}, {830, 0.2}});
  const Rgb color = ReflectanceColor(warm);
  ExpectNear(color + ReflectanceColor(rest), Rgb::Gray(1), 1e-5f);
  EXPECT_GT(color.r, color.g + 0.05f);
  EXPECT_GT(color.g, color.b + 0.05f);
}

TEST(Reflectances, OutsideTheGamutAreCutToIt) {
  const Rgb red = ReflectanceColor(*Spectrum::Create({{599, 0}, {600, 1}, {830, 1}}));
  EXPECT_GT(red.r, 0.8f);
  EXPECT_EQ(red.b, 0);
}

/// Reflectance at normal incidence (PBRT 9.3.6).
float NormalReflectance(float eta, float k) {
  return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

Rgb MetalReflectance(const std::string& metal) {
  const Rgb eta = ReflectanceColor(*NamedSpectrum("metal-" + metal + "-eta"));
  const Rgb k = ReflectanceColor(*NamedSpectrum("metal-" + metal + "-k"));
  return {NormalReflectance(eta.r, k.r), NormalReflectance(eta.g, k.g),
          NormalReflectance(eta.b, k.b)};
}

TEST(Metals, HaveTheirPublishedColors) {
  // Akenine-Moeller et al., Real-Time Rendering, 4th edition, table 9.2 (linear sRGB). Averaging
  // the index instead of the reflectance, and other samples of metal, explain the tolerance.
  ExpectNear(MetalReflectance("Au"), {1.000f, 0.782f, 0.344f}, 0.05f);
  ExpectNear(MetalReflectance("Ag"), {0.972f, 0.960f, 0.915f}, 0.05f);
  ExpectNear(MetalReflectance("Cu"), {0.955f, 0.638f, 0.538f}, 0.05f);
  ExpectNear(MetalReflectance("Al"), {0.913f, 0.922f, 0.924f}, 0.02f);
  ExpectNear(MetalReflectance("CuZn"), {0.910f, 0.778f, 0.423f}, 0.08f);
}

TEST(NamedSpectra, HaveTheirPublishedIndices) {
  EXPECT_NEAR(AtSodiumLine(*NamedSpectrum("glass-BK7")), 1.5168, 1e-4);
  EXPECT_NEAR(AtSodiumLine(*NamedSpectrum("metal-MgO-eta")), 1.7374, 1e-4);
  EXPECT_NEAR(AtSodiumLine(*NamedSpectrum("metal-TiO2-eta")), 2.91, 0.01);
  EXPECT_EQ(AtSodiumLine(*NamedSpectrum("metal-MgO-k")), 0);
  for (const char* unknown : {"", "stdillum-", "stdillum-F0", "stdillum-F13", "stdillum-Fx",
                              "metal-", "metal-Ag", "glass-", "glass-Fake"}) {
    EXPECT_FALSE(NamedSpectrum(unknown).has_value()) << unknown;
  }
}

TEST(Spectra, AreLinearInBetweenAndZeroOutside) {
  const Spectrum ramp = *Spectrum::Create({{400, 0}, {500, 1}});
  EXPECT_EQ(ramp(450), 0.5);
  EXPECT_EQ(ramp(500), 1);
  EXPECT_EQ(ramp(399), 0);
  EXPECT_EQ(ramp(501), 0);
  const Spectrum held = *Spectrum::Create({{400, 2}, {500, 1}}, Spectrum::Outside::kHold);
  EXPECT_EQ(held(360), 2);
  EXPECT_EQ(held(830), 1);
}

TEST(ColorSpaces, ShareTheirWhite) {
  for (const char* name : {"srgb", "dci-p3", "rec2020"}) {
    const auto m = *ToRec709(name);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(m[i][0] + m[i][1] + m[i][2], 1, 1e-12) << name;
  }
  // ITU-R BT.2087-0: the red of Rec.2020 in Rec.709 is 1.6605 -0.1246 -0.0182.
  const auto m = *ToRec709("rec2020");
  EXPECT_NEAR(m[0][0], 1.6605, 1e-4);
  EXPECT_NEAR(m[1][0], -0.1246, 1e-4);
  EXPECT_NEAR(m[2][0], -0.0182, 1e-4);
}

Rgb EnvironmentOf(const std::string& parameters) {
  const absl::StatusOr<PbrtScene> scene = ReadWorld("LightSource \"infinite\" " + parameters);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return std::get<ConstantInfiniteLightDescription>(scene->scene.lights.at(0).light).radiance;
}

TEST(Lights, OfWhateverSpectrumHaveTheLuminanceOfTheirScale) {
  ExpectNear(EnvironmentOf("\"rgb L\" [ 1 2 3 ] \"float scale\" 2"), {2, 4, 6}, 0);
  ExpectNear(EnvironmentOf(""), Rgb::Gray(1), 0);
  EXPECT_NEAR(Luminance(EnvironmentOf("\"blackbody L\" 3000 \"float scale\" 5")), 5, 1e-3);
  EXPECT_NEAR(Luminance(EnvironmentOf("\"spectrum L\" [ 200 9 900 9 ]")), 1, 1e-4);
  EXPECT_NEAR(Luminance(EnvironmentOf("\"spectrum L\" \"stdillum-A\"")), 1, 1e-4);
  // The irradiance of a hemisphere of radiance L is pi L.
  EXPECT_NEAR(EnvironmentOf("\"float illuminance\" 6.2831853").g, 2, 1e-5);
}

}  // namespace
}  // namespace strata
