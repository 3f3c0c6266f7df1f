#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tests/stability/picture.h"

// Surfaces at the limits of their parameters.

namespace strata {
namespace {

const char kSky[] = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";

/// A ball of this material on a floor under a small lamp and a dim sky.
std::string BallUnderLamp(const std::string& material) {
  return SceneText(
      "0 -4 1.5", "0 0 0.5", 40,
      "LightSource \"infinite\" \"rgb L\" [ 0.3 0.3 0.3 ]\n"
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 20 20 20 ]\n"
      "Translate 1 -1 3 Shape \"sphere\" \"float radius\" 0.4 AttributeEnd\n"
      "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.4 0.3 ]\n" +
          Triangles({-4, -4, 0, 4, -4, 0, 4, 4, 0, -4, -4, 0, 4, 4, 0, -4, 4, 0}) +
          (material.empty()
               ? ""
               : material + " Translate 0 0 1 Shape \"sphere\" \"float radius\" 0.8\n"));
}

constexpr RenderOptions kOptions = {.size = 16, .spp = 512, .max_depth = 8};

std::string Metal(double roughness, bool remap) {
  return absl::StrFormat(
      "Material \"conductor\" \"rgb reflectance\" [ 0.9 0.8 0.7 ] \"float roughness\" %g \"bool "
      "remaproughness\" %s",
      roughness, remap ? "true" : "false");
}

TEST(Roughness, OfATenThousandthIsAMirror) {
  const Picture mirror = Render(BallUnderLamp(Metal(0, false)), kOptions);
  // The last is just not smooth enough to be taken for a mirror; its reflections blur by 1e-3.
  for (const double roughness : {1e-6, 1e-4, 1.001e-3})
    ExpectSameMean(absl::StrFormat("metal of alpha %g and a mirror", roughness),
                   Render(BallUnderLamp(Metal(roughness, false)), kOptions), mirror, 2e-3, 0.05);
}

TEST(Roughness, OfATenThousandthBeforeItsRootIsTakenLosesNoEnergy) {
  // alpha = 0.01. Every material under a constant sky; the metals reflect 1, up to what single
  // scattering loses at alpha 0.01 (about alpha^2, and grazing rays).
  const std::string materials[] = {
      "Material \"conductor\" \"rgb reflectance\" [ 0.999 0.999 0.999 ] \"float roughness\" 1e-4",
      "Material \"dielectric\" \"float roughness\" 1e-4",
      "Material \"dielectric\" \"float uroughness\" 1e-4 \"float vroughness\" 0.5",
      "Material \"coatedconductor\" \"float interface.roughness\" 1e-4 \"float "
      "conductor.roughness\" 1e-4",
      "Material \"coateddiffuse\" \"float roughness\" 1e-4",
  };
  for (const std::string& material : materials) {
    const Picture picture =
        Render(SceneText("0 -4 0", "0 0 0", 40, kSky + material + " Shape \"sphere\"\n"), kOptions);
    EXPECT_EQ(picture.nonfinite, 0u) << material;
    const FrameMean frame = MeanOf(picture);
    Report(material + ", mean under a sky of 1", frame.mean);
    EXPECT_LT(frame.mean, 1 + 4.4 * frame.standard_error) << material;
    EXPECT_GT(frame.mean, 0.3) << material;
  }
  const Picture dielectric =
      Render(SceneText("0 -4 0", "0 0 0", 40,
                       std::string(kSky) +
                           "Material \"dielectric\" \"float roughness\" 1e-4 Shape \"sphere\"\n"),
             kOptions);
  ExpectMean("rough glass of alpha 0.01", dielectric, 1, 5e-3, 0.02);
}

TEST(IndexOne, IsNotThere) {
  const Picture empty = Render(BallUnderLamp(""), kOptions);
  for (const double roughness : {0.0, 0.3}) {
    // Light that passes the ball is found by chance alone, not by aiming at the lamp, so the
    // shadowed floor is noisy.
    ExpectSameMean(
        absl::StrFormat("ball of index 1, roughness %g", roughness),
        Render(BallUnderLamp(absl::StrFormat(
                   "Material \"dielectric\" \"float eta\" 1 \"float roughness\" %g", roughness)),
               kOptions),
        empty, 1e-5, 0.1);
  }
  ExpectSameMean("thin sheet of index 1",
                 Render(BallUnderLamp("Material \"thindielectric\" \"float eta\" 1"), kOptions),
                 empty, 1e-5, 0.1);
}

TEST(IndexOne, NearlyLeavesNothingToNumbers) {
  // 1 - 1e-7 is the float below 1; halves and bends vanish with it.
  for (const double index : {0.9999999, 1.0000001, 1.00001, 1.001}) {
    for (const double roughness : {0.0, 0.3}) {
      const Picture picture = Render(
          SceneText("0 -4 0", "0 0 0", 40,
                    kSky + absl::StrFormat("Material \"dielectric\" \"float eta\" %.9g \"float "
                                           "roughness\" %g Shape \"sphere\"\n",
                                           index, roughness)),
          {.size = 16, .spp = 256, .max_depth = 8});
      EXPECT_EQ(picture.nonfinite, 0u) << index;
      const FrameMean frame = MeanOf(picture);
      Report(
          absl::StrFormat("glass of index %.9g, roughness %g under a sky of 1", index, roughness),
          frame.mean);
      // Smooth glass loses nothing. Rough glass loses what its facets mask, however little they
      // bend: 7 % at alpha 0.55, where an index of exactly 1 is taken as nothing at all.
      EXPECT_GT(frame.mean, roughness > 0 ? 0.9 : 1 - 1e-5) << index << " " << roughness;
      EXPECT_LT(frame.mean, 1 + 1e-5 + 4.4 * frame.standard_error) << index << " " << roughness;
    }
  }
}

}  // namespace
}  // namespace strata
