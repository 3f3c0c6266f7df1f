#include "worker/bsdf/coat.h"

namespace strata {
namespace {

/// The midpoint of cell `i` of `count` in [0, 1].
float Midpoint(int i, int count) {
  return (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
}

/// Directional albedo of GGX reflection with dielectric Fresnel, by a midpoint rule over the unit
/// square of visible normals, where the integrand is smooth.
float RoughAlbedo(float cos_theta, float alpha, float eta) {
  constexpr int kSteps = 24;
  const Ggx ggx = {alpha, alpha};
  const Vec3f wo = {std::sqrt(std::max(0.0f, 1 - cos_theta * cos_theta)), 0, cos_theta};
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      // Half a turn suffices by symmetry.
      const Vec3f m =
          ggx.SampleVisibleNormal(wo, {0.5f * Midpoint(i, kSteps), Midpoint(j, kSteps)});
      const float cos_m = std::clamp(Dot(wo, m), 0.0f, 1.0f);
      const Vec3f wi = Reflect(wo, m);
      if (wi.z > 0) sum += FresnelDielectric(cos_m, eta).reflectance * ggx.MaskingRatio(wo, wi);
    }
  }
  return static_cast<float>(sum / (kSteps * kSteps));
}

/// The cell of a table over [0, 1] with `count` nodes that holds x, and how far into it x lies.
struct Cell {
  int index;
  float fraction;
};
Cell FindCell(float x, int count) {
  const float scaled = std::clamp(x, 0.0f, 1.0f) * static_cast<float>(count - 1);
  const int index = std::min(static_cast<int>(scaled), count - 2);
  return {index, scaled - static_cast<float>(index)};
}
float Lerp(float a, float b, float t) { return a + (b - a) * t; }

/// Mean of a table row over the cosine-weighted hemisphere, exact for the interpolation between its
/// nodes in s = sqrt(cos): the integral of f 4 s^3 ds.
template <typename Row>
double CosineWeightedMean(const Row& row) {
  constexpr int kSteps = 16;
  const int cells = static_cast<int>(row.size()) - 1;
  double sum = 0;
  for (int i = 0; i < cells * kSteps; ++i) {
    const double s = (i + 0.5) / (cells * kSteps);
    const int cell = i / kSteps;
    const double t = s * cells - cell;
    sum += (row[cell] + (row[cell + 1] - row[cell]) * t) * 4 * s * s * s;
  }
  return sum / (cells * kSteps);
}

}  // namespace

CoatInterface::CoatInterface(float eta) : eta_(eta) {
  // Row 0 stands for alpha -> 0, whose albedo is the Fresnel reflectance itself.
  for (int a = 0; a < kAlphas; ++a) {
    const float root_alpha = static_cast<float>(a) / (kAlphas - 1);
    for (int c = 0; c < kCosines; ++c) {
      const float root_cos = static_cast<float>(c) / (kCosines - 1);
      const float cos_theta = root_cos * root_cos;
      reflectance_[a][c] = a == 0   ? FresnelDielectric(cos_theta, eta).reflectance
                           : c == 0 ? RoughAlbedo(1e-4f, root_alpha * root_alpha, eta)
                                    : RoughAlbedo(cos_theta, root_alpha * root_alpha, eta);
    }
    mean_[a] = static_cast<float>(CosineWeightedMean(reflectance_[a]));
  }
  // The smooth border is evaluated exactly, so its mean must not be that of the table.
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
  mean_[0] = static_cast<float>(mean);
  internal_path_ = internal > 0 ? static_cast<float>(internal_path / internal) : 1;
  escaping_path_ = static_cast<float>(escaping_path / escaping);
}

float CoatInterface::RoughReflectance(float cos_theta, float alpha) const {
  const Cell a = FindCell(std::sqrt(alpha), kAlphas);
  const Cell c = FindCell(std::sqrt(cos_theta), kCosines);
  const auto& row0 = reflectance_[a.index];
  const auto& row1 = reflectance_[a.index + 1];
  return Lerp(Lerp(row0[c.index], row0[c.index + 1], c.fraction),
              Lerp(row1[c.index], row1[c.index + 1], c.fraction), a.fraction);
}

float CoatInterface::MeanReflectance(float alpha) const {
  const Cell a = FindCell(std::sqrt(alpha), kAlphas);
  return Lerp(mean_[a.index], mean_[a.index + 1], a.fraction);
}

}  // namespace strata
