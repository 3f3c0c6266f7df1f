#include "worker/math/motion.h"

#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;

  friend Quaternion operator*(Quaternion q, double s) {
    return {q.w * s, q.x * s, q.y * s, q.z * s};
  }
  friend Quaternion operator+(Quaternion a, Quaternion b) {
    return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
  }
};
double Dot(Quaternion a, Quaternion b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }

/// Of a rotation's linear part, by the largest of the four components (Shepperd's method).
Quaternion QuaternionOf(const Transform& rotation) {
  const auto& m = rotation.m;
  const double trace = m[0][0] + m[1][1] + m[2][2];
  Quaternion q;
  if (trace > 0) {
    q = {trace + 1, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
  } else if (m[0][0] >= std::max(m[1][1], m[2][2])) {
    q = {m[2][1] - m[1][2], 1 + m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[0][2] + m[2][0]};
  } else if (m[1][1] >= m[2][2]) {
    q = {m[0][2] - m[2][0], m[0][1] + m[1][0], 1 + m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1]};
  } else {
    q = {m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], 1 + m[2][2] - m[0][0] - m[1][1]};
  }
  return q * (1 / std::sqrt(Dot(q, q)));
}

Transform RotationOf(Quaternion q) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z,
               yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{{{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy), 0},
            {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx), 0},
            {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy), 0},
            {0, 0, 0, 1}}}};
}

/// a (1 - t) + b t, element by element.
Transform Blend(const Transform& a, const Transform& b, double t) {
  Transform blend;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      blend.m[row][column] = a.m[row][column] * (1 - t) + b.m[row][column] * t;
  }
  return blend;
}

/// The largest element of the linear part.
double LargestElement(const Transform& map) {
  double largest = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      largest = std::max(largest, std::abs(map.m[row][column]));
  }
  return largest;
}

double LargestDifference(const Transform& a, const Transform& b) {
  double largest = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      largest = std::max(largest, std::abs(a.m[row][column] - b.m[row][column]));
  }
  return largest;
}

/// translation * rotation * stretch; the stretch is negative where the map mirrors.
struct Parts {
  Vec3d translation;
  Quaternion rotation;
  Transform stretch;
  bool mirrors = false;
};

std::optional<Parts> Decompose(const Transform& map) {
  const auto& last = map.m[3];
  if (!map.IsFinite() || last[0] != 0 || last[1] != 0 || last[2] != 0 || last[3] != 1)
    return std::nullopt;
  Parts parts;
  parts.translation = {map.m[0][3], map.m[1][3], map.m[2][3]};
  Transform linear = map;
  for (int row = 0; row < 3; ++row) linear.m[row][3] = 0;
  // Newton's iteration for the orthogonal factor (Higham 1986): quadratic in the end, and halving
  // what is far off before, so that forty steps suffice for any map of doubles that is used.
  Transform orthogonal = linear;
  for (int i = 0; i < 100; ++i) {
    const std::optional<Transform> inverse = orthogonal.Inverse();
    if (!inverse) return std::nullopt;
    const Transform next = Blend(orthogonal, inverse->Transposed(), 0.5);
    const double change = LargestDifference(next, orthogonal);
    orthogonal = next;
    if (change < 1e-15) break;
  }
  if (!orthogonal.IsFinite()) return std::nullopt;
  parts.mirrors = orthogonal.SwapsHandedness();
  if (parts.mirrors) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) orthogonal.m[row][column] *= -1;
    }
  }
  parts.rotation = QuaternionOf(orthogonal);
  parts.stretch = orthogonal.Transposed() * linear;
  return parts;
}

/// Along the great arc from `a` to `b`, which are at `angle` from each other.
Quaternion Slerp(Quaternion a, Quaternion b, double angle, double t) {
  const double sine = Sin(angle);
  const Quaternion q = sine > 1e-9 ? a * (Sin(angle * (1 - t)) / sine) + b * (Sin(angle * t) / sine)
                                   : a * (1 - t) + b * t;
  return q * (1 / std::sqrt(Dot(q, q)));
}

/// How many straight pieces keep within the tolerance of a turn by `angle` (of the object, radians)
/// while the stretch changes by a factor of 1 + `change`: a chord's deviation is an eighth of its
/// square times the second derivative.
int PiecesFor(double angle, double change) {
  constexpr double kTolerance = 0x1p-17;
  const double second = angle * angle + 2 * angle * change;
  const double pieces = std::ceil(std::sqrt(second / (8 * kTolerance)));
  return static_cast<int>(std::clamp(pieces, 1.0, double{kMaxMotionPieces}));
}

}  // namespace

std::optional<std::vector<Transform>> MotionSteps(const Transform& start, const Transform& end) {
  const std::optional<Parts> a = Decompose(start);
  std::optional<Parts> b = Decompose(end);
  if (!a || !b || a->mirrors != b->mirrors) return std::nullopt;
  if (Dot(a->rotation, b->rotation) < 0) b->rotation = b->rotation * -1;
  const Quaternion difference = b->rotation + a->rotation * -1, sum = b->rotation + a->rotation;
  const double angle = 2 * Atan2(std::sqrt(Dot(difference, difference)), std::sqrt(Dot(sum, sum)));
  const double size = std::max(LargestElement(a->stretch), LargestElement(b->stretch));
  const int pieces = PiecesFor(2 * angle, LargestDifference(a->stretch, b->stretch) / size);
  std::vector<Transform> steps = {start};
  for (int i = 1; i < pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    const Vec3d p = Lerp(t, a->translation, b->translation);
    steps.push_back(Transform::Translate(p.x, p.y, p.z) *
                    RotationOf(Slerp(a->rotation, b->rotation, angle, t)) *
                    Blend(a->stretch, b->stretch, t));
  }
  steps.push_back(end);
  return steps;
}

}  // namespace strata
