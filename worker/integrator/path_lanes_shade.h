#pragma once

#include "worker/integrator/path_lanes.h"

// The part of PathLanes that scatters light at vertices. Included by path_lanes.h alone.

namespace strata {

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::Shade(const PathBatch& batch) {
  batch_ = &batch;
  sampler_.Choose(batch.path);
  Load(batch);
  const MaskLanes last = depth_ == settings_.max_depth;
  MaskLanes going = batch.mask, connected = {};
  FindBsdfs(going);
  // The choice of a light takes half of it, roulette the other.
  u_select_ = Get2D(kPairSelect, going);
  const MaskLanes lit = SampleLights(going & ~last);
  MakeBases(going);
  going &= ~last;
  if (Any(going)) {
    StartGuides(going);
    connected = AddDirectLight(lit);
    going = Scatter(going);
    going = SurviveRoulette(going);
  }
  depth_ = going ? depth_ + 1 : depth_;
  Save(batch);
  const MaskLanes ended = batch.mask & ~going;
  finished_.Push(batch.ids, ended & ~connected);
  if (Any(connected)) PushShadows(batch, connected, ended);
  to_trace_.Push(batch.ids, going);
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::Load(const PathBatch& batch) {
  const RowLanes direction = states_.Load(offsetof(PathState, direction), batch),
                 beta = states_.Load(offsetof(PathState, beta), batch),
                 radiance = states_.Load(offsetof(PathState, radiance), batch),
                 scalars = states_.Load(offsetof(PathState, bsdf_pdf), batch),
                 p = states_.Load(offsetof(PathState, p), batch),
                 ng = states_.Load(offsetof(PathState, ng), batch);
  ray_.direction = VectorOf(direction);
  ray_.time = direction.v[3];
  beta_ = ColorOf(beta);
  eta_scale_ = beta.v[3];
  radiance_ = ColorOf(radiance);
  to_lamp_ = (AsInts(radiance.v[3]) & PathState::kToLamp) != 0;
  depth_ = AsInts(scalars.v[1]);
  shadow_rays_ = AsInts(scalars.v[2]);
  sure_survival_ = scalars.v[3];
  surface_.p = VectorOf(p);
  surface_.offset = p.v[3];
  surface_.ng = VectorOf(ng);
  surface_.material = AsInts(ng.v[3]);
  surface_.ns = VectorOf(states_.Load(offsetof(PathState, n), batch));
  if (!HasMedia() && !HasBaseTextures()) return;
  const RowLanes uv = states_.Load(offsetof(PathState, uv), batch);
  surface_.uv = {uv.v[0], uv.v[1]};
  medium_ = AsInts(uv.v[2]);
  in_medium_ = AsInts(uv.v[3]);
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::Save(const PathBatch& batch) {
  IntLanes flags = (specular_ & PathState::kSpecular) |
                   (receiver_.one_sided & PathState::kOneSided) |
                   (receiver_.in_medium & PathState::kInMedium);
  if (HasLampImages()) flags |= to_lamp_ & PathState::kToLamp;
  states_.Store(offsetof(PathState, origin), batch, RowsOf(ray_.origin, AsFloats(ray_.id)));
  states_.Store(offsetof(PathState, direction), batch, RowsOf(ray_.direction, ray_.time));
  states_.Store(offsetof(PathState, beta), batch, RowsOf(beta_, eta_scale_));
  states_.Store(offsetof(PathState, radiance), batch, RowsOf(radiance_, AsFloats(flags)));
  states_.Store(offsetof(PathState, bsdf_pdf), batch,
                {{bsdf_pdf_, AsFloats(depth_), AsFloats(shadow_rays_), sure_survival_}});
  states_.Store(offsetof(PathState, n), batch, RowsOf(receiver_.n, root_sum_));
  if (HasMedia())
    states_.Store(offsetof(PathState, uv), batch,
                  {{FloatLanes{}, FloatLanes{}, AsFloats(medium_), FloatLanes{}}});
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::FindBsdfs(MaskLanes mask) {
  const Vec3Lanes wo = -ray_.direction;
  const FloatLanes along_ns = Dot(wo, surface_.ns), along_ng = Dot(wo, surface_.ng);
  const MaskLanes seen = along_ns * along_ng > 0;
  frame_ = FrameLanes::FromNormal(Select(seen, surface_.ns, surface_.ng));
  wo_z_ = seen ? along_ns : along_ng;
  const BaseLanes bases =
      FindBases(scene_.materials(), scene_.textures(), surface_, mask & ~InMedium(mask),
                {.coats = HasCoats(), .textures = HasBaseTextures()}, &textured_);
  reflectance_ = bases.reflectance;
  lambertian_ = bases.bare;
  coated_ = bases.coated;
  glass_ = bases.glass;
  receiver_.one_sided = mask & ~Glass(mask);
  receiver_.in_medium = InMedium(mask);
  if (const MaskLanes others = OtherMaterials(mask); Any(others)) {
    ForEachLane(others, [&](int lane) {
      bsdf_[lane] = &BsdfOf(lane, wo.Get(lane));
      if (Transmits(*bsdf_[lane])) receiver_.one_sided[lane] = 0;
    });
    wo_z_ = Dot(wo, frame_.z);
  }
  if (Any(OtherMaterials(mask) | Coated(mask) | Glass(mask))) wo_ = frame_.ToLocal(wo);
  receiver_.p = surface_.p;
  receiver_.n = Select(wo_z_ < 0, -frame_.z, frame_.z);
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::MakeBases(MaskLanes mask) {
  if (HasBaseTextures())
    reflectance_ = FinishReflectances(textured_, scene_.textures(), surface_.p, reflectance_);
  ForEachLane(OtherMaterials(mask), [&](int lane) {
    const auto* diffuse = std::get_if<DiffuseBsdf>(bsdf_[lane]);
    if (!diffuse) return;
    lambertian_[lane] = -1;
    reflectance_.Set(lane, diffuse->reflectance);
  });
  if (Any(Coated(mask)))
    coat_ = CoatedDiffuseLanes(scene_.materials().base_rows().data(), surface_.material,
                               reflectance_, wo_, coated_);
  if (settings_.first_hit)
    ForEachLane(mask & (depth_ == 0) & ~InMedium(mask), [&](int lane) { DescribeFirstHit(lane); });
}

template <typename Sampler, uint32_t kHas>
const Bsdf& PathLanes<Sampler, kHas>::BsdfOf(int lane, Vec3f wo) {
  if (HasMedia() && in_medium_[lane]) return scene_.media().phase(medium_[lane]);
  const MaterialSet& materials = scene_.materials();
  const MaterialId id = surface_.material[lane];
  const Bsdf* constant = materials.Constant(id);
  const bool plain = materials.HasPlainFrame(id);
  if (constant && plain) return *constant;
  const Ray ray = RayTo(batch_->path.at[lane]);
  const Hit& hit = vertex_hits_[batch_->path.at[lane]];
  const SurfacePoint point = scene_.geometry().Surface(ray, hit);
  const auto u_mix = [&] {
    MaskLanes only = {};
    only[lane] = -1;
    return Get2D(kPairLobe, only).y[lane];
  };
  if (materials.HasDetail(id)) {
    const SurfaceDerivatives derivatives = scene_.geometry().Derivatives(ray, hit);
    const SurfacePoint turned = materials.WithDetail(point, derivatives, wo, u_mix());
    frame_.Set(lane, path_detail::ShadingFrame(turned, wo, false));
  } else if (!plain) {
    frame_.Set(lane, path_detail::ShadingFrame(point, wo, false));
  }
  if (constant) return *constant;
  return materials.Evaluate(id, point.TextureUv(), point.p, u_mix(), &varying_[lane]);
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::DescribeFirstHit(int lane) {
  PathSample& sample = first_hit_[batch_->path.at[lane]];
  sample.hit = true;
  sample.normal = frame_.z.Get(lane);
  sample.position = surface_.p.Get(lane);
  if (!settings_.albedo) return;
  sample.albedo = lambertian_[lane] ? reflectance_.Get(lane)
                  : coated_[lane]   ? coat_.Albedo().Get(lane)
                  : glass_[lane]    ? Albedo(DielectricBsdf(), wo_.Get(lane))
                                    : Albedo(*bsdf_[lane], wo_.Get(lane));
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::StartGuides(MaskLanes mask) {
  if (!HasLampImages()) return;
  const LampImages& images = scene_.lamp_images();
  guided_ = MaskLanes{};
  ForEachLane(mask & (depth_ + 1 < settings_.max_depth), [&](int lane) {
    if (!lambertian_[lane] && !IsWorthGuiding(*bsdf_[lane])) return;
    guides_[lane].Start(images, receiver_.Get(lane),
                        HasMedia() ? scene_.media().HazeOf(medium_[lane]) : Haze());
    guided_[lane] = guides_[lane].share() > 0 ? -1 : 0;
  });
}

template <typename Sampler, uint32_t kHas>
inline MaskLanes PathLanes<Sampler, kHas>::Scatter(MaskLanes mask) {
  const Vec2Lanes u = Get2D(kPairBsdf, mask);
  const Vec3Lanes cosine_wi = SampleCosineHemisphere(u);
  Vec3Lanes wi = cosine_wi;
  RgbLanes weight = reflectance_;
  specular_ = MaskLanes{};
  const MaskLanes was_to_lamp = to_lamp_;
  to_lamp_ = MaskLanes{};
  bsdf_pdf_ = Max(FloatLanes{}, wi.z) * kInvPi;
  wi.z = wo_z_ < 0 ? -wi.z : wi.z;
  const MaskLanes others = OtherMaterials(mask) | Guided(mask);
  MaskLanes going = mask & (others | ((wo_z_ * wi.z > 0) & ~IsBlack(reflectance_)));
  const MaskLanes coated = Coated(mask);
  FloatLanes u_lobe = {};
  const MaskLanes glass = Glass(mask);
  if (Any(others | coated | glass)) u_lobe = Get2D(kPairLobe, others | coated | glass).x;
  if (Any(coated)) {
    const BsdfSampleLanes sample = coat_.Sample(u_lobe, u, cosine_wi);
    wi = Select(coated, sample.wi, wi);
    weight = Select(coated, sample.weight, weight);
    specular_ = coated & sample.delta;
    bsdf_pdf_ = coated ? sample.pdf : bsdf_pdf_;
    going = (going & ~coated) | (coated & sample.valid & ~IsBlack(sample.weight));
  }
  if (Any(glass)) {
    const SmoothDielectricSampleLanes sample =
        SampleSmoothDielectric(GlassEta(scene_.materials(), surface_.material, glass), wo_, u_lobe);
    wi = Select(glass, sample.wi, wi);
    weight = Select(glass, sample.weight, weight);
    specular_ |= glass;
    bsdf_pdf_ = glass ? sample.pdf : bsdf_pdf_;
    eta_scale_ = glass ? eta_scale_ * sample.eta2 : eta_scale_;
    going = (going & ~glass) | (glass & sample.valid);
  }
  if (Any(others)) {
    ForEachLane(others, [&](int lane) {
      const std::optional<BsdfSample> sample = SampleOf(lane, u_lobe[lane], {u.x[lane], u.y[lane]});
      if (!sample || IsBlack(sample->weight)) {
        going[lane] = 0;
        return;
      }
      wi.Set(lane, sample->wi);
      weight.Set(lane, sample->weight);
      specular_[lane] = sample->delta ? -1 : 0;
      bsdf_pdf_[lane] = sample->pdf;
      if (sample->transmission) eta_scale_[lane] *= sample->eta * sample->eta;
      if (HasLampImages())
        to_lamp_[lane] = sample->to_lamp || (was_to_lamp[lane] && sample->delta) ? -1 : 0;
    });
  }
  beta_ = Select(going, beta_ * weight, beta_);
  ray_.direction = frame_.ToWorld(wi);
  ray_.origin = OffsetRayOrigins(surface_.p, surface_.offset, surface_.ng, ray_.direction);
  if (HasAlpha())
    ForEachLane(going, [&](int lane) {
      ray_.id[lane] = static_cast<int32_t>(path_detail::RayId({u.x[lane], u.y[lane]}, false));
    });
  if (HasMedia()) medium_ = MediumTowards(ray_.direction, going);
  return going & SidesAgree(ray_.direction, wi.z);
}

template <typename Sampler, uint32_t kHas>
std::optional<BsdfSample> PathLanes<Sampler, kHas>::SampleOf(int lane, float u_lobe,
                                                             Vec2f u) const {
  if (!guided_[lane]) return Sample(*bsdf_[lane], wo_.Get(lane), u_lobe, u);
  const Frame frame = frame_.Get(lane);
  if (!lambertian_[lane])
    return SampleGuided(*bsdf_[lane], frame, wo_.Get(lane), guides_[lane], u_lobe, u);
  const DiffuseBsdf diffuse = {reflectance_.Get(lane)};
  return SampleGuided(diffuse, frame, {0, 0, wo_z_[lane]}, guides_[lane], u_lobe, u);
}

template <typename Sampler, uint32_t kHas>
inline MaskLanes PathLanes<Sampler, kHas>::SurviveRoulette(MaskLanes mask) {
  const FloatLanes throughput = MaxComponent(beta_) * eta_scale_;
  MaskLanes plays = mask & (depth_ >= 1) & (throughput < sure_survival_);
  if (HasLampImages()) plays &= ~to_lamp_;
  if (!Any(plays)) return mask;
  const FloatLanes survival = SurvivalProbability(throughput, sure_survival_);
  const MaskLanes survives = u_select_.y < survival;
  beta_ = Select(plays, beta_ * (1 / survival), beta_);
  return mask & (~plays | survives);
}

}  // namespace strata
