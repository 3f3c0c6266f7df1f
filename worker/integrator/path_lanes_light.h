#pragma once

#include "worker/integrator/path_lanes.h"

// The lights' part of PathLanes: emission that rays meet, and light that vertices sample. Included
// by path_lanes.h alone.

namespace strata {

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::AddEnvironment(int lane) {
  const LightSet& lights = scene_.lights();
  const Vec3f origin = ray_.origin.Get(lane), direction = ray_.direction.Get(lane);
  for (uint32_t light : lights.environments()) {
    const float weight = EmissionWeight(
        lane, [&] { return lights.EnvironmentPdf(light, previous_.p.Get(lane), direction); });
    AddRadiance(lane, lights.EnvironmentLe(light, origin, direction), weight);
  }
}

template <typename Sampler, uint32_t kHas>
void PathLanes<Sampler, kHas>::AddEmission(int lane) {
  const LightSet& lights = scene_.lights();
  const uint32_t surface = static_cast<uint32_t>(surface_.light[lane]);
  const Vec3f direction = ray_.direction.Get(lane), ng = surface_.ng.Get(lane);
  const Rgb radiance = lights.SurfaceLe(surface, ng, -direction, [&] {
    return scene_.geometry().Surface(ray_.Get(lane), hits_.Get(lane));
  });
  if (IsBlack(radiance)) return;
  const float weight = EmissionWeight(lane, [&] {
    return lights.SurfacePdf(surface, previous_.Get(lane),
                             {surface_.p.Get(lane), ng, direction, hits_.t[lane]});
  });
  AddRadiance(lane, radiance, weight);
}

template <typename Sampler, uint32_t kHas>
inline MaskLanes PathLanes<Sampler, kHas>::SampleLights(MaskLanes mask) {
  const LightSet& lights = scene_.lights();
  if (lights.empty()) return MaskLanes{};
  ForEachLane(OtherMaterials(mask), [&](int lane) {
    if (IsDelta(*bsdf_[lane])) mask[lane] = 0;
  });
  if (!Any(mask)) return mask;
  Vec2Lanes u = Get2D(kPairLight, mask);
  IntLanes light = {};
  FloatLanes probability = SameFloat(1);
  if (ChoosesLights()) {
    const LightSet::ChoiceLanes choice = lights.Select(receiver_, {u.x, u_select_.x}, mask);
    light = choice.light;
    probability = choice.probability;
    u.x = choice.u;
    mask &= probability > 0;
  }
  lights.Sample(light, surface_.p, u, mask, &light_);
  light_.pdf = light_.pdf * probability;
  return mask & light_.valid;
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::AddDirectLight(MaskLanes mask) {
  if (!Any(mask)) return;
  const LightSampleLanes& sample = light_;
  const FloatLanes wi_z = Dot(sample.wi, frame_.z);
  mask &= SidesAgree(sample.wi, wi_z);
  FloatLanes bsdf_pdf = wo_z_ * wi_z > 0 ? kInvPi * Abs(wi_z) : FloatLanes{};
  RgbLanes f = reflectance_ * bsdf_pdf;
  const Vec3Lanes wi = {Dot(sample.wi, frame_.x), Dot(sample.wi, frame_.y), wi_z};
  if (const MaskLanes coated = Coated(mask); Any(coated)) {
    const BsdfValueLanes value = coat_.EvalPdf(wi);
    f = Select(coated, value.f, f);
    bsdf_pdf = coated ? value.pdf : bsdf_pdf;
  }
  ForEachLane(OtherMaterials(mask), [&](int lane) {
    const BsdfValue value = ValueOf(lane, wi.Get(lane));
    f.Set(lane, value.f);
    bsdf_pdf[lane] = value.pdf;
  });
  mask &= ~IsBlack(f);
  if (!Any(mask)) return;
  ForEachLane(Guided(mask), [&](int lane) {
    bsdf_pdf[lane] = guides_[lane].MixedPdf(bsdf_pdf[lane], sample.wi.Get(lane));
  });
  const FloatLanes weight = sample.delta ? SameFloat(1) : PowerHeuristic(sample.pdf, bsdf_pdf);
  RgbLanes contribution = beta_ * f * sample.radiance * (weight / sample.pdf);
  mask = ShadowRoulette(mask, &contribution);
  if (!Any(mask)) return;
  rays_ -= mask;
  RayLanes shadow;
  if (HasAlpha()) SetRayIds(&shadow, Get2D(kPairLight, mask), true, mask);
  shadow.origin = OffsetRayOrigins(surface_.p, surface_.offset, surface_.ng, sample.wi);
  shadow.direction = Select(sample.infinite, sample.wi, sample.end - shadow.origin);
  shadow.time = ray_.time;
  shadow.t_max = sample.infinite ? shadow.t_max : SameFloat(path_detail::kShadowEnd);
  mask &= ~Occluded(scene_.geometry(), shadow, mask);
  if (HasMedia()) {
    shadow.t_max = sample.infinite ? shadow.t_max : SameFloat(1);
    Fade(shadow, sample.wi, mask, &contribution);
  }
  radiance_ = Select(mask, radiance_ + contribution, radiance_);
}

template <typename Sampler, uint32_t kHas>
void PathLanes<Sampler, kHas>::Fade(const RayLanes& shadow, const Vec3Lanes& wi, MaskLanes mask,
                                    RgbLanes* contribution) const {
  if (!scene_.media().borders()) mask &= (medium_ != kNoMedium) | AtBorder();
  ForEachLane(mask, [&](int lane) {
    const MediumId medium = MediumTowards(lane, wi.Get(lane));
    if (scene_.media().IsOutside(medium)) return;
    const Rgb transmittance = scene_.media().Transmittance(shadow.Get(lane), medium);
    contribution->Set(lane, contribution->Get(lane) * transmittance);
  });
}

template <typename Sampler, uint32_t kHas>
inline MaskLanes PathLanes<Sampler, kHas>::ShadowRoulette(MaskLanes mask,
                                                          RgbLanes* contribution) const {
  const FloatLanes sure = settings_.sure_shadow * MaxComponent(radiance_);
  const FloatLanes most = MaxComponent(*contribution);
  const MaskLanes plays = mask & (most < sure);
  if (!Any(plays)) return mask;
  const FloatLanes survival = SurvivalProbability(most, sure);
  *contribution = Select(plays, *contribution * (1 / survival), *contribution);
  return mask & (~plays | (1 - u_select_.y < survival));
}

}  // namespace strata
