#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_format.h"
#include "tests/stability/picture.h"
#include "worker/scene/scene.h"

// A picture does not depend on the unit of length nor on where the scene lies. The same random
// numbers make the same paths but for rounding, so pictures are compared pixel by pixel: their
// difference is measured in standard errors of the pixels.

namespace strata {
namespace {

/// Where and how large a scene is in the file's world.
struct Place {
  double scale = 1;
  double x = 0, y = 0, z = 0;
};

/// A room of a few units with a shape of each kind, instances, textures in space and a lens, as if
/// it had been built at `place`. Transforms alone say where, so nothing is rounded to float on the
/// way. `baked` puts the floor's place into its vertices instead, which are floats.
std::string Room(const Place& place, bool baked = false) {
  const double s = place.scale;
  const std::string camera = absl::StrFormat(
      "LookAt 0.3 -5 1.7  0 0 1  0 0 1\n"
      "Scale %.17g %.17g %.17g Translate %.17g %.17g %.17g\n"
      "Camera \"perspective\" \"float fov\" 40 \"float lensradius\" 0.02 \"float focaldistance\" "
      "5\n"
      "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\nWorldBegin\n",
      1 / s, 1 / s, 1 / s, -place.x, -place.y, -place.z);
  const std::string floor_points = absl::StrFormat(
      "\"point3 P\" [ %.9g %.9g %.9g  %.9g %.9g %.9g  %.9g %.9g %.9g  %.9g %.9g %.9g ]",
      -2 * s + baked * place.x, -2 * s + baked * place.y, baked * place.z,  //
      2 * s + baked * place.x, -2 * s + baked * place.y, baked * place.z,   //
      2 * s + baked * place.x, 2 * s + baked * place.y, baked * place.z,    //
      -2 * s + baked * place.x, 2 * s + baked * place.y, baked * place.z);
  const std::string moved =
      absl::StrFormat("Translate %.17g %.17g %.17g\n", place.x, place.y, place.z);
  return camera + "AttributeBegin\n" + (baked ? "" : moved) +
         "Material \"diffuse\" \"rgb reflectance\" [ 0.6 0.5 0.4 ]\n"
         "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] " +
         floor_points + "\nAttributeEnd\n" + moved +
         absl::StrFormat("Scale %.17g %.17g %.17g\n", s, s, s) +
         R"(
Texture "cubes" "spectrum" "checkerboard" "integer dimension" 3
  "rgb tex1" [ 0.7 0.7 0.7 ] "rgb tex2" [ 0.2 0.3 0.4 ]
Material "diffuse" "texture reflectance" "cubes"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
  "point3 P" [ -2 1.9 0  2 1.9 0  2 1.9 3  -2 1.9 3 ]
Material "diffuse" "rgb reflectance" [ 0.7 0.2 0.2 ]
Shape "bilinearmesh" "integer indices" [ 0 1 2 3 ]
  "point3 P" [ -1.9 -2 0  -1.9 2 0.1  -1.9 -2 3  -1.8 2 3 ]
AttributeBegin
Translate 0.9 0.2 0.6
Material "dielectric"
Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
Translate -0.8 0.4 0
Material "conductor" "rgb reflectance" [ 0.9 0.8 0.6 ] "float roughness" 0.2
Shape "cylinder" "float radius" 0.4 "float zmin" 0 "float zmax" 0.9
Translate 0 0 0.9
Shape "disk" "float radius" 0.4
AttributeEnd
ObjectBegin "pyramid"
Identity
Material "coateddiffuse" "rgb reflectance" [ 0.2 0.5 0.2 ]
Shape "trianglemesh" "integer indices" [ 0 1 3 1 2 3 2 0 3 ]
  "point3 P" [ -0.3 -0.3 0  0.3 -0.3 0  0 0.3 0  0 0 0.7 ]
ObjectEnd
AttributeBegin Translate 0.1 -0.9 0.01 ObjectInstance "pyramid" AttributeEnd
AttributeBegin Translate 0.2 1.1 0.01 Rotate 30 0 0 1 ObjectInstance "pyramid" AttributeEnd
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 9 8 ]
Translate 0 0 2.9 Rotate 180 1 0 0
Shape "disk" "float radius" 0.6
AttributeEnd
)" +
         absl::StrFormat(
             "LightSource \"point\" \"rgb I\" [ %.9g %.9g %.9g ] \"point3 from\" [ -1 -1.5 "
             "2.5 ]\n",
             s * s, s * s, s * s);
}

constexpr RenderOptions kOptions = {.size = 24, .spp = 64, .max_depth = 6, .seed = 3};

