#include "worker/light/ball_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/bsdf/fresnel.h"
#include "worker/math/elementary.h"

namespace strata {
namespace {

constexpr double kRightAngle = std::numbers::pi / 2;

/// What a border does to light that comes at the sine and cosine of an angle.
double Amplitude(const LampInBall& lamp, int chords, double cos_incident) {
  const double reflected =
      FresnelDielectric(static_cast<float>(cos_incident), static_cast<float>(lamp.eta)).reflectance;
  if (chords == 0) return std::sqrt(reflected);
  return (1 - reflected) * (chords == 1 ? 1 : std::sqrt(reflected));
}

/// Paths of one number of chords between two points outside of a ball, by their angle of incidence.
class Turn {
 public:
  Turn(const LampInBall& lamp, int chords, double from_distance, double to_distance)
      : eta_(lamp.eta),
        chords_(chords),
        from_(lamp.radius / from_distance),
        to_(lamp.radius / to_distance),
        most_(chords > 0 && lamp.eta < 1 ? Asin(lamp.eta) : kRightAngle) {}

  /// Calls f(incident, slope) for every path that turns by `angle`.
  template <typename F>
  void ForEachPath(double angle, F&& f) const {
    const double turn0 = Angle(0), turn_most = Angle(most_);
    // Either it grows or falls all the way, or it falls to a valley and grows then: the rainbow.
    const double valley = Slope(0) < 0 && !(chords_ > 0 && eta_ < 1) ? Valley() : 0;
    if (valley > 0) {
      const double turn_valley = Angle(valley);
      if (turn_valley < angle && angle < turn0) Solve(angle, 0, valley, -1, f);
      if (turn_valley < angle && angle < turn_most) Solve(angle, valley, most_, 1, f);
    } else if ((turn0 < angle) != (turn_most < angle)) {
      Solve(angle, 0, most_, turn0 < turn_most ? 1 : -1, f);
    }
  }

