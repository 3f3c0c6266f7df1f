#include "worker/bsdf/coat.h"

#include "worker/bsdf/visible_normals.h"

namespace strata {

CoatInterface::CoatInterface(float eta)
    : eta_(eta), reflectance_([&](float cos_theta, float alpha) {
        if (alpha == 0) return FresnelDielectric(cos_theta, eta).reflectance;
        return MeanOverVisibleNormals(cos_theta, alpha, 24, [&](float cos_m, Vec3f) {
          return FresnelDielectric(cos_m, eta).reflectance;
        });
      }) {
  constexpr int kSteps = 4096;
  double mean = 0, internal = 0, internal_path = 0, escaping = 0, escaping_path = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double cos_theta = (i + 0.5) / kSteps;
    mean +=
        2 * cos_theta * FresnelDielectric(static_cast<float>(cos_theta), eta).reflectance / kSteps;
    const double returned = FresnelDielectric(static_cast<float>(cos_theta), 1 / eta).reflectance;
    internal += cos_theta * returned;
    internal_path += returned;
    escaping += cos_theta * (1 - returned);
    escaping_path += 1 - returned;
  }
  smooth_mean_ = static_cast<float>(mean);
  internal_path_ = internal > 0 ? static_cast<float>(internal_path / internal) : 1;
  escaping_path_ = static_cast<float>(escaping_path / escaping);
}

AlbedoTable TabulateTrappedLight(float eta) {
  return AlbedoTable([&](float cos_theta, float alpha) {
    const DielectricFresnel o = FresnelDielectric(cos_theta, eta);
    if (alpha == 0) return 0.0f;
    const float escaped =
        MeanOverVisibleNormals(o.cos_refracted, alpha, 48, [&](float, Vec3f inner) {
          const DielectricFresnel i = FresnelDielectric(inner.z, 1 / eta);
          return (1 - i.reflectance) / (1 - std::min(o.reflectance, i.reflectance));
        });
    return std::max(0.0f, 1 - escaped);
  });
}

}  // namespace strata
