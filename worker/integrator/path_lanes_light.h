#pragma once

#include "worker/integrator/path_lanes.h"

// The lights' part of PathLanes: light that vertices sample, and the shadow rays to it. Included by
// path_lanes.h alone.

namespace strata {

template <typename Sampler, uint32_t kHas>
inline MaskLanes PathLanes<Sampler, kHas>::SampleLights(MaskLanes mask) {
  const LightSet& lights = scene_.lights();
  root_sum_ = FloatLanes{};
  if (lights.empty()) return MaskLanes{};
  mask &= ~Glass(mask);
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
    root_sum_ = choice.root_sum;
    u.x = choice.u;
    mask &= probability > 0;
  }
  lights.Sample(light, surface_.p, u, mask, &light_);
  light_.pdf = light_.pdf * probability;
  return mask & light_.valid;
}

template <typename Sampler, uint32_t kHas>
inline MaskLanes PathLanes<Sampler, kHas>::AddDirectLight(MaskLanes mask) {
  if (!Any(mask)) return mask;
  const LightSampleLanes& sample = light_;
  const FloatLanes wi_z = Dot(sample.wi, frame_.z);
  mask &= SidesAgree(sample.wi, wi_z);
  FloatLanes bsdf_pdf = wo_z_ * wi_z > 0 ? kInvPi * Abs(wi_z) : FloatLanes{};
  RgbLanes f = reflectance_ * bsdf_pdf;
  if (const MaskLanes coated = Coated(mask); Any(coated)) {
    const BsdfValueLanes value = coat_.EvalPdf(frame_.ToLocal(sample.wi));
    f = Select(coated, value.f, f);
    bsdf_pdf = coated ? value.pdf : bsdf_pdf;
  }
  if (const MaskLanes others = OtherMaterials(mask); Any(others)) {
    const Vec3Lanes wi = frame_.ToLocal(sample.wi);
    ForEachLane(others, [&](int lane) {
      const BsdfValue value = ValueOf(lane, wi.Get(lane));
      f.Set(lane, value.f);
      bsdf_pdf[lane] = value.pdf;
    });
  }
  mask &= ~IsBlack(f);
  if (!Any(mask)) return mask;
  ForEachLane(Guided(mask), [&](int lane) {
    bsdf_pdf[lane] = guides_[lane].MixedPdf(bsdf_pdf[lane], sample.wi.Get(lane));
  });
  const FloatLanes weight = sample.delta ? SameFloat(1) : PowerHeuristic(sample.pdf, bsdf_pdf);
  ShadowQueue::Lanes& shadow = shadow_;
  shadow.contribution = beta_ * f * sample.radiance * (weight / sample.pdf);
  mask = ShadowRoulette(mask, &shadow.contribution);
  if (!Any(mask)) return mask;
  shadow_rays_ -= mask;  // Masks are -1.
  if (HasAlpha()) {
    const Vec2Lanes u = Get2D(kPairLight, mask);
    ForEachLane(mask, [&](int lane) {
      shadow.rays.id[lane] = static_cast<int32_t>(path_detail::RayId({u.x[lane], u.y[lane]}, true));
    });
  }
  shadow.rays.origin = OffsetRayOrigins(surface_.p, surface_.offset, surface_.ng, sample.wi);
  shadow.rays.direction = Select(sample.infinite, sample.wi, sample.end - shadow.rays.origin);
  shadow.rays.time = ray_.time;
  shadow.rays.t_max = sample.infinite ? SameFloat(std::numeric_limits<float>::infinity())
                                      : SameFloat(path_detail::kShadowEnd);
  if (HasMedia()) shadow.medium = MediumTowards(sample.wi, mask);
  return mask;
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::PushShadows(const PathBatch& batch, MaskLanes mask,
                                                  MaskLanes ended) {
  shadow_.path = batch.ids;
  shadow_.last = ended;
  if (shadows_.size() == 0) waiting_since_ = to_trace_.pushed();
  ShadowQueue::Lanes full;
  if (!shadows_.Push(shadow_, mask, &full)) return;
  // What is left is of this batch.
  waiting_since_ = to_trace_.pushed();
  Connect(full, FirstLanes(kLanes));
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::Connect(const ShadowQueue::Lanes& shadows, MaskLanes mask) {
  const MaskLanes seen = mask & ~Occluded(scene_.geometry(), shadows.rays, mask);
  const PathBatch batch(shadows.path, mask);
  RgbLanes contribution = shadows.contribution;
  if (HasMedia()) Fade(shadows, seen, &contribution);
  const RowLanes radiance = states_.Load(offsetof(PathState, radiance), batch);
  const RgbLanes sum = Select(seen, ColorOf(radiance) + contribution, ColorOf(radiance));
  states_.Store(offsetof(PathState, radiance), batch, RowsOf(sum, radiance.v[3]));
  finished_.Push(batch.ids, mask & shadows.last);
}

template <typename Sampler, uint32_t kHas>
void PathLanes<Sampler, kHas>::Fade(const ShadowQueue::Lanes& shadows, MaskLanes mask,
                                    RgbLanes* contribution) const {
  if (!scene_.media().borders()) mask &= shadows.medium != kNoMedium;
  if (!Any(mask)) return;
  if (scene_.media().only_absorbs()) {
    const MaskLanes finite = shadows.rays.t_max == path_detail::kShadowEnd;
    const FloatLanes length =
        finite ? Sqrt(LengthSquared(shadows.rays.direction)) : shadows.rays.t_max;
    *contribution =
        Select(mask, *contribution * scene_.media().Absorption(shadows.medium, length, mask),
               *contribution);
    return;
  }
  ForEachLane(mask, [&](int lane) {
    Ray way = shadows.rays.Get(lane);
    if (way.t_max == path_detail::kShadowEnd) way.t_max = 1;
    const Rgb transmittance = scene_.media().Transmittance(way, shadows.medium[lane]);
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
