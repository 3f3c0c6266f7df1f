#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "cli/lab/measure.h"
#include "worker/sampling/alias_table.h"
#include "worker/sampling/blinn.h"
#include "worker/sampling/disk.h"
#include "worker/sampling/henyey_greenstein.h"
#include "worker/sampling/inversion.h"
#include "worker/sampling/rejection.h"
#include "worker/sampling/spherical_triangle.h"
#include "worker/sampling/triangle_sqrt.h"
#include "worker/sampling/warp.h"

// Where the sampling routines put their points (PBRT 2.3, 2.4, A.1 to A.5).

namespace strata::lab {
namespace {

/// Where a point is drawn, in [-1, 1]^2 with y upwards, and what is averaged over all.
struct Drawn {
  Vec2f place;
  double value = 0;
};

struct Routine {
  const char* name;
  const char* value;  ///< What is averaged.
  double truth;       ///< Its mean, in closed form.
  /// `u` is jittered over the unit square; rejection draws from `random` instead.
  std::function<Drawn(Vec2f u, RandomStream& random)> draw;
};

double Square(double x) { return x * x; }
Vec2f Corner(float x, float y) { return {2 * x - 1, 2 * y - 1}; }
Drawn OnDisk(Vec2f p) { return {p, Square(p.x) + Square(p.y)}; }
/// A triangle with corners at the bottom left, the bottom right and the top left.
Drawn InTriangle(Vec2f weights) { return {Corner(weights.x, weights.y), weights.x}; }
/// Seen along the axis.
Drawn Direction(Vec3f w) { return {{w.x, w.y}, w.z}; }

std::vector<Routine> Routines() {
  static const std::array<double, 4> kWeights = {1, 2, 3, 4};
  const AliasTable alias(kWeights);
  const SphericalTriangle octant({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0});
  static constexpr std::array<float, 4> kCorners = {1, 3, 3, 9};
  return {
      {"disk, polar", "r^2", 0.5, [](Vec2f u, auto&) { return OnDisk(SamplePolarDisk(u)); }},
      {"disk, concentric", "r^2", 0.5,
       [](Vec2f u, auto&) { return OnDisk(SampleConcentricDisk(u)); }},
      {"disk, rejection", "r^2", 0.5,
       [](Vec2f, RandomStream& random) {
         return OnDisk(SampleDiskByRejection([&] { return random.Next(); }).point);
       }},
      {"sphere", "z^2", 1.0 / 3,
       [](Vec2f u, auto&) {
         const Vec3f w = SampleUniformSphere(u);
         return Drawn{{w.x, w.y}, Square(w.z)};
       }},
      {"triangle, square root", "first weight", 1.0 / 3,
       [](Vec2f u, auto&) { return InTriangle(SampleTriangleSqrt(u)); }},
      {"triangle, low distortion", "first weight", 1.0 / 3,
       [](Vec2f u, auto&) { return InTriangle(SampleTriangle(u)); }},
      {"spherical triangle, an octant", "cosine", 0.5,
       [octant](Vec2f u, auto&) { return Direction(octant.Sample(u)); }},
      {"cone of 60 degrees", "cosine", 0.75,
       [](Vec2f u, auto&) { return Direction(SampleUniformCone(u, 0.5f)); }},
      {"hemisphere, uniform", "cosine", 0.5,
       [](Vec2f u, auto&) { return Direction(SampleUniformHemisphere(u)); }},
      {"hemisphere, cosine", "cosine", 2.0 / 3,
       [](Vec2f u, auto&) { return Direction(SampleCosineHemisphere(u)); }},
      {"Blinn half vectors, n = 20", "cosine", 21.0 / 22,
       [](Vec2f u, auto&) { return Direction(SampleBlinn(u, 20)); }},
      {"Henyey-Greenstein, g = 0.6", "cosine", 0.6,
       [](Vec2f u, auto&) { return Direction(SampleHenyeyGreenstein(u, 0.6f)); }},
      {"power, x^3", "x", 0.8,
       [](Vec2f u, auto&) {
         const float x = SamplePower(u.x, 3);
         return Drawn{Corner(x, u.y), x};
       }},
      {"exponential, a = 3", "x", 1.0 / 3,
       [](Vec2f u, auto&) {
         const float x = SampleExponential(u.x, 3);
         return Drawn{Corner(x / 2, u.y), x};
       }},
      {"bilinear, 1 3 3 9", "x", 7.0 / 12,
       [](Vec2f u, auto&) {
         const Vec2f p = SampleBilinear(u, kCorners);
         return Drawn{Corner(p.x, p.y), p.x};
       }},
      {"discrete, 1 2 3 4 by alias", "outcome", 2,
       [alias](Vec2f u, auto&) {
         const AliasTable::Choice choice = alias.Choose(u.x);
         const auto outcome = static_cast<float>(choice.outcome);
         const float rest = static_cast<float>(choice.fraction);
         return Drawn{Corner((outcome + 0.1f + 0.8f * rest) / 4, u.y), outcome};
       }},
  };
}

constexpr int kSide = 180, kColumns = 4;  ///< Pixels of a panel, panels in a row.
constexpr int kCells = 40;                ///< Points of a panel are jittered in so many squared.

void DrawPanel(const Routine& routine, RandomStream& random, int left, int top, Picture* picture) {
  for (int i = 0; i < kCells * kCells; ++i) {
    const Vec2f jitter = random.Next2D();
    const Vec2f u = {(static_cast<float>(i % kCells) + jitter.x) / kCells,
                     (static_cast<float>(i / kCells) + jitter.y) / kCells};
    const Vec2f place = routine.draw(u, random).place;
    // What lies beyond the panel is not drawn: exponential numbers have no end.
    if (std::fabs(place.x) > 1 || std::fabs(place.y) > 1) continue;
    constexpr float kReach = 0.46f * kSide;
    const int x = left + static_cast<int>(0.5f * kSide + kReach * place.x);
    const int y = top + static_cast<int>(0.5f * kSide - kReach * place.y);
    constexpr std::array<double, 1> kInk = {0.0};
    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
      picture->Place(kInk, 1, x + dx, y + dy);
  }
}

}  // namespace

absl::StatusOr<Outcome> RunRoutines(const Settings& settings) {
  Outcome outcome;
  outcome.records.columns = {"routine",        "of",      "mean", "truth",
                             "standard error", kVariance, kTime,  kEfficiency};
  const std::vector<Routine> routines = Routines();
  const int rows = (static_cast<int>(routines.size()) + kColumns - 1) / kColumns;
  Picture picture = Picture::White(kColumns * kSide, rows * kSide);
  for (size_t i = 0; i < routines.size(); ++i) {
    const Routine& routine = routines[i];
    RandomStream random(settings.seed, static_cast<uint32_t>(i));
    const Measured measured =
        Measure(settings.samples, [&] { return routine.draw(random.Next2D(), random).value; });
    outcome.records.rows.push_back({std::string(routine.name), std::string(routine.value),
                                    measured.Mean(), routine.truth, measured.StandardError(),
                                    measured.Variance(), measured.seconds,
                                    Efficiency(measured.Variance(), measured.seconds)});
    DrawPanel(routine, random, static_cast<int>(i) % kColumns * kSide,
              static_cast<int>(i) / kColumns * kSide, &picture);
  }
  outcome.figure = std::move(picture);
  outcome.caption =
      "1600 jittered points through each routine, in the order of the table, four in a row; "
      "directions are seen along their axis.";
  outcome.remarks = {
      "All are uniform or follow their density, and still differ: the concentric map of the disk "
      "and the low-distortion map of the triangle keep neighbours together, so that jittered "
      "points stay apart; the polar map and the square root stretch cells, and rejection forgets "
      "the cells altogether (PBRT A.5).",
      "Cosine-distributed directions are the concentric disk lifted to the hemisphere (Malley): "
      "seen along the axis they are uniform."};
  return outcome;
}

}  // namespace strata::lab
