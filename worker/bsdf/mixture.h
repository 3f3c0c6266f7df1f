#pragma once

#include <optional>

#include "worker/bsdf/bsdf_sample.h"

namespace strata {

struct MixtureParts;

/// A weighted sum of BSDFs. A direction is drawn from one of them, chosen by weight and albedo, and
/// weighed by the density of all: one-sample MIS with the balance heuristic (Veach 1997, 9.2.4;
/// PBRT 2.2.3), whose variance no other weights undercut by more than a little. Delta parts, which
/// have no density to share, count alone.
struct MixtureBsdf {
  const MixtureParts* parts = nullptr;  ///< Outlives the BSDF.
};

bool IsDelta(const MixtureBsdf& bsdf);
bool Transmits(const MixtureBsdf& bsdf);
BsdfValue EvalPdf(const MixtureBsdf& bsdf, Vec3f wo, Vec3f wi);
Rgb Eval(const MixtureBsdf& bsdf, Vec3f wo, Vec3f wi);
float Pdf(const MixtureBsdf& bsdf, Vec3f wo, Vec3f wi);
std::optional<BsdfSample> Sample(const MixtureBsdf& bsdf, Vec3f wo, float u_lobe, Vec2f u);
Rgb Albedo(const MixtureBsdf& bsdf, Vec3f wo);

}  // namespace strata
