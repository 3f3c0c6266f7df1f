#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/unit.h"
#include "worker/bsdf/base_lanes.h"
#include "worker/bsdf/coated_diffuse_lanes.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/integrator/path.h"
#include "worker/sampling/sampler_lanes.h"

namespace strata {

/// The fast kernel: eight paths side by side, a path in each lane. When one ends, its
/// lane begins the next. What most vertices have in common (rays, triangles, Lambert's reflection
/// and coats over it, lights, random numbers) is done for all lanes at once, the rest lane by lane
/// with the code of PathTracer, of which this is another form: the same estimator from the same
/// random numbers.
///
/// kHas are Features: a superset of the scene's.
template <typename Sampler, uint32_t kHas>
class PathLanes {
  static_assert(!(kHas & kMedia) || (kHas & kOtherMaterials), "phase functions are others");

 public:
  PathLanes(const Scene& scene, const PathSettings& settings)
      : scene_(scene), settings_(settings), sure_survival_(SameFloat(settings.sure_survival)) {}

  /// For a lane whose sample is of a pixel with another PathSettings::sure_survival.
  void SetSureSurvival(int lane, float sure) { sure_survival_[lane] = sure; }

  /// Traces samples until there are no more. `next(lane, samplers)` starts the next one in a lane
  /// of the samplers, or is false at the end; `rays(get, mask)` gives camera rays, whose
  /// random numbers are get(pair); `store(lane, sample)` takes what a lane has found, before it
  /// starts another.
  template <typename Next, typename CameraRays, typename Store>
  void Trace(Next next, CameraRays rays, Store store) {
    MaskLanes alive = {};
    while (true) {
      MaskLanes starting = {};
      ForEachLane(~alive, [&](int lane) { starting[lane] = next(lane, sampler_) ? -1 : 0; });
      if (Any(starting)) Start(starting, rays);
      alive |= starting;
      if (!Any(alive)) return;
      const MaskLanes ended = Step(alive);
      ForEachLane(ended, [&](int lane) { store(lane, Result(lane)); });
      alive &= ~ended;
    }
  }

 private:
  template <typename CameraRays>
  void Start(MaskLanes starting, CameraRays rays) {
    const RayLanes camera = rays(
        [&](SamplePair pair) {
          return sampler_.Get2D(SameInt(static_cast<int32_t>(pair)), starting);
        },
        starting);
    ray_.origin = Select(starting, camera.origin, ray_.origin);
    ray_.direction = Select(starting, camera.direction, ray_.direction);
    ray_.time = starting ? camera.time : ray_.time;
    const FloatLanes one = SameFloat(1);
    beta_ = Select(starting, {one, one, one}, beta_);
    radiance_ = Select(starting, {}, radiance_);
    eta_scale_ = starting ? one : eta_scale_;
    specular_ |= starting;
    to_lamp_ &= ~starting;
    depth_ = starting ? IntLanes{} : depth_;
    rays_ = starting ? IntLanes{} : rays_;
    if (HasMedia()) medium_ = starting ? SameInt(scene_.media().camera_medium()) : medium_;
    if (settings_.first_hit) ForEachLane(starting, [&](int lane) { first_hit_[lane] = {}; });
    if (HasAlpha()) SetRayIds(&ray_, sampler_.Get2D(SameInt(kPairFilm), starting), false, starting);
  }

  // What the scene may need of this kernel, and whether it does.
  bool HasAlpha() const { return (kHas & kAlphaMasks) && scene_.geometry().has_alpha(); }
  bool HasEnvironments() const {
    return (kHas & kEnvironments) && !scene_.lights().environments().empty();
  }
  bool HasBaseTextures() const {
    return (kHas & kOtherMaterials) && scene_.materials().has_base_textures();
  }
  /// Whether coats are looked for: guides ask for the BSDF itself.
  bool HasCoats() const { return (kHas & kOtherMaterials) && !HasLampImages(); }
  bool HasLampImages() const { return (kHas & kLampImages) && !scene_.lamp_images().empty(); }
  bool HasMedia() const { return (kHas & kMedia) && !scene_.media().empty(); }
  bool ChoosesLights() const {
    return (kHas & kManyLights) && scene_.lights().SelectNeedsLowBits();
  }
  /// The lanes in `mask` whose BSDFs are neither Lambert's nor have a coat over that.
  MaskLanes OtherMaterials(MaskLanes mask) const {
    if constexpr ((kHas & kOtherMaterials) == 0) return MaskLanes{};
    return mask & ~(lambertian_ | coated_);
  }
  MaskLanes Coated(MaskLanes mask) const {
    if constexpr ((kHas & kOtherMaterials) == 0) return MaskLanes{};
    return mask & coated_;
  }
  MaskLanes Guided(MaskLanes mask) const {
    if constexpr ((kHas & kLampImages) == 0) return MaskLanes{};
    return mask & guided_;
  }

