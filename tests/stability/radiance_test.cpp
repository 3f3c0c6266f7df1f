#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_format.h"
#include "tests/stability/picture.h"

// Radiance of any level, and of two levels at once.

namespace strata {
namespace {

constexpr double kLevels[] = {1e-30, 1e-10, 1e10, 1e30};

/// A floor under a lamp, a ball and a sky of radiances in proportion to `level`.
std::string LitRoom(double level) {
  return SceneText(
      "0 -4 2", "0 0 0.3", 40,
      absl::StrFormat(
          "LightSource \"infinite\" \"rgb L\" [ %.9g %.9g %.9g ]\n"
          "LightSource \"point\" \"rgb I\" [ %.9g %.9g %.9g ] \"point3 from\" [ 1 -1 2 ]\n"
          "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n",
          0.1 * level, 0.1 * level, 0.1 * level, level, level, level) +
          Triangles({-3, -3, 0, 3, -3, 0, 3, 3, 0, -3, -3, 0, 3, 3, 0, -3, 3, 0}) +
          "Material \"coateddiffuse\" Shape \"sphere\" \"float radius\" 0.7\n" +
          absl::StrFormat("AreaLightSource \"diffuse\" \"rgb L\" [ %.9g %.9g %.9g ]\n", 5 * level,
                          5 * level, 5 * level) +
          Triangles({-0.5, -0.5, 3, 0.5, 0.5, 3, 0.5, -0.5, 3}));
}

TEST(Radiance, OfAnyLevelMakesTheSamePicture) {
  const RenderOptions options = {.size = 16, .spp = 64};
  const Picture one = Render(LitRoom(1), options);
  for (const double level : kLevels) {
    const Picture picture = Render(LitRoom(level), options);
    EXPECT_EQ(picture.nonfinite, 0u);
    double mean = 0, error = 0, interval = 0;
    int flags = 0;
    for (size_t i = 0; i < one.pixels.size(); ++i) {
      const PixelEstimate &a = picture.pixels[i], &b = one.pixels[i];
      mean = std::max(mean, std::abs(a.mean[1] / level / b.mean[1] - 1));
      if (b.standard_error[1] > 0)
        error = std::max(error, std::abs(a.standard_error[1] / level / b.standard_error[1] - 1));
      interval = std::max(interval, std::abs(a.ci95[1] / level / b.ci95[1] - 1));
      flags += a.flags != b.flags;
    }
    const std::string name = absl::StrFormat("level %g, relative difference of ", level);
    Report(name + "means", mean);
    Report(name + "standard errors", error);
    Report(name + "intervals", interval);
    // The same paths, each product rounded in float: some 1e-6. A standard error is a difference of
    // means, so that it has the roundings of means of many times its size.
    EXPECT_LT(mean, 1e-5) << level;
    EXPECT_LT(error, 1e-3) << level;
    EXPECT_LT(interval, 1e-4) << level;
    EXPECT_EQ(flags, 0) << level;
  }
}

/// Two squares fill the frame, the left one of radiance 1e-30, the right one of 1e30; or each
/// alone.
std::string TwoLevels(double left, double right) {
  const auto square = [](double x0, double x1, double radiance) {
    return absl::StrFormat("AreaLightSource \"diffuse\" \"rgb L\" [ %g %g %g ]\n", radiance,
                           radiance, radiance) +
           Triangles({x0, 0, -9, x1, 0, 9, x0, 0, 9, x0, 0, -9, x1, 0, -9, x1, 0, 9});
  };
  // The border passes through the pixels of the middle column; fifteen columns have one.
  return SceneText("0 -1 0", "0 0 0", 90, square(-9, 0, left) + square(0, 9, right));
}

TEST(Radiance, OfTwoLevelsInOnePixelIsTheirMean) {
  const Picture picture = Render(TwoLevels(1e-30, 1e30), {.size = 15, .spp = 1024, .max_depth = 0});
  EXPECT_EQ(picture.nonfinite, 0u);
  for (int y = 0; y < 15; ++y) {
    // The camera's x runs to the left of the file's: right is dark or bright as a whole.
    const double ends[] = {picture.pixels[15 * y].mean[1], picture.pixels[15 * y + 14].mean[1]};
    EXPECT_NEAR(std::min(ends[0], ends[1]), 1e-30, 1e-36);
    EXPECT_NEAR(std::max(ends[0], ends[1]), 1e30, 1e24);
    const PixelEstimate& mixed = picture.pixels[15 * y + 7];
    // Stratified samples on both sides of a straight border through the middle: half of them, up to
    // one of the 128 of each replicate.
    EXPECT_NEAR(mixed.mean[1], 0.5e30, 0.5e30 / 64);
    EXPECT_NEAR(mixed.variance[1], 0.25e60, 0.01e60);
    EXPECT_TRUE(std::isfinite(mixed.ci95[1]));
  }
}

/// A floor seen from above, in two rooms with a wall between: what lights one does not reach the
/// other. The first is lit by a point light of intensity `bright`, the second by one of 1.
std::string TwoRooms(double bright) {
  const auto lamp = [](double x, double intensity) {
    return absl::StrFormat(
        "LightSource \"point\" \"rgb I\" [ %g %g %g ] \"point3 from\" [ %g 0 2 ]\n", intensity,
        intensity, intensity, x);
  };
  return SceneText("4 -3 1.8", "4 0 0", 20,
                   Triangles({-2, -2, 0, 6, -2, 0, 6, 2, 0, -2, -2, 0, 6, 2, 0, -2, 2, 0}) +
                       "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n" +
                       Triangles({2, -9, -9, 2, 9, -9, 2, 0, 30}) + lamp(0, bright) + lamp(4, 1));
}

TEST(Radiance, OfALampBehindAWallDoesNotDrownWhatIsSeen) {
  const RenderOptions options = {.size = 12, .spp = 1024, .max_depth = 1};
  const Picture equal = Render(TwoRooms(1), options);
  for (const double bright : {1e6, 1e30})
    ExpectSameMean(absl::StrFormat("lamp of %g behind a wall", bright),
                   Render(TwoRooms(bright), options), equal, 1e-5, 0.2);
}

}  // namespace
}  // namespace strata