/// The root mean square over the pixels of (a - b) / standard error of the difference of two
/// independent renders, and the share of pixels that differ by more than one part in 1e4.
struct Difference {
  double in_errors = 0, share = 0, depth = 0;
};

Difference Compare(const Picture& a, const Picture& b, double scale) {
  double difference2 = 0, variance = 0;
  Difference result;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const PixelEstimate &p = a.pixels[i], &q = b.pixels[i];
    difference2 += std::pow(p.mean[1] - q.mean[1], 2);
    variance += std::pow(p.standard_error[1], 2) + std::pow(q.standard_error[1], 2);
    result.share += std::abs(p.mean[1] - q.mean[1]) > 1e-4 * q.mean[1];
    result.depth = std::max(result.depth, std::abs(a.depth[i] / (scale * b.depth[i]) - 1));
  }
  result.in_errors = std::sqrt(difference2 / variance);
  result.share /= static_cast<double>(a.pixels.size());
  return result;
}

/// Two independent renders differ by 1. Equal paths differ by the rounding of floats alone, about
/// 1e-6; a few paths may be sent another way by rounding, at edges and through the glass.
constexpr double kMostErrors = 1e-3;
/// A few roundings.
constexpr double kDepthRounding = 1e-6;

class PlaceTest : public testing::Test {
 protected:
  static const Picture& Reference() {
    static const Picture* const picture = new Picture(Render(Room({}), kOptions));
    return *picture;
  }
  static Difference DifferenceAt(const std::string& name, const Place& place, bool baked = false) {
    const Picture picture = Render(Room(place, baked), kOptions);
    EXPECT_EQ(picture.nonfinite, 0u) << name;
    const Difference difference = Compare(picture, Reference(), place.scale);
    Report(name + ", difference in standard errors", difference.in_errors);
    Report(name + ", share of pixels that differ by 1e-4", difference.share);
    Report(name + ", largest relative difference of depth", difference.depth);
    return difference;
  }
};

TEST_F(PlaceTest, TheUnitOfLengthChangesNothing) {
  for (const double scale : {1e-4, 1e-3, 0.01, 0.1, 10.0, 1e3, 1e6}) {
    const Difference difference =
        DifferenceAt(absl::StrFormat("scale %g", scale), {.scale = scale});
    EXPECT_LT(difference.in_errors, kMostErrors) << scale;
    EXPECT_LT(difference.depth, kDepthRounding) << scale;
  }
}

TEST_F(PlaceTest, MovingByAMillionSizesChangesNothing) {
  for (const double distance : {4e3, 4e6}) {
    for (const double scale : {1e-4, 1.0, 1e6}) {
      const Place place = {scale, distance * scale * 0.7, -distance * scale,
                           distance * scale * 0.3};
      const Difference difference = DifferenceAt(
          absl::StrFormat("moved by %g of its size, scale %g", distance / 4, scale), place);
      EXPECT_LT(difference.in_errors, kMostErrors) << scale;
      EXPECT_LT(difference.depth, kDepthRounding) << scale;
    }
  }
}

TEST_F(PlaceTest, APlaceInFloatIsTheControlThatFails) {
  const Difference difference =
      DifferenceAt("moved by 1e6 of its size in float", {1, 2.8e6, -4e6, 1.2e6 + 0.1}, true);
  EXPECT_GT(difference.in_errors, kMostErrors);
}

TEST_F(PlaceTest, AnotherSeedIsTheControlThatDiffersByOne) {
  RenderOptions other = kOptions;
  other.seed = 4;
  const Difference difference = Compare(Render(Room({}), other), Reference(), 1);
  Report("another seed, difference in standard errors", difference.in_errors);
  // Over 576 pixels the root mean square of unit deviations lies in this interval, heavy tails of
  // some pixels allowed for.
  EXPECT_GT(difference.in_errors, 0.7);
  EXPECT_LT(difference.in_errors, 1.4);
}

TEST_F(PlaceTest, TheOriginIsTheNearestPlaceToTheCamera) {
  const SceneFolder folder;
  folder.Write("scene.pbrt", Room({1, 3e6, -4e6, 1e6}));
  const auto scene = LoadFolder(folder);
  ASSERT_NE(scene, nullptr);
  // The camera stands outside of the room, at y = -5 where that begins at -2.
  EXPECT_NEAR(scene->origin().x, 3e6 + 0.3, 1e-3);
  EXPECT_NEAR(scene->origin().y, -4e6 - 2, 1e-3);
  EXPECT_NEAR(scene->origin().z, 1e6 + 1.7, 1e-3);
}

}  // namespace
}  // namespace strata
