#pragma once

#include <optional>
#include <variant>

#include "worker/math/vec.h"

#include "worker/bsdf/ashikhmin_shirley.h"
#include "worker/bsdf/blinn.h"
#include "worker/bsdf/coated_conductor.h"
#include "worker/bsdf/coated_diffuse.h"
#include "worker/bsdf/conductor.h"
#include "worker/bsdf/dielectric.h"
#include "worker/bsdf/diffuse.h"
#include "worker/bsdf/diffuse_transmission.h"
#include "worker/bsdf/metallic_roughness.h"
#include "worker/bsdf/mixture.h"
#include "worker/bsdf/phase_function.h"
#include "worker/bsdf/thin_dielectric.h"

// How a point of a surface, or of a medium, scatters light. Each kind is a plain struct with free
// inline functions in a header of its own:
//
//   Rgb Eval(const X&, Vec3f wo, Vec3f wi)          f(wo, wi) |cos theta_i|; 0 for delta parts
//   float Pdf(const X&, Vec3f wo, Vec3f wi)         per solid angle of wi; 0 for delta parts
//   BsdfValue EvalPdf(const X&, Vec3f wo, Vec3f wi) both, where that saves work; optional
//   std::optional<BsdfSample> Sample(const X&, Vec3f wo, float u_lobe, Vec2f u)
//   bool IsDelta(const X&)                          all of it is delta: light sampling is in vain
//   bool HasDelta(const X&)                         some of it is delta; optional: maybe
//   Rgb Albedo(const X&, Vec3f wo)                  directional albedo, approximate, for a channel
//
// Directions are local (z = shading normal), unit, and point away from the surface. Transport is of
// radiance: refraction scales by 1/eta^2 (PBRT 9.5.2).

namespace strata {

using Bsdf =
    std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, ThinDielectricBsdf, CoatedDiffuseBsdf,
                 CoatedConductorBsdf, DiffuseTransmissionBsdf, BlinnBsdf, AshikhminShirleyBsdf,
                 MetallicRoughnessBsdf, MixtureBsdf, PhaseFunction>;

inline Rgb Eval(const Bsdf& bsdf, Vec3f wo, Vec3f wi) {
  return std::visit([&](const auto& b) { return Eval(b, wo, wi); }, bsdf);
}
inline float Pdf(const Bsdf& bsdf, Vec3f wo, Vec3f wi) {
  return std::visit([&](const auto& b) { return Pdf(b, wo, wi); }, bsdf);
}
/// For kinds that have no cheaper way to both.
template <typename X>
BsdfValue EvalPdf(const X& bsdf, Vec3f wo, Vec3f wi) {
  return {Eval(bsdf, wo, wi), Pdf(bsdf, wo, wi)};
}
inline BsdfValue EvalPdf(const Bsdf& bsdf, Vec3f wo, Vec3f wi) {
  return std::visit([&](const auto& b) { return EvalPdf(b, wo, wi); }, bsdf);
}
inline std::optional<BsdfSample> Sample(const Bsdf& bsdf, Vec3f wo, float u_lobe, Vec2f u) {
  return std::visit([&](const auto& b) { return Sample(b, wo, u_lobe, u); }, bsdf);
}
inline bool IsDelta(const Bsdf& bsdf) {
  return std::visit([](const auto& b) { return IsDelta(b); }, bsdf);
}
/// For kinds that do not say.
template <typename X>
bool HasDelta(const X&) {
  return true;
}
inline bool HasDelta(const Bsdf& bsdf) {
  return std::visit([](const auto& b) { return HasDelta(b); }, bsdf);
}
/// Whether light may go on to the other side.
inline bool Transmits(const Bsdf& bsdf) {
  if (const auto* mixture = std::get_if<MixtureBsdf>(&bsdf)) return Transmits(*mixture);
  if (const auto* b = std::get_if<MetallicRoughnessBsdf>(&bsdf)) return !IsBlack(b->transmission);
  return std::holds_alternative<DielectricBsdf>(bsdf) ||
         std::holds_alternative<ThinDielectricBsdf>(bsdf) ||
         std::holds_alternative<DiffuseTransmissionBsdf>(bsdf) ||
         std::holds_alternative<PhaseFunction>(bsdf);
}
inline Rgb Albedo(const Bsdf& bsdf, Vec3f wo) {
  return std::visit([&](const auto& b) { return Albedo(b, wo); }, bsdf);
}

}  // namespace strata
