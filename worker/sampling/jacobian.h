#pragma once

// How densities change with the coordinates they refer to (PBRT 2.4.1): by the absolute value of
// the Jacobian determinant.

namespace strata {

/// Density by (r, phi) of points of the plane with density `pdf` by area.
inline constexpr float AreaToPolarPdf(float pdf, float r) { return pdf * r; }
inline constexpr float PolarToAreaPdf(float pdf, float r) { return r > 0 ? pdf / r : 0; }

/// Density by (r, theta, phi) of points of space with density `pdf` by volume.
inline constexpr float VolumeToSphericalPdf(float pdf, float r, float sin_theta) {
  return pdf * r * r * sin_theta;
}
inline constexpr float SphericalToVolumePdf(float pdf, float r, float sin_theta) {
  return r > 0 && sin_theta > 0 ? pdf / (r * r * sin_theta) : 0;
}

/// Density by (theta, phi) of directions with density `pdf` by solid angle.
inline constexpr float SolidAngleToAnglesPdf(float pdf, float sin_theta) { return pdf * sin_theta; }
inline constexpr float AnglesToSolidAnglePdf(float pdf, float sin_theta) {
  return sin_theta > 0 ? pdf / sin_theta : 0;
}

/// Density by solid angle of the directions into which `wo` is reflected by half vectors (unit, by
/// solid angle) of density `pdf`; `wo_dot_h` is positive (PBRT 9.6.5).
inline constexpr float HalfVectorToReflectedPdf(float pdf, float wo_dot_h) {
  return wo_dot_h > 0 ? pdf / (4 * wo_dot_h) : 0;
}

}  // namespace strata
