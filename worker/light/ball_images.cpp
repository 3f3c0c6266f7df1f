#include "worker/light/ball_images.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <variant>

#include "worker/geometry/placement.h"
#include "worker/math/elementary.h"

namespace strata {

std::vector<Ball> FindBalls(const SceneDescription& scene) {
  std::vector<Ball> balls;
  for (const ShapeDescription& shape : scene.shapes) {
    const auto* sphere = std::get_if<SphereShape>(&shape.geometry);
    if (!sphere || sphere->z_min > -sphere->radius || sphere->z_max < sphere->radius ||
        sphere->phi_max < 360 || shape.emission || shape.reverse_orientation ||
        shape.alpha != AlphaMask())
      continue;
    const std::optional<Placement> placement = Placement::From(shape.to_world);
    if (!placement || !placement->UniformScale()) continue;
    balls.push_back({shape.to_world.Point({0, 0, 0}), sphere->radius * *placement->UniformScale(),
                     shape.material});
  }
  return balls;
}

namespace {

/// The light as a lamp, if it is flat and of one colour.
std::optional<LampInBall> FlatLamp(const Light& light) {
  LampInBall lamp;
  const auto set = [&](Vec3f corner, const auto& flat, bool triangle) {
    lamp.corner = ToDouble(corner);
    lamp.edge1 = ToDouble(flat.edge1);
    lamp.edge2 = ToDouble(flat.edge2);
    lamp.triangle = triangle;
    lamp.ng = ToDouble(flat.ng);
    lamp.two_sided = flat.two_sided;
    lamp.luminance = Luminance(flat.radiance);
  };
  if (const auto* quad = std::get_if<QuadLight>(&light)) {
    set(quad->corner, *quad, false);
  } else if (const auto* triangle = std::get_if<TriangleLight>(&light)) {
    set(triangle->p0, *triangle, true);
  } else {
    return std::nullopt;
  }
  return lamp;
}

bool IsWorthGuiding(const LampInBall& lamp) {
  // Lamps that fill more of what the ball sees are met often enough.
  constexpr double kMostSolidAngle = 0.02;
  const Vec3d to_ball = lamp.center - lamp.Middle();
  return Length(to_ball) > lamp.radius + std::sqrt(lamp.Area()) &&
         (lamp.two_sided || Dot(to_ball, lamp.ng) > 0) && lamp.SolidAngle() < kMostSolidAngle &&
         lamp.luminance > 0;
}

/// Larger about its middle: a ray in floats meets the lamp's very rim where its direction, looked
/// at in double, misses it, or the other way round. The guide then must not take it for a stray
/// one.
LampInBall WithMargin(LampInBall lamp) {
  const Vec3d middle = lamp.Middle();
  const double rounding = 2e-5 * Length(middle - lamp.center);
  const double scale = 1.02 + rounding / std::sqrt(lamp.Area());
  lamp.corner = middle + (lamp.corner - middle) * scale;
  lamp.edge1 = lamp.edge1 * scale;
  lamp.edge2 = lamp.edge2 * scale;
  return lamp;
}

/// What of the lamp comes to the ball.
double Strength(const LampInBall& lamp) {
  return lamp.luminance * lamp.SolidAngle() * lamp.radius * lamp.radius;
}

/// The strongest; none if they are not most of all.
std::vector<LampInBall> LampsInBalls(const std::vector<Ball>& balls, const MaterialSet& materials,
                                     const LightSet& lights) {
  std::vector<LampInBall> strongest;
  double all = 0, kept = 0;
  for (const Ball& ball : balls) {
    const Bsdf* bsdf = materials.Constant(ball.material);
    const auto* glass = bsdf ? std::get_if<DielectricBsdf>(bsdf) : nullptr;
    if (!glass || !glass->IsSmooth() || glass->eta == 1 || materials.HasDetail(ball.material))
      continue;
    for (const Light& light : lights.lights()) {
      std::optional<LampInBall> lamp = FlatLamp(light);
      if (!lamp) continue;
      lamp->center = ball.center;
      lamp->radius = ball.radius;
      lamp->eta = glass->eta;
      if (!IsWorthGuiding(*lamp)) continue;
      all += Strength(*lamp);
      const auto weaker =
          std::find_if(strongest.begin(), strongest.end(),
                       [&](const LampInBall& other) { return Strength(other) < Strength(*lamp); });
      strongest.insert(weaker, *lamp);
      if (strongest.size() > BallImages::kMaxImages) strongest.pop_back();
    }
  }
  for (LampInBall& lamp : strongest) {
    kept += Strength(lamp);
    lamp = WithMargin(lamp);
  }
  if (kept < 0.5 * all) strongest.clear();
  return strongest;
}

}  // namespace

BallStrengths::BallStrengths(const LampInBall& lamp)
    : center_(lamp.center),
      to_lamp_(Normalize(lamp.Middle() - lamp.center)),
      radius_(lamp.radius),
      cells_(static_cast<size_t>(kDistances * kAngles)) {
  // An image that a diffuse surface's own directions meet with this probability counts half.
  constexpr double kEnoughChance = 0.02;
  // What the lamp is like from its side is left out, so that all is the same around the axis.
  LampInBall faced = lamp;
  faced.ng = -to_lamp_;
  const Vec3d middle = lamp.Middle();
  const Frame frame = Frame::FromNormal(ToFloat(to_lamp_));
  const auto strengths = [&](int distance, int angle) {
    // On the axis and at the ball there are no paths, but just beside.
    constexpr double kBeside = 0.02;
    const double ratio = std::clamp<double>(distance, kBeside, kDistances - kBeside) / kDistances;
    const double turn =
        std::numbers::pi * std::clamp<double>(angle, kBeside, kAngles - kBeside) / kAngles;
    const Vec3d p =
        center_ + (to_lamp_ * Cos(turn) + ToDouble(frame.x) * Sin(turn)) * (radius_ / ratio);
    const double direct = 1 / Dot(middle - p, middle - p);
    ByChords sums = {};
    for (int chords = 0; chords <= kMaxChords; ++chords) {
      double sum = 0;
      for (const BallPath& path : FindBallPaths(faced, chords, p, middle)) {
        const double chance = lamp.Area() / path.density / std::numbers::pi;
        sum += path.Strength() / direct / (1 + chance / kEnoughChance);
      }
      sums[static_cast<size_t>(chords)] = static_cast<float>(std::min(sum, 1e6));
    }
    return sums;
  };
  std::vector<ByChords> corners;
  for (int i = 0; i <= kDistances; ++i)
    for (int j = 0; j <= kAngles; ++j) corners.push_back(strengths(i, j));
  for (int i = 0; i < kDistances; ++i) {
    for (int j = 0; j < kAngles; ++j) {
      ByChords& cell = cells_[static_cast<size_t>(i * kAngles + j)];
      for (const int corner : {0, 1, kAngles + 1, kAngles + 2}) {
        const ByChords& at = corners[static_cast<size_t>(i * (kAngles + 1) + j + corner)];
        for (size_t chords = 0; chords < cell.size(); ++chords)
          cell[chords] = std::max(cell[chords], at[chords]);
      }
    }
  }
}

const BallStrengths::ByChords& BallStrengths::At(Vec3d p) const {
  static constexpr ByChords kNone = {};
  const Vec3d from_center = p - center_;
  const double distance = Length(from_center);
  if (!(distance > radius_)) return kNone;
  const double cos = std::clamp(Dot(from_center, to_lamp_) / distance, -1.0, 1.0);
  const float turn = Acos(static_cast<float>(cos));
  const int i = std::min(static_cast<int>(kDistances * radius_ / distance), kDistances - 1);
  const int j = std::min(static_cast<int>(kAngles * kInvPi * turn), kAngles - 1);
  return cells_[static_cast<size_t>(i * kAngles + j)];
}

BallImages::BallImages(const std::vector<LampInBall>& lamps) {
  for (const LampInBall& lamp : lamps) images_.push_back({lamp, BallStrengths(lamp)});
}

BallImages::BallImages(const std::vector<Ball>& balls, const MaterialSet& materials,
                       const LightSet& lights)
    : BallImages(LampsInBalls(balls, materials, lights)) {}

}  // namespace strata
