#include "worker/bsdf/mixture.h"

#include <algorithm>

#include "worker/bsdf/mixture_parts.h"
#include "worker/sampling/choose.h"

namespace strata {
namespace {

/// With what probability each part is sampled.
struct PartProbabilities {
  std::array<float, MixtureParts::kMax> p = {};
  float sum = 0;  ///< Of p, 0 if all parts are black: then they are nowhere sampled.

  PartProbabilities(const MixtureParts& parts, Vec3f wo) {
    for (int i = 0; i < parts.count; ++i) {
      p[i] = parts.weights[i] * MaxComponent(Albedo(parts.bsdfs[i], wo));
      sum += p[i];
    }
    if (!(sum > 0)) return;
    for (int i = 0; i < parts.count; ++i) p[i] /= sum;
  }
};

BsdfValue SumOf(const MixtureParts& parts, const PartProbabilities& probabilities, Vec3f wo,
                Vec3f wi) {
  BsdfValue sum;
  for (int i = 0; i < parts.count; ++i) {
    const BsdfValue part = EvalPdf(parts.bsdfs[i], wo, wi);
    sum.f += part.f * parts.weights[i];
    sum.pdf += part.pdf * probabilities.p[i];
  }
  return sum;
}

}  // namespace

// Not inlined: each of these holds all of the other BSDFs again.

[[gnu::noinline]] bool IsDelta(const MixtureBsdf& bsdf) {
  const MixtureParts& parts = *bsdf.parts;
  return std::all_of(parts.bsdfs.begin(), parts.bsdfs.begin() + parts.count,
                     [](const Bsdf& part) { return IsDelta(part); });
}

[[gnu::noinline]] bool Transmits(const MixtureBsdf& bsdf) {
  const MixtureParts& parts = *bsdf.parts;
  return std::any_of(parts.bsdfs.begin(), parts.bsdfs.begin() + parts.count,
                     [](const Bsdf& part) { return Transmits(part); });
}

[[gnu::noinline]] BsdfValue EvalPdf(const MixtureBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return SumOf(*bsdf.parts, PartProbabilities(*bsdf.parts, wo), wo, wi);
}
Rgb Eval(const MixtureBsdf& bsdf, Vec3f wo, Vec3f wi) { return EvalPdf(bsdf, wo, wi).f; }
float Pdf(const MixtureBsdf& bsdf, Vec3f wo, Vec3f wi) { return EvalPdf(bsdf, wo, wi).pdf; }

[[gnu::noinline]] std::optional<BsdfSample> Sample(const MixtureBsdf& bsdf, Vec3f wo, float u_lobe,
                                                   Vec2f u) {
  const MixtureParts& parts = *bsdf.parts;
  const PartProbabilities probabilities(parts, wo);
  if (!(probabilities.sum > 0)) return std::nullopt;
  int chosen = 0;
  for (int i = 0; i < parts.count; ++i) {
    if (!(probabilities.p[i] > 0)) continue;
    chosen = i;
    if (u_lobe < probabilities.p[i]) break;
    // Past the last part by rounding, the last that may be chosen is.
    u_lobe -= probabilities.p[i];
  }
  const float p = probabilities.p[chosen];
  // What is left of the number serves the part's own lobes.
  std::optional<BsdfSample> sample =
      Sample(parts.bsdfs[chosen], wo, std::clamp(u_lobe / p, 0.0f, kBelowOne), u);
  if (!sample) return std::nullopt;
  if (sample->delta) {
    sample->weight *= parts.weights[chosen] / p;
    sample->pdf *= p;
    return sample;
  }
  const BsdfValue all = SumOf(parts, probabilities, wo, sample->wi);
  if (!(all.pdf > 0)) return std::nullopt;
  sample->weight = all.f / all.pdf;
  sample->pdf = all.pdf;
  return sample;
}

[[gnu::noinline]] Rgb Albedo(const MixtureBsdf& bsdf, Vec3f wo) {
  Rgb sum;
  for (int i = 0; i < bsdf.parts->count; ++i)
    sum += Albedo(bsdf.parts->bsdfs[i], wo) * bsdf.parts->weights[i];
  return sum;
}

}  // namespace strata
