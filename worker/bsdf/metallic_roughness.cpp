#include "worker/bsdf/metallic_roughness.h"

#include "worker/bsdf/visible_normals.h"

namespace strata {
namespace {

constexpr int kAlbedoSteps = 32;
/// Of the tables' nodes the first above 0.
constexpr float kFirstAlpha = 1 / 256.0f;

/// Of microfacets that reflect `weight(s)` at Schlick's s.
template <typename Weight>
AlbedoTable TabulateSchlick(const Weight& weight) {
  return AlbedoTable([&](float cos_theta, float alpha) {
    if (alpha == 0) return weight(MetallicRoughnessBsdf::Grazing(cos_theta));
    return MeanOverVisibleNormals(cos_theta, alpha, kAlbedoSteps, [&](float cos_m, Vec3f) {
      return weight(MetallicRoughnessBsdf::Grazing(cos_m));
    });
  });
}

}  // namespace

SchlickAlbedo::SchlickAlbedo()
    : normal_(TabulateSchlick([](float s) { return 1 - s; })),
      grazing_(TabulateSchlick([](float s) { return s; })) {}

SchlickAlbedo::Split SchlickAlbedo::At(const Ggx& ggx, float cos_theta) const {
  const float grazing = MetallicRoughnessBsdf::Grazing(cos_theta);
  const Split smooth = {1 - grazing, grazing};
  if (ggx.IsSmooth()) return smooth;
  const float alpha = std::max(ggx.alpha_x, kFirstAlpha);
  const Split rough = {normal_.At(cos_theta, alpha), grazing_.At(cos_theta, alpha)};
  if (ggx.alpha_x >= kFirstAlpha) return rough;
  // What small roughness changes goes with its square; the table's interpolation would change 2 %
  // too much at grazing angles, and give energy.
  const float relative = ggx.alpha_x / kFirstAlpha, t = relative * relative;
  return {smooth.normal + (rough.normal - smooth.normal) * t,
          smooth.grazing + (rough.grazing - smooth.grazing) * t};
}

SchlickAlbedo::Split SchlickAlbedo::Mean(const Ggx& ggx) const {
  // The mean of (1 - c)^5 over 2 c dc is 2 / 42.
  if (ggx.IsSmooth()) return {1 - 1 / 21.0f, 1 / 21.0f};
  return {normal_.Mean(ggx.alpha_x), grazing_.Mean(ggx.alpha_x)};
}

}  // namespace strata
