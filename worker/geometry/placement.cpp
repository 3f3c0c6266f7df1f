#include "worker/geometry/placement.h"

namespace strata {
namespace {

Placement::Rows RowsOf(const Transform& t) { return {t.m[0], t.m[1], t.m[2]}; }

}  // namespace

std::optional<Placement> Placement::From(const Transform& to_world) {
  if (!to_world.IsFinite()) return std::nullopt;
  const auto& last = to_world.m[3];
  if (last[0] != 0 || last[1] != 0 || last[2] != 0 || !(last[3] != 0)) return std::nullopt;
  Transform affine = to_world;
  for (auto& row : affine.m) {
    for (double& element : row) element /= last[3];
  }
  const std::optional<Transform> inverse = affine.Inverse();
  if (!inverse || !inverse->IsFinite()) return std::nullopt;
  Placement placement;
  placement.to_world = RowsOf(affine);
  placement.to_object = RowsOf(*inverse);
  const auto& m = placement.to_world;
  placement.determinant =
      Dot(Vec3d{m[0][0], m[0][1], m[0][2]},
          Cross(Vec3d{m[1][0], m[1][1], m[1][2]}, Vec3d{m[2][0], m[2][1], m[2][2]}));
  if (placement.determinant == 0 || !std::isfinite(placement.determinant)) return std::nullopt;
  return placement;
}

std::optional<double> Placement::UniformScale() const {
  // Scene files hold about seven digits, so columns that differ by less were meant to be equal.
  constexpr double kTolerance = 1e-5;
  Vec3d columns[3];
  for (int i = 0; i < 3; ++i) columns[i] = {to_world[0][i], to_world[1][i], to_world[2][i]};
  const double scale2 = Dot(columns[0], columns[0]);
  for (int i = 0; i < 3; ++i) {
    const Vec3d a = columns[i], b = columns[(i + 1) % 3];
    if (std::abs(Dot(a, a) - scale2) > kTolerance * scale2) return std::nullopt;
    if (std::abs(Dot(a, b)) > kTolerance * scale2) return std::nullopt;
  }
  return std::sqrt(scale2);
}

}  // namespace strata
