#pragma once

#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/sampling/henyey_greenstein.h"

namespace strata {

/// How a point of a medium scatters, in a BSDF's terms, so that it is a vertex like any other:
/// Henyey and Greenstein's phase function (PBRT 11.3.1) stands in the place of f |cos theta_i|, and
/// the local z axis is wo.
struct PhaseFunction {
  float g = 0;  ///< In (-1, 1): the mean cosine of the angle light is turned by; 0: isotropic.
};

inline bool IsDelta(const PhaseFunction&) { return false; }
inline bool HasDelta(const PhaseFunction&) { return false; }

inline float Pdf(const PhaseFunction& phase, Vec3f, Vec3f wi) {
  // Light that goes straight on arrives from -wo.
  return HenyeyGreensteinPdf({wi.x, wi.y, -wi.z}, phase.g);
}

inline Rgb Eval(const PhaseFunction& phase, Vec3f wo, Vec3f wi) {
  return Rgb::Gray(Pdf(phase, wo, wi));
}

inline BsdfValue EvalPdf(const PhaseFunction& phase, Vec3f wo, Vec3f wi) {
  const float pdf = Pdf(phase, wo, wi);
  return {Rgb::Gray(pdf), pdf};
}

inline std::optional<BsdfSample> Sample(const PhaseFunction& phase, Vec3f wo, float, Vec2f u) {
  const Vec3f on = SampleHenyeyGreenstein(u, phase.g);
  const Vec3f wi = {on.x, on.y, -on.z};
  return BsdfSample{.wi = wi, .weight = {1, 1, 1}, .pdf = Pdf(phase, wo, wi)};
}

inline Rgb Albedo(const PhaseFunction&, Vec3f) { return {1, 1, 1}; }

}  // namespace strata