 private:
  double Angle(double incident) const {
    const double sin = Sin(incident);
    const auto inner = [&](double ratio) { return Asin(std::min(sin * ratio, 1.0)); };
    return 2 * incident - inner(from_) - inner(to_) +
           chords_ * (std::numbers::pi - 2 * inner(1 / eta_));
  }
  /// Of the angle, by the angle of incidence.
  double Slope(double incident) const {
    const auto [sin, cos] = SinCos(incident);
    const auto inner = [&, s = sin, c = cos](double ratio) {
      return ratio * c / std::sqrt(std::max(1 - s * ratio * (s * ratio), 0.0));
    };
    const double outside = 2 - inner(from_) - inner(to_);
    return chords_ == 0 ? outside : outside - 2 * chords_ * inner(1 / eta_);
  }
  double Valley() const {
    double low = 0, high = most_;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (low + high);
      (Slope(middle) < 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  /// Newton's steps within [low, high], where the turn only grows (sign 1) or falls (-1).
  template <typename F>
  void Solve(double angle, double low, double high, int sign, F&& f) const {
    double incident = 0.5 * (low + high);
    for (int i = 0; i < 100; ++i) {
      const double miss = Angle(incident) - angle;
      (miss * sign < 0 ? low : high) = incident;
      double next = incident - miss / Slope(incident);
      if (!(low < next && next < high)) next = 0.5 * (low + high);
      const bool found = std::abs(next - incident) < 1e-12;
      incident = next;
      if (found) break;
    }
    f(incident, Slope(incident));
  }

  double eta_;
  int chords_;
  double from_, to_;  ///< Radius over the points' distances.
  double most_;       ///< Angle of incidence.
};

bool IsLit(const LampInBall& lamp, double toward) {
  return lamp.two_sided ? toward != 0 : toward > 0;
}

bool IsWithin(const LampInBall& lamp, Vec3d p) {
  const Vec3d d = p - lamp.corner;
  const double aa = Dot(lamp.edge1, lamp.edge1), bb = Dot(lamp.edge2, lamp.edge2);
  const double ab = Dot(lamp.edge1, lamp.edge2), det = aa * bb - ab * ab;
  const double a = (Dot(d, lamp.edge1) * bb - Dot(d, lamp.edge2) * ab) / det;
  const double b = (Dot(d, lamp.edge2) * aa - Dot(d, lamp.edge1) * ab) / det;
  return a >= 0 && b >= 0 && (lamp.triangle ? a + b <= 1 : a <= 1 && b <= 1);
}

}  // namespace

double LampInBall::Area() const { return Length(Cross(edge1, edge2)) * (triangle ? 0.5 : 1); }
double LampInBall::SolidAngle() const {
  const Vec3d to_lamp = Middle() - center;
  return Area() / Dot(to_lamp, to_lamp);
}
Vec3d LampInBall::Point(double u, double v) const {
  if (triangle && u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return corner + edge1 * u + edge2 * v;
}
Vec3d LampInBall::Middle() const {
  const double part = triangle ? 1.0 / 3 : 0.5;
  return Point(part, part);
}

BallPaths FindBallPaths(const LampInBall& lamp, int chords, Vec3d p, Vec3d lamp_point) {
  BallPaths paths;
  const Vec3d from_center = p - lamp.center, to_lamp = lamp_point - lamp.center;
  const double from_distance = Length(from_center), to_distance = Length(to_lamp);
  const double radius = lamp.radius;
  if (!(from_distance > radius && to_distance > radius)) return paths;
  const Vec3d axis = from_center * (1 / from_distance);
  const double along = Dot(to_lamp, axis);
  const Vec3d across = to_lamp - axis * along;
  const double sin_turn = Length(across) / to_distance;
  // On the axis itself light comes by a ring, or straight.
  if (!(sin_turn > 1e-12)) return paths;
  const Vec3d up = across * (1 / Length(across));
  const double turn = Atan2(sin_turn, along / to_distance);

  const Vec3d outward = to_lamp * (1 / to_distance);
  const Vec3d onward = up * (along / to_distance) - axis * sin_turn;
  const Turn turns(lamp, chords, from_distance, to_distance);
  // Round by the lamp's side, or by the other, or once about.
  const double angles[] = {turn, 2 * std::numbers::pi - turn, 2 * std::numbers::pi + turn};
  for (int way = 0; way <= chords; ++way) {
    const double side = way == 1 ? -1 : 1;
    turns.ForEachPath(angles[way], [&](double incident, double slope) {
      const auto [impact, cos_incident] = SinCos(incident);
      const double sin_from = impact * radius / from_distance;
      const double sin_to = impact * radius / to_distance;
      const double cos_from = std::sqrt(1 - sin_from * sin_from);
      const double cos_to = std::sqrt(1 - sin_to * sin_to);
      const Vec3d arriving = outward * cos_to + onward * (side * sin_to);
      const double toward = -Dot(arriving, lamp.ng);
      if (!IsLit(lamp, toward)) return;
      const double spread = to_distance * from_distance / radius;
      const BallPath path = {.direction = up * (side * sin_from) - axis * cos_from,
                             .density = spread * spread * sin_turn * std::abs(slope) * cos_from *
                                        cos_to / (impact * cos_incident * std::abs(toward)),
                             .amplitude = Amplitude(lamp, chords, cos_incident)};
      if (path.density > 0 && std::isfinite(path.density) && path.amplitude > 0)
        paths.push_back(path);
    });
  }
  return paths;
}

std::optional<Vec3d> LampPointBy(const LampInBall& lamp, int chords, Vec3d p, Vec3d direction) {
  const Vec3d from_center = p - lamp.center;
  const double distance = Length(from_center), radius = lamp.radius;
  const Vec3d axis = from_center * (1 / distance);
  const double along = Dot(direction, axis);
  const Vec3d across = direction - axis * along;
  const double sin = Length(across), impact = sin * distance / radius;
  if (!(along < 0) || !(sin > 0) || !(impact < 1) || (chords > 0 && !(impact < lamp.eta)))
    return std::nullopt;
  const double incident = Asin(impact);
  const double leave = incident - Atan2(sin, -along) +
                       chords * (std::numbers::pi - 2 * Asin(std::min(impact / lamp.eta, 1.0)));
  const Vec3d up = across * (1 / sin);
  const auto at_angle = [&](double angle) {
    const auto [s, c] = SinCos(angle);
    return axis * c + up * s;
  };
  const Vec3d from = lamp.center + at_angle(leave) * radius, onward = at_angle(leave + incident);
  const double toward = -Dot(onward, lamp.ng);
  if (!IsLit(lamp, toward)) return std::nullopt;
  const double t = Dot(from - lamp.corner, lamp.ng) / toward;
  const Vec3d at = from + onward * t;
  return t > 0 && IsWithin(lamp, at) ? std::optional<Vec3d>(at) : std::nullopt;
}

}  // namespace strata
