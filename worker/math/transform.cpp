#include "worker/math/transform.h"

#include <cmath>
#include <utility>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

std::optional<Vec3d> Unit(Vec3d v) {
  const double length = std::sqrt(Dot(v, v));
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return Vec3d{v.x / length, v.y / length, v.z / length};
}

/// Exact where the axes of a scene usually point, so that a quarter turn keeps its zeros.
SinCosResult<double> SinCosDegrees(double degrees) {
  const double reduced = std::fmod(degrees, 360.0);
  if (std::fmod(reduced, 90.0) != 0) return SinCos(Radians(reduced));
  const int quarter = (static_cast<int>(reduced / 90) + 4) % 4;
  constexpr double kSin[] = {0, 1, 0, -1};
  return {kSin[quarter], kSin[(quarter + 1) % 4]};
}

}  // namespace

Transform Transform::Translate(double x, double y, double z) {
  return {{{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}}};
}

Transform Transform::Scale(double x, double y, double z) {
  return {{{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}, {0, 0, 0, 1}}}};
}

Transform Transform::Rotate(double degrees, double x, double y, double z) {
  const std::optional<Vec3d> axis = Unit({x, y, z});
  if (!axis) return {};
  const auto [s, c] = SinCosDegrees(degrees);
  const Vec3d a = *axis;
  const double t = 1 - c;
  return {{{{a.x * a.x * t + c, a.x * a.y * t - a.z * s, a.x * a.z * t + a.y * s, 0},
            {a.x * a.y * t + a.z * s, a.y * a.y * t + c, a.y * a.z * t - a.x * s, 0},
            {a.x * a.z * t - a.y * s, a.y * a.z * t + a.x * s, a.z * a.z * t + c, 0},
            {0, 0, 0, 1}}}};
}

std::optional<Transform> Transform::LookAt(Vec3d eye, Vec3d look, Vec3d up) {
  const std::optional<Vec3d> forward = Unit({look.x - eye.x, look.y - eye.y, look.z - eye.z});
  const std::optional<Vec3d> unit_up = Unit(up);
  if (!forward || !unit_up) return std::nullopt;
  const Vec3d side = Cross(*unit_up, *forward);
  if (Dot(side, side) < 1e-20) return std::nullopt;  // `up` is along the view
  const Vec3d right = *Unit(side);
  const Vec3d true_up = Cross(*forward, right);
  return Transform{{{{right.x, right.y, right.z, -Dot(right, eye)},
                     {true_up.x, true_up.y, true_up.z, -Dot(true_up, eye)},
                     {forward->x, forward->y, forward->z, -Dot(*forward, eye)},
                     {0, 0, 0, 1}}}};
}

Transform Transform::FromColumns(const std::array<double, 16>& columns) {
  Transform t;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) t.m[row][column] = columns[4 * column + row];
  }
  return t;
}

Vec3d Transform::Point(Vec3d p) const {
  double r[4];
  for (int i = 0; i < 4; ++i) r[i] = m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3];
  if (r[3] == 1) return {r[0], r[1], r[2]};
  return {r[0] / r[3], r[1] / r[3], r[2] / r[3]};
}

Vec3d Transform::Vector(Vec3d v) const {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
          m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

Vec3d Transform::Normal(const Transform& inverse, Vec3d n) {
  const auto& m = inverse.m;
  return {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
          m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
          m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
}

std::optional<Transform> Transform::Inverse() const {
  // Gauss-Jordan elimination with partial pivoting.
  auto a = m;
  Transform inverse;
  auto& b = inverse.m;
  for (int column = 0; column < 4; ++column) {
    int pivot = column;
    for (int row = column + 1; row < 4; ++row) {
      if (std::fabs(a[row][column]) > std::fabs(a[pivot][column])) pivot = row;
    }
    if (!(std::fabs(a[pivot][column]) > 0)) return std::nullopt;
    std::swap(a[pivot], a[column]);
    std::swap(b[pivot], b[column]);
    const double scale = a[column][column];
    for (int i = 0; i < 4; ++i) {
      a[column][i] /= scale;
      b[column][i] /= scale;
    }
    for (int row = 0; row < 4; ++row) {
      const double factor = a[row][column];
      if (row == column || factor == 0) continue;
      for (int i = 0; i < 4; ++i) {
        a[row][i] -= factor * a[column][i];
        b[row][i] -= factor * b[column][i];
      }
    }
  }
  if (!inverse.IsFinite()) return std::nullopt;
  return inverse;
}

Transform Transform::Transposed() const {
  Transform t;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) t.m[row][column] = m[column][row];
  }
  return t;
}

bool Transform::SwapsHandedness() const {
  const Vec3d x{m[0][0], m[1][0], m[2][0]}, y{m[0][1], m[1][1], m[2][1]},
      z{m[0][2], m[1][2], m[2][2]};
  return Dot(Cross(x, y), z) < 0;
}

bool Transform::IsFinite() const {
  for (const auto& row : m) {
    for (const double value : row) {
      if (!std::isfinite(value)) return false;
    }
  }
  return true;
}

Transform operator*(const Transform& a, const Transform& b) {
  Transform product;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      double sum = 0;
      for (int i = 0; i < 4; ++i) sum += a.m[row][i] * b.m[i][column];
      product.m[row][column] = sum;
    }
  }
  return product;
}

}  // namespace strata
