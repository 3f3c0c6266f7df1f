#include <array>
#include <string>
#include <vector>

#include "cli/lab/measure.h"
#include "worker/math/vec.h"
#include "worker/sampling/warp.h"

// A floor seen from above, at height 0, under a square lamp of radiance 1 at height 2 that shines
// down, with a disk at height 1 that casts a soft shadow. Each pixel is one point of the floor.

namespace strata::lab {
namespace {

constexpr int kSide = 96;        ///< Pixels.
constexpr float kHalfFloor = 2;  ///< The floor reaches so far from the middle.
constexpr float kLampHeight = 2, kLampEdge = 1.2f;
constexpr float kDiskHeight = 1, kDiskRadius = 0.45f;

/// The irradiance at `point` that the lamp's point at u stands for: 0 in the shadow of the disk.
double Contribution(Vec2f point, Vec2f u) {
  const Vec2f lamp = {(u.x - 0.5f) * kLampEdge, (u.y - 0.5f) * kLampEdge};
  const Vec3f to_lamp = {lamp.x - point.x, lamp.y - point.y, kLampHeight};
  const float t = kDiskHeight / kLampHeight;
  const float x = point.x + t * to_lamp.x, y = point.y + t * to_lamp.y;
  if (x * x + y * y < kDiskRadius * kDiskRadius) return 0;
  // Both cosines are height over distance.
  const double distance2 = LengthSquared(to_lamp);
  const double cosines = kLampHeight * kLampHeight / distance2;
  return kLampEdge * kLampEdge * cosines / distance2;
}

/// The mean over grid x grid points of the lamp; one in each cell of a grid if stratified.
double Estimate(Vec2f point, int grid, bool stratified, RandomStream& random) {
  double sum = 0;
  for (int i = 0; i < grid * grid; ++i) {
    Vec2f u = random.Next2D();
    if (stratified) {
      u = {(static_cast<float>(i % grid) + u.x) / static_cast<float>(grid),
           (static_cast<float>(i / grid) + u.y) / static_cast<float>(grid)};
    }
    sum += Contribution(point, u);
  }
  return sum / (grid * grid);
}

Vec2f PixelCentre(int x, int y) {
  const auto place = [](int i) {
    return kHalfFloor * (2 * (static_cast<float>(i) + 0.5f) / kSide - 1);
  };
  return {place(x), -place(y)};
}

/// Estimates of all pixels: the first of each is its picture.
struct Floor {
  double mean = 0, variance = 0;  ///< The latter of one estimate, averaged over pixels.
  double seconds = 0;             ///< Of one estimate.
  std::vector<double> picture;
};

Floor Shade(int grid, bool stratified, const Settings& settings, uint32_t stream) {
  RandomStream random(settings.seed, stream);
  Floor floor;
  constexpr int kPixels = kSide * kSide;
  for (int pixel = 0; pixel < kPixels; ++pixel) {
    const Vec2f point = PixelCentre(pixel % kSide, pixel / kSide);
    floor.picture.push_back(Estimate(point, grid, stratified, random));
    const Measured measured =
        Measure(settings.samples, [&] { return Estimate(point, grid, stratified, random); });
    floor.mean += measured.Mean() / kPixels;
    floor.variance += measured.Variance() / kPixels;
    floor.seconds += measured.seconds / kPixels;
  }
  return floor;
}

}  // namespace

absl::StatusOr<Outcome> RunAreaLight(const Settings& settings) {
  constexpr int kGap = 4;
  constexpr std::array kGrids = {1, 3, 6};
  Outcome outcome;
  outcome.records.columns = {"samples", "n", "mean", kVariance, "V of one / V", kTime, kEfficiency};
  Picture picture = Picture::White(3 * kSide + 2 * kGap, 2 * kSide + kGap);
  // The middle of the lit floor is near white.
  const double scale = 0.45 / Contribution({kHalfFloor / 2, 0}, {0.5f, 0.5f});
  uint32_t stream = 0;
  double of_one = 0;
  for (const bool stratified : {false, true}) {
    for (size_t column = 0; column < kGrids.size(); ++column) {
      const int grid = kGrids[column];
      const Floor floor = Shade(grid, stratified, settings, stream++);
      if (of_one == 0) of_one = floor.variance;
      outcome.records.rows.push_back({std::string(stratified ? "stratified" : "random"),
                                      static_cast<double>(grid * grid), floor.mean, floor.variance,
                                      of_one / floor.variance, floor.seconds,
                                      Efficiency(floor.variance, floor.seconds)});
      picture.Place(floor.picture, kSide, static_cast<int>(column) * (kSide + kGap),
                    stratified ? kSide + kGap : 0, scale);
    }
  }
  outcome.figure = std::move(picture);
  outcome.caption =
      "From left to right 1, 9 and 36 samples of the lamp; above random, below stratified.";
  outcome.remarks = {
      "Random samples bring the variance down by 9 and 36, as many as they are: their efficiency "
      "stays the same.",
      "Stratified ones, one in each cell of a grid (PBRT 2.2.1), bring it down by more: where the "
      "whole lamp is seen as n^-2, in the soft shadow, across whose edge most cells lie wholly on "
      "one side, as n^-1.5. V is the mean over the pixels."};
  return outcome;
}

}  // namespace strata::lab
