#include <algorithm>
#include <numbers>

#include "worker/geometry/surfaces.h"
#include "worker/math/elementary.h"

namespace strata {

Wedge Wedge::FromDegrees(double degrees) {
  Wedge wedge;
  const double clamped = std::clamp(degrees, 0.0, 360.0);
  wedge.phi_max = Radians(clamped);
  const SinCosResult<double> end = SinCos(wedge.phi_max);
  wedge.sin = end.sin;
  wedge.cos = end.cos;
  wedge.reflex = clamped > 180;
  wedge.full = clamped == 360;
  return wedge;
}

double Wedge::Fraction(double x, double y) const {
  double phi = Atan2(static_cast<float>(y), static_cast<float>(x));
  if (phi < 0) phi += 2 * std::numbers::pi;
  return std::min(phi / phi_max, 1.0);
}

}  // namespace strata
