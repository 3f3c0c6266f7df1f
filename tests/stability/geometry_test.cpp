#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tests/stability/picture.h"

// Triangles that are hardly there, layers that lie on each other, cameras inside of things. Under a
// sky of radiance 1 a plane shows its reflectance, so any ray that meets the plane it leaves makes
// a pixel darker, and any that slips through it makes one brighter or darker.

namespace strata {
namespace {

constexpr double kReflectance = 0.5;
const char kSky[] = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
const char kGray[] = "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n";

/// The world seen from above its plane z = 0, of which [-1, 1]^2 fills the frame. `tilted` turns
/// all so that no plane is along the axes.
std::string FromAbove(const std::string& world, bool tilted) {
  return "LookAt 0.1 -0.4 2  0.1 0 0  0 0 1\n" + std::string(tilted ? "Rotate -33 3 1 2\n" : "") +
         "Camera \"perspective\" \"float fov\" 35\n"
         "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\nWorldBegin\n" +
         kSky + (tilted ? "Rotate 33 3 1 2\n" : "") + kGray + world;
}

/// The sky is met by directions of the BSDF alone, which are distributed as what the plane
/// reflects: each sample of an unshadowed plane then is its reflectance, without noise.
RenderOptions Exact(RenderOptions options) {
  options.direct = DirectStrategy::kBsdfOnly;
  return options;
}

/// The rectangle [x0, x1] x [-1, 1] at height z as two triangles.
std::vector<double> Strip(double x0, double x1, double z) {
  return {x0, -1, z, x1, -1, z, x1, 1, z, x0, -1, z, x1, 1, z, x0, 1, z};
}

void Append(std::vector<double>& to, const std::vector<double>& corners) {
  to.insert(to.end(), corners.begin(), corners.end());
}

TEST(Needles, OfAnyWidthMakeAWholePlane) {
  // Strips whose widths fall from 1 to 1e-6 by tenths of a tenth, and grow again: triangles up to
  // two million times longer than wide, beside wide ones. Between them, triangles without area.
  std::vector<double> corners;
  double x = -1;
  int strips = 0;
  const auto add = [&](double width) {
    const double end = std::min(x + width, 1.0);
    Append(corners, Strip(x, end, 0));
    Append(corners, {x, -1, 0, x, -1, 0, x, 1, 0});   // Two corners are one.
    Append(corners, {x, -1, 0, x, 0.3, 0, x, 1, 0});  // All on a line.
    Append(corners, {x, -1, 0, x, -1, 0, x, -1, 0});  // A point.
    x = end;
    ++strips;
  };
  while (x < 1) {
    const int k = strips % 120;
    add(0.2 * std::pow(10.0, -0.1 * std::min(k, 120 - k)));
  }
  Report("strips", strips);
  for (const bool tilted : {false, true}) {
    const std::string name = tilted ? "needles, tilted" : "needles";
    const auto scene = FromAbove(Triangles(corners), tilted);
    ExpectMean(name, Render(scene, {.size = 32, .spp = 256, .max_depth = 2}), kReflectance, 1e-5,
               0.01);
    // A ray in a million may slip through a border or meet the neighbour: one of these 262144,
    // which changes its pixel by 1/256 at most.
    ExpectEveryPixel(name, Render(scene, Exact({.size = 32, .spp = 256, .max_depth = 2})),
                     kReflectance, 4e-3);
  }
}

TEST(CoplanarLayers, OfThousandsAreOne) {
  // Rectangles of different extent in one plane: for rays that leave one all others lie there, too.
  std::vector<double> corners;
  for (int i = 0; i < 4096; ++i) {
    const double cut = 1 - 0.5 * i / 4096;
    Append(corners, Strip(-cut, cut, 0));
  }
  // What lies beyond the smallest is hit by no ray, but all layers hold the middle of the frame.
  for (const bool tilted : {false, true}) {
    const std::string world = Triangles(corners) + Triangles(Strip(-1.5, 1.5, 0));
    const Picture picture =
        Render(FromAbove(world, tilted), Exact({.size = 16, .spp = 64, .max_depth = 2}));
    ExpectEveryPixel(tilted ? "4097 layers in one plane, tilted" : "4097 layers in one plane",
                     picture, kReflectance, 1e-5);
  }
}

TEST(CoplanarLayers, OnAQuadricAreOne) {
  std::string world = Triangles(Strip(-1.5, 1.5, 0));
  for (int i = 0; i < 1000; ++i)
    absl::StrAppendFormat(&world, "Shape \"disk\" \"float radius\" %.9g\n", 1 + 1e-3 * i);
  for (const bool tilted : {false, true}) {
    const Picture picture =
        Render(FromAbove(world, tilted), Exact({.size = 8, .spp = 64, .max_depth = 2}));
    ExpectEveryPixel(tilted ? "1000 disks on a plane, tilted" : "1000 disks on a plane", picture,
                     kReflectance, 1e-5);
  }
}

TEST(Patches, ThatAreFlatDoNotShadowThemselves) {
  // Where a coordinate is 0 all over the patch, rays that leave it begin exactly on it.
  for (const double edge : {1.7, 1.3, 1.123}) {
    for (const bool tilted : {false, true}) {
      const std::string world = absl::StrFormat(
          "Shape \"bilinearmesh\" \"point3 P\" [ -%1$g -%1$g 0 %1$g -%1$g 0 -%1$g %1$g 0 %1$g %1$g "
          "0 ]\n",
          edge);
      ExpectEveryPixel(
          absl::StrFormat("patch of %g%s", edge, tilted ? ", tilted" : ""),
          Render(FromAbove(world, tilted), Exact({.size = 16, .spp = 256, .max_depth = 2})),
          kReflectance, 1e-5);
    }
  }
}

TEST(CoplanarLayers, ALayerAboveIsTheControlThatIsSeen) {
  // A black roof a thousandth above a half of the plane.
  const std::string world = Triangles(Strip(-1.5, 1.5, 0)) +
                            "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n" +
                            Triangles(Strip(0, 1.5, 1e-3));
  const Picture picture = Render(FromAbove(world, false), {.size = 16, .spp = 64, .max_depth = 2});
  EXPECT_LT(MeanOf(picture).mean, 0.6 * kReflectance);
}

TEST(ThinGaps, OfAMillionthOfTheSizeStayOpen) {
  // A black plate hovers above one half: the floor beside it is lit to its edge, and where both are
  // seen edge-on nothing leaks under it.
  for (const double gap : {1e-3, 1e-5, 1e-6}) {
    const std::string world = Triangles(Strip(-1.5, 1.5, 0)) +
                              "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n" +
                              Triangles(Strip(-1.5, 1.5, gap));
    const Picture picture =
        Render(FromAbove(world, false), Exact({.size = 16, .spp = 64, .max_depth = 1}));
    ExpectEveryPixel(absl::StrFormat("plate %g above a plane", gap), picture, 1, 1e-5);
  }
}

// ---- the camera inside of something ----

std::string Inside(const std::string& world) {
  return SceneText("0.01 0.02 0.03", "1 2 0.5", 60, world);
}

TEST(CameraInside, AGlassBallSeesTheSkyTimesItsIndexSquared) {
  // Radiance over the index squared is kept along a ray; near the middle no ray is reflected
  // totally, and what is reflected in part comes out later.
  const double index = 1.5;
  const std::string ball = absl::StrFormat(
      "Material \"dielectric\" \"float eta\" %g Shape \"sphere\" \"float radius\" 2\n", index);
  ExpectMean("inside a glass ball", Render(Inside(kSky + ball), {.spp = 256, .max_depth = 60}),
             index * index, 1e-5, 0.02);
}

TEST(CameraInside, ALampSeesItsRadianceAndABodySeesNothing) {
  const std::string lamp =
      "AreaLightSource \"diffuse\" \"rgb L\" [ 3 3 3 ] \"bool twosided\" true "
      "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ] Shape \"sphere\" \"float radius\" 2\n";
  ExpectEveryPixel("inside a lamp", Render(Inside(lamp), {}), 3, 1e-6);
  const Picture dark =
      Render(Inside(std::string(kSky) + kGray + "Shape \"sphere\" \"float radius\" 2\n"), {});
  EXPECT_EQ(MeanOf(dark).mean, 0) << "light leaks into a closed ball";
  EXPECT_EQ(dark.nonfinite, 0u);
}

TEST(CameraInside, ASurfaceItself) {
  // The camera lies in the floor's plane, and in the corner of a box.
  const std::string world = std::string(kSky) + kGray + Triangles(Strip(-1, 1, 0));
  const Picture picture = Render(SceneText("0 0 0", "1 1 -0.2", 60, world), {});
  EXPECT_EQ(picture.nonfinite, 0u);
  EXPECT_GT(MeanOf(picture).mean, kReflectance * 0.99);
  EXPECT_LT(MeanOf(picture).mean, 1.01);
}

}  // namespace
}  // namespace strata
