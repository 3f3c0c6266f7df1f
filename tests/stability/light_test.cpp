#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tests/stability/picture.h"

// Lights of extreme size, level and number, against closed forms.

namespace strata {
namespace {

using std::numbers::pi;

/// A white floor (reflectance 0.5) of 2x2 around the origin, turned so that its plane is along no
/// axis where `tilted`, and seen by a camera that looks down on a small part in its middle.
std::string Floor(const std::string& lights, bool tilted = false) {
  const std::string turn = tilted ? "Rotate 33 3 1 2\n" : "";
  return "LookAt 0 -0.5 2  0 0 0  0 0 1\n" + (tilted ? "Rotate -33 3 1 2\n" : std::string()) +
         "Camera \"perspective\" \"float fov\" 1\n"
         "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\nWorldBegin\n" +
         turn + lights + "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n" +
         Triangles({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, 1, 0});
}

/// An image of one radiance for each of size x size pixels, in the layout of PFM.
std::string Pfm(int size, const std::vector<float>& radiances) {
  std::string bytes = absl::StrFormat("PF\n%d %d\n-1.0\n", size, size);
  for (const float radiance : radiances) {
    for (int channel = 0; channel < 3; ++channel)
      bytes.append(reinterpret_cast<const char*>(&radiance), sizeof(radiance));
  }
  return bytes;
}

/// A scene whose sky is the image "sky.pfm".
Picture RenderUnderSky(const std::string& pfm, const std::string& text,
                       const RenderOptions& options) {
  const SceneFolder folder;
  folder.Write("sky.pfm", pfm);
  folder.Write("scene.pbrt", text);
  return Render(LoadFolder(folder), options);
}

const char kSky[] = "LightSource \"infinite\" \"string filename\" \"sky.pfm\"\n";

// A cone here is what a spherical lamp fills as the floor sees it. There are no spot lights yet, so
// that the narrow cone of one is not tested.
TEST(SmallLights, SphericalLampsThatFillNarrowConesGiveTheirIrradiance) {
  // Irradiance of a sphere of radiance L seen under the angle a: pi L sin^2 a.
  for (const double angle : {1e-2, 1e-4, 1e-6}) {
    for (const double distance : {1.0, 1e4}) {
      const double radiance = 1 / (angle * angle);
      const std::string lamp = absl::StrFormat(
          "AttributeBegin Translate 0 0 %.9g AreaLightSource \"diffuse\" \"rgb L\" [ %.9g %.9g "
          "%.9g ] Shape \"sphere\" \"float radius\" %.9g AttributeEnd\n",
          distance, radiance, radiance, radiance, distance * angle);
      // The part of the floor that is seen reaches 0.018 from the middle: the mean of the cosine's
      // fourth power over it is 4e-4 below 1.
      for (const bool tilted : {false, true})
        ExpectMean(
            absl::StrFormat("lamp of %g rad at %g%s", angle, distance, tilted ? ", tilted" : ""),
            Render(Floor(lamp, tilted), {.max_depth = 1}), 0.5, 6e-4, 0.01);
    }
  }
}

TEST(GrazingLight, KeepsItsCosine) {
  for (const double cosine : {1e-2, 1e-3, 1e-4}) {
    const std::string lamp = absl::StrFormat(
        "LightSource \"distant\" \"rgb L\" [ %.9g %.9g %.9g ] \"point3 to\" [ 0 0 0 ] \"point3 "
        "from\" [ %.17g 0 %.9g ]\n",
        1 / cosine, 1 / cosine, 1 / cosine, std::sqrt(1 - cosine * cosine), cosine);
    // Normal and direction round to 2^-24 each, in three products: relative to the cosine.
    for (const bool tilted : {false, true})
      ExpectMean(absl::StrFormat("grazing light of cosine %g%s", cosine, tilted ? ", tilted" : ""),
                 Render(Floor(lamp, tilted), {.max_depth = 1}), 0.5 / pi, 2e-7 / cosine, 0.01);
  }
}

TEST(EnvironmentMaps, HoldASunOfAThousandMillionAmongZeros) {
  constexpr int kSize = 64;
  std::vector<float> radiances(kSize * kSize, 0.0f);
  // Near the middle, which is straight up, but not at it.
  constexpr int kColumn = 38, kRow = 35;
  radiances[kRow * kSize + kColumn] = 1e9f;
  // pbrt-v4's octahedral layout has equal areas (Clarberg 2008): z is 1 - r^2, with r the distance
  // |u| + |v| from the middle in the upper half. The pixel's mean cosine, by quadrature.
  double cosine = 0;
  constexpr int kGrid = 64;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const double u = 2 * (kColumn + (i % kGrid + 0.5) / kGrid) / kSize - 1;
    const double v = 2 * (kRow + (i / kGrid + 0.5) / kGrid) / kSize - 1;
    const double r = std::abs(u) + std::abs(v);
    cosine += (1 - r * r) / (kGrid * kGrid);
  }
  const double irradiance = 1e9 * cosine * 4 * pi / (kSize * kSize);
  const Picture picture =
      RenderUnderSky(Pfm(kSize, radiances), Floor(kSky), {.size = 16, .spp = 256, .max_depth = 1});
  ExpectMean("sun of 1e9 in one pixel of 4096", picture, 0.5 / pi * irradiance, 1e-5, 0.01);
}

TEST(EnvironmentMaps, OfOnePixelAreConstantSkies) {
  // A convex body under a constant sky shows its reflectance: no noise but that of the direction.
  const Picture image = RenderUnderSky(Pfm(1, {1}), Floor(kSky), {.spp = 256, .max_depth = 1});
  const Picture constant =
      Render(Floor("LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n"), {.spp = 256, .max_depth = 1});
  ExpectMean("sky of one pixel", image, 0.5, 1e-5, 0.01);
  ExpectMean("constant sky", constant, 0.5, 1e-5, 0.01);
  // Black skies light nothing.
  const Picture black = RenderUnderSky(Pfm(1, {0}), Floor(kSky), {});
  EXPECT_EQ(MeanOf(black).mean, 0);
  EXPECT_EQ(black.nonfinite, 0u);
}

TEST(UselessLights, ChangeNothing) {
  const std::string lamp = "LightSource \"point\" \"rgb I\" [ 2 2 2 ] \"point3 from\" [ 0 0 2 ]\n";
  const std::string useless =
      "LightSource \"point\" \"rgb I\" [ 0 0 0 ] \"point3 from\" [ 0 0 1 ]\n"
      "LightSource \"distant\" \"rgb L\" [ 0 0 0 ]\n"
      "LightSource \"infinite\" \"rgb L\" [ 0 0 0 ]\n"
      "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 0 0 0 ]\n"
      "Translate 5 0 1 Shape \"sphere\" AttributeEnd\n"
      // No area: a point, a line, and a triangle so small that its area underflows.
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 9 9 9 ]\n" +
      Triangles({5, 0, 1, 5, 0, 1, 5, 0, 1}) + Triangles({5, 0, 1, 6, 0, 1, 7, 0, 1}) +
      Triangles({0, 0, 1, 1e-30, 0, 1, 0, 1e-30, 1}) +
      "AttributeEnd\n"
      // Embedded in the floor's plane, edge-on to all of it.
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 9 9 9 ]\n" +
      Triangles({2, 0, 0, 3, 0, 0, 3, 1, 0}) + "AttributeEnd\n";
  const RenderOptions options = {.size = 8, .spp = 1024, .max_depth = 2};
  const Picture with = Render(Floor(lamp + useless), options);
  const Picture without = Render(Floor(lamp), options);
  ExpectSameMean("zero-area, black and edge-on lights", with, without, 1e-5, 0.02);
}

TEST(UselessLights, AloneMakeAPictureOfZeros) {
  const std::string black_lights[] = {
      "",
      "LightSource \"point\" \"rgb I\" [ 0 0 0 ]\n",
      "LightSource \"infinite\" \"rgb L\" [ 0 0 0 ]\n",
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 0 0 0 ] Translate 0 0 3 "
      "Shape \"sphere\" AttributeEnd\n",
  };
  for (const std::string& lights : black_lights) {
    const Picture picture = Render(Floor(lights), {});
    EXPECT_EQ(picture.nonfinite, 0u);
    for (const PixelEstimate& pixel : picture.pixels) {
      for (int c = 0; c < kColours; ++c) {
        EXPECT_EQ(pixel.mean[c], 0);
        EXPECT_EQ(pixel.standard_error[c], 0);
        EXPECT_EQ(pixel.ci95[c], 0);
        EXPECT_EQ(pixel.variance[c], 0);
      }
      EXPECT_EQ(pixel.flags, 0u);
    }
  }
}

}  // namespace
}  // namespace strata
