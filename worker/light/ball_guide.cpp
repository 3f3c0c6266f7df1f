#include "worker/light/ball_guide.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "worker/math/vec.h"
#include "worker/sampling/choose.h"
#include "worker/sampling/warp.h"

namespace strata {
namespace {

/// Part of the directions that go anywhere to the ball.
constexpr float kConePart = 0.25f;

double Sum(const BallPaths& paths) {
  return std::accumulate(paths.begin(), paths.end(), 0.0,
                         [](double sum, const BallPath& path) { return sum + path.Strength(); });
}

}  // namespace

void BallGuide::Start(const BallImages& images, Vec3f p) {
  constexpr float kMaxShare = 0.5f;
  // Less is left to chance.
  constexpr float kLeast = 1e-3f;
  // Cones are a little wider than the ball, so that rounding does not matter at its border.
  constexpr float kWider = 1 + 1e-4f;
  p_ = ToDouble(p);
  views_.clear();
  total_ = 0;
  for (const BallImage& image : images.images()) {
    const BallStrengths::ByChords& weights = image.strengths.At(p_);
    const float weight = std::accumulate(weights.begin(), weights.end(), 0.0f);
    if (weight < kLeast) continue;
    const Vec3d to_ball = image.lamp.center - p_;
    const double distance2 = Dot(to_ball, to_ball);
    const double sin2 = image.lamp.radius * image.lamp.radius / distance2;
    views_.push_back({&image, weights, weight, ToFloat(to_ball * (1 / std::sqrt(distance2))),
                      kWider * OneMinusCosFromSinSquared(static_cast<float>(sin2))});
    total_ += weight;
  }
  share_ = kMaxShare * total_ / (1 + total_);
}

std::optional<Vec3f> BallGuide::Sample(float u_image, Vec2f u) const {
  float left = u_image * total_;
  const View& view = views_[ChooseByWeight(
      views_.size(), [&](size_t i) { return views_[i].weight; }, &left)];
  const float cone = kConePart * view.weight;
  if (left < cone)
    return Frame::FromNormal(view.axis).ToWorld(SampleUniformCone(u, view.one_minus_cos));
  left = (left - cone) / (1 - kConePart);
  const size_t chords = ChooseByWeight(
      view.weights.size(), [&](size_t n) { return view.weights[n]; }, &left);
  const float weight = view.weights[chords];
  const LampInBall& lamp = view.image->lamp;
  const BallPaths paths = FindBallPaths(lamp, static_cast<int>(chords), p_, lamp.Point(u.x, u.y));
  if (paths.empty() || !(weight > 0)) return std::nullopt;
  double rest = left / weight * Sum(paths);
  const size_t path = ChooseByWeight(
      paths.size(), [&](size_t i) { return paths[i].Strength(); }, &rest);
  return ToFloat(paths[path].direction);
}

float BallGuide::Pdf(Vec3f w) const {
  // Within this a direction is that of a path, whose lamp point came from it.
  constexpr double kSame = 1e-5;
  const Vec3d direction = Normalize(ToDouble(w));
  double pdf = 0;
  for (const View& view : views_) {
    if (Dot(w, view.axis) < 1 - view.one_minus_cos) continue;
    pdf += view.weight * kConePart * UniformConePdf(view.one_minus_cos);
    const LampInBall& lamp = view.image->lamp;
    for (int chords = 0; chords <= kMaxChords; ++chords) {
      const float weight = view.weights[static_cast<size_t>(chords)];
      const std::optional<Vec3d> at =
          weight > 0 ? LampPointBy(lamp, chords, p_, direction) : std::nullopt;
      if (!at) continue;
      const BallPaths paths = FindBallPaths(lamp, chords, p_, *at);
      const auto same = std::find_if(paths.begin(), paths.end(), [&](const BallPath& path) {
        return Length(path.direction - direction) < kSame;
      });
      if (same != paths.end())
        pdf += weight * (1 - kConePart) * same->amplitude / (Sum(paths) * lamp.Area());
    }
  }
  return static_cast<float>(pdf / total_);
}

}  // namespace strata