  /// The lanes in `mask` whose vertices are points of a medium.
  MaskLanes InMedium(MaskLanes mask) const {
    if constexpr ((kHas & kMedia) == 0) return MaskLanes{};
    return mask & in_medium_;
  }

  static void SetRayIds(RayLanes* rays, Vec2Lanes u, bool shadow, MaskLanes mask) {
    ForEachLane(mask, [&](int lane) {
      rays->id[lane] = static_cast<int32_t>(path_detail::RayId({u.x[lane], u.y[lane]}, shadow));
    });
  }

  PathSample Result(int lane) const {
    PathSample sample = first_hit_[lane];
    sample.radiance = radiance_.Get(lane);
    sample.rays = static_cast<uint32_t>(rays_[lane]);
    const Rgb beta = beta_.Get(lane);
    if (!IsFinite(beta)) sample.radiance += beta;
    return sample;
  }

  Vec2Lanes Get2D(BouncePair pair, MaskLanes mask) const {
    constexpr int32_t kPerBounce = kPairsPerBounce, kFirst = kPairFirstBounce;
    return sampler_.Get2D(depth_ * kPerBounce + (kFirst + static_cast<int32_t>(pair)), mask);
  }

  /// The next vertex of the paths in `alive`; returns those that end there.
  MaskLanes Step(MaskLanes alive) {
    rays_ -= alive;  // Masks are -1.
    const MaskLanes met = Intersect(scene_.geometry(), ray_, alive, &hits_);
    MaskLanes arrived = alive;
    if (HasMedia()) arrived = Fly(alive, met);
    const MaskLanes found = arrived & (met | InMedium(arrived));
    if (HasEnvironments()) ForEachLane(arrived & ~found, [&](int lane) { AddEnvironment(lane); });
    if (!Any(found)) return alive;
    const MaskLanes at_surface = found & ~InMedium(found);
    FindSurfaces(scene_.geometry(), ray_, hits_, at_surface, &surface_);
    ForEachLane(InMedium(found), [&](int lane) {
      surface_.Set(lane, path_detail::PointInMedium(ray_.Get(lane), hits_.t[lane]));
    });
    ForEachLane(at_surface & (surface_.light >= 0), [&](int lane) { AddEmission(lane); });
    const MaskLanes last = depth_ == settings_.max_depth;
    MaskLanes going = found & ~(last & (depth_ > 0));
    if (!Any(going)) return alive;
    FindBsdfs(going);
    // The choice of a light takes half of it, roulette the other.
    u_select_ = Get2D(kPairSelect, going);
    const MaskLanes lit = SampleLights(going & ~last);
    MakeBases(going);
    going &= ~last;
    if (!Any(going)) return alive;
    StartGuides(going);
    AddDirectLight(lit);
    going = Scatter(going);
    going = SurviveRoulette(going);
    depth_ = going ? depth_ + 1 : depth_;
    return alive & ~going;
  }

  /// Sends rays through the media before what they have met; returns the lanes that arrive with
  /// anything, at their hit or at a point of a medium, of which hits_ has the distance then.
  [[gnu::noinline]] MaskLanes Fly(MaskLanes alive, MaskLanes met) {
    const MediumSet& media = scene_.media();
    in_medium_ = MaskLanes{};
    const MaskLanes flying = media.borders() ? alive : alive & (medium_ != kNoMedium);
    if (!Any(flying)) return alive;
    Vec2Lanes u;
    if (media.scatters())
      u = sampler_.Get2D(depth_ + static_cast<int32_t>(kPairFirstFlight), flying);
    ForEachLane(flying, [&](int lane) {
      Ray ray = ray_.Get(lane);
      if (met[lane]) ray.t_max = hits_.t[lane];
      const Flight flight = media.Fly(ray, medium_[lane], beta_.Get(lane), {u.x[lane], u.y[lane]});
      AddRadiance(lane, flight.emitted, 1);
      beta_.Set(lane, beta_.Get(lane) * flight.weight);
      medium_[lane] = flight.medium;
      if (IsBlack(beta_.Get(lane))) alive[lane] = 0;
      if (!flight.scattered) return;
      in_medium_[lane] = -1;
      hits_.t[lane] = flight.t;
    });
    return alive;
  }

  template <typename LightPdf>
  float EmissionWeight(int lane, LightPdf&& light_pdf) const {
    return specular_[lane] ? 1 : PowerHeuristic(bsdf_pdf_[lane], light_pdf());
  }

  void AddRadiance(int lane, Rgb radiance, float weight) {
    radiance_.Set(lane, radiance_.Get(lane) + beta_.Get(lane) * radiance * weight);
  }

  void AddEnvironment(int lane);
  [[gnu::noinline]] void AddEmission(int lane);

  /// All but the reflectances of bases, which may still be on their way from memory.
  void FindBsdfs(MaskLanes mask) {
    const Vec3Lanes wo = -ray_.direction;
    const MaskLanes seen = Dot(surface_.ns, wo) * Dot(surface_.ng, wo) > 0;
    frame_ = FrameLanes::FromNormal(Select(seen, surface_.ns, surface_.ng));
    const BaseLanes bases =
        FindBases(scene_.materials(), scene_.textures(), surface_, mask & ~InMedium(mask),
                  {.coats = HasCoats(), .textures = HasBaseTextures()}, &textured_);
    reflectance_ = bases.reflectance;
    lambertian_ = bases.bare;
    coated_ = bases.coated;
    receiver_.one_sided = mask;
    receiver_.in_medium = InMedium(mask);
    ForEachLane(OtherMaterials(mask), [&](int lane) {
      bsdf_[lane] = &BsdfOf(lane, wo.Get(lane));
      if (Transmits(*bsdf_[lane])) receiver_.one_sided[lane] = 0;
    });
    wo_z_ = Dot(wo, frame_.z);
    if constexpr ((kHas & kOtherMaterials) != 0) wo_ = frame_.ToLocal(wo);
    receiver_.p = surface_.p;
    receiver_.n = Select(wo_z_ < 0, -frame_.z, frame_.z);
  }

  void MakeBases(MaskLanes mask) {
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
      ForEachLane(mask & (depth_ == 0) & ~InMedium(mask),
                  [&](int lane) { DescribeFirstHit(lane); });
  }

  /// The BSDF of the lane's vertex; turns its frame where the material is not isotropic.
  [[gnu::noinline]] const Bsdf& BsdfOf(int lane, Vec3f wo) {
    if (HasMedia() && in_medium_[lane]) return scene_.media().phase(medium_[lane]);
    const MaterialSet& materials = scene_.materials();
    const MaterialId id = surface_.material[lane];
    const Bsdf* constant = materials.Constant(id);
    const bool plain = materials.HasPlainFrame(id);
    if (constant && plain) return *constant;
    const SurfacePoint point = scene_.geometry().Surface(ray_.Get(lane), hits_.Get(lane));
    const auto u_mix = [&] {
      MaskLanes only = {};
      only[lane] = -1;
      return Get2D(kPairLobe, only).y[lane];
    };
    if (materials.HasDetail(id)) {
      const SurfaceDerivatives derivatives =
          scene_.geometry().Derivatives(ray_.Get(lane), hits_.Get(lane));
      const SurfacePoint turned = materials.WithDetail(point, derivatives, wo, u_mix());
      frame_.Set(lane, path_detail::ShadingFrame(turned, wo, false));
    } else if (!plain) {
      frame_.Set(lane, path_detail::ShadingFrame(point, wo, false));
    }
    if (constant) return *constant;
    return materials.Evaluate(id, point.TextureUv(), point.p, u_mix(), &varying_[lane]);
  }

  void DescribeFirstHit(int lane) {
    PathSample& sample = first_hit_[lane];
    sample.hit = true;
    sample.normal = frame_.z.Get(lane);
    sample.position = surface_.p.Get(lane);
    if (!settings_.albedo) return;
    sample.albedo = lambertian_[lane] ? reflectance_.Get(lane)
                    : coated_[lane]   ? coat_.Albedo().Get(lane)
                                      : Albedo(*bsdf_[lane], wo_.Get(lane));
  }

  void StartGuides(MaskLanes mask) {
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

  MaskLanes SidesAgree(Vec3Lanes w, FloatLanes w_z) const { return Dot(surface_.ng, w) * w_z > 0; }

  /// Samples a light for each lane of `mask`, as light_ says; returns those that have found one.
  MaskLanes SampleLights(MaskLanes mask);
  void AddDirectLight(MaskLanes mask);
  [[gnu::noinline]] void Fade(const RayLanes& shadow, const Vec3Lanes& wi, MaskLanes mask,
                              RgbLanes* contribution) const;

  /// The lanes whose vertices are at surfaces that are borders of media.
  MaskLanes AtBorder() const {
    return (surface_.material >= scene_.media().first_border()) & ~in_medium_;
  }
  MediumId MediumTowards(int lane, Vec3f w) const {
    if (in_medium_[lane]) return medium_[lane];
    return scene_.media().Entered(surface_.material[lane], surface_.ng.Get(lane), w, medium_[lane]);
  }

  MaskLanes ShadowRoulette(MaskLanes mask, RgbLanes* contribution) const;

  /// Chooses the next directions; returns the lanes that have one.
  MaskLanes Scatter(MaskLanes mask) {
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
    if (Any(others | coated)) u_lobe = Get2D(kPairLobe, others | coated).x;
    if (Any(coated)) {
      const BsdfSampleLanes sample = coat_.Sample(u_lobe, u, cosine_wi);
      wi = Select(coated, sample.wi, wi);
      weight = Select(coated, sample.weight, weight);
      specular_ = coated & sample.delta;
      bsdf_pdf_ = coated ? sample.pdf : bsdf_pdf_;
      going = (going & ~coated) | (coated & sample.valid & ~IsBlack(sample.weight));
    }
    if (Any(others)) {
      ForEachLane(others, [&](int lane) {
        const std::optional<BsdfSample> sample =
            SampleOf(lane, u_lobe[lane], {u.x[lane], u.y[lane]});
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
    if (HasAlpha()) SetRayIds(&ray_, u, false, going);
    previous_ = receiver_;
    if (HasMedia())
      ForEachLane(going & AtBorder(),
                  [&](int lane) { medium_[lane] = MediumTowards(lane, ray_.direction.Get(lane)); });
    return going & SidesAgree(ray_.direction, wi.z);
  }

  /// Density and value of a BSDF that is not one of the common kinds.
  [[gnu::noinline]] BsdfValue ValueOf(int lane, Vec3f wi) const {
    return EvalPdf(*bsdf_[lane], wo_.Get(lane), wi);
  }

  [[gnu::noinline]] std::optional<BsdfSample> SampleOf(int lane, float u_lobe, Vec2f u) const {
    if (!guided_[lane]) return Sample(*bsdf_[lane], wo_.Get(lane), u_lobe, u);
    const Frame frame = frame_.Get(lane);
    if (!lambertian_[lane])
      return SampleGuided(*bsdf_[lane], frame, wo_.Get(lane), guides_[lane], u_lobe, u);
    const DiffuseBsdf diffuse = {reflectance_.Get(lane)};
    return SampleGuided(diffuse, frame, {0, 0, wo_z_[lane]}, guides_[lane], u_lobe, u);
  }

  MaskLanes SurviveRoulette(MaskLanes mask) {
    const FloatLanes throughput = MaxComponent(beta_) * eta_scale_;
    MaskLanes plays = mask & (depth_ >= 1) & (throughput < sure_survival_);
    if (HasLampImages()) plays &= ~to_lamp_;
    if (!Any(plays)) return mask;
    const FloatLanes survival = SurvivalProbability(throughput, sure_survival_);
    const MaskLanes survives = u_select_.y < survival;
    beta_ = Select(plays, beta_ * (1 / survival), beta_);
    return mask & (~plays | survives);
  }

  const Scene& scene_;
  const PathSettings settings_;
  FloatLanes sure_survival_;
  SamplerLanes<Sampler> sampler_;

  // Carried from vertex to vertex, as in PathTracer.
  RayLanes ray_;
  RgbLanes beta_, radiance_;
  FloatLanes eta_scale_ = {}, bsdf_pdf_ = {};
  MaskLanes specular_ = {}, to_lamp_ = {};
  IntLanes medium_ = {};
  LightReceiverLanes previous_;
  IntLanes depth_ = {}, rays_ = {};
  std::array<PathSample, kLanes> first_hit_;

  // Of the vertex.
  HitLanes hits_;
  SurfaceLanes surface_;
  MaskLanes in_medium_ = {};  ///< Of surface_ the points are known, and ng is the way back.
  FrameLanes frame_;
  FloatLanes wo_z_ = {};
  LightReceiverLanes receiver_;
  LightSampleLanes light_;
  // How it scatters: as Lambert says, by reflectance_; by that under coat_; or by bsdf_.
  MaskLanes lambertian_ = {}, coated_ = {};
  RgbLanes reflectance_;
  TextureSet::BegunLanes textured_;  ///< Whose reflectances are on their way.
  CoatedDiffuseLanes coat_;
  std::array<const Bsdf*, kLanes> bsdf_ = {};
  Vec3Lanes wo_;                          ///< Local.
  std::array<BsdfRoom, kLanes> varying_;  ///< For BSDFs that are not the same over the surface.
  Vec2Lanes u_select_;                    ///< Of kPairSelect.
  MaskLanes guided_ = {};                 ///< Directions may come from guides_.
  std::array<LampGuide, kLanes> guides_;
};

}  // namespace strata

#include "worker/integrator/path_lanes_light.h"
