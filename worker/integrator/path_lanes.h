#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/unit.h"
#include "worker/bsdf/base_lanes.h"
#include "worker/bsdf/coated_diffuse_lanes.h"
#include "worker/bsdf/dielectric_lanes.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/integrator/path.h"
#include "worker/integrator/path_pool.h"
#include "worker/sampling/sampler_lanes.h"

namespace strata {

/// The fast kernel: some paths at the same time (path_pool.h), of which eight go through a stage
/// side by side. Between stages they wait in queues until there are eight that are alike: rays to
/// be traced, vertices of one kind to be shaded, shadow rays. What most vertices have in common
/// (rays, triangles, Lambert's reflection and coats over it, glass, lights, random numbers) is done
/// for eight at once, the rest one by one with the code of PathTracer, of which this is another
/// form: the same estimator from the same random numbers. A path finds the same whichever others it
/// goes with, but for what Intersect says.
///
/// kHas are Features: a superset of the scene's.
template <typename Sampler, uint32_t kHas>
class PathLanes {
  static_assert(!(kHas & kMedia) || (kHas & kOtherMaterials), "phase functions are others");

 public:
  PathLanes(const Scene& scene, const PathSettings& settings) : scene_(scene), settings_(settings) {
    for (int path = 0; path < kPaths; ++path) SetSureSurvival(path, settings.sure_survival);
    for (int path = 0; path < kPaths; path += kLanes)
      free_.Push(IntLanes{0, 1, 2, 3, 4, 5, 6, 7} + path, FirstLanes(kLanes));
  }

  /// For a path whose sample is of a pixel with another PathSettings::sure_survival.
  void SetSureSurvival(int path, float sure) { states_[path].sure_survival = sure; }

  /// Traces samples until there are no more. `next(path, samplers)` starts the next one in a place
  /// of the samplers, below kPaths, or is false at the end; `rays(get, batch)` gives the camera
  /// rays of a batch, whose random numbers are get(pair); `store(path, sample)` takes what a path
  /// has found, before another starts in its place.
  template <typename Next, typename CameraRays, typename Store>
  void Trace(Next next, CameraRays rays, Store store) {
    bool more = true;
    while (true) {
      // All rays, then all vertices: so the code of a stage is used some times while it is near.
      PathQueue* shade = FullestToShade();
      if (to_trace_.size() >= kLanes) {
        Extend(to_trace_.Take());
      } else if (shade->size() >= kLanes) {
        Shade(shade->Take());
      } else if (more && free_.size() >= kLanes) {
        more = Start(next, rays);
      } else if (to_trace_.size() > 0) {
        Extend(to_trace_.Take());
      } else if (shade->size() > 0) {
        Shade(shade->Take());
      } else if (shadows_.size() > 0) {
        ConnectWaiting();
      } else {
        return;
      }
      Finish(store);
    }
  }

 private:
  /// Of vertices. In a batch of one kind little is computed in vain.
  enum Kind { kBare, kCoated, kGlass, kOther, kKinds };

  PathQueue* FullestToShade() {
    PathQueue* fullest = &to_shade_[0];
    for (PathQueue& queue : to_shade_)
      if (queue.size() > fullest->size()) fullest = &queue;
    return fullest;
  }

  /// Begins eight samples; false if there are no more.
  template <typename Next, typename CameraRays>
  bool Start(Next next, CameraRays rays);
  template <typename Store>
  void Finish(Store store) {
    while (finished_.size() > 0) {
      const PathBatch batch = finished_.Take();
      ForEachLane(batch.mask,
                  [&](int lane) { store(batch.path.at[lane], Result(batch.path.at[lane])); });
      free_.Push(batch.ids, batch.mask);
    }
  }
  PathSample Result(int path) const {
    const PathState& state = states_[path];
    PathSample sample;
    if (settings_.first_hit) sample = first_hit_[path];
    sample.radiance = state.radiance;
    sample.rays = static_cast<uint32_t>(state.depth + 1 + state.shadow_rays);
    if (!IsFinite(state.beta)) sample.radiance += state.beta;
    return sample;
  }

  // What the scene may need of this kernel, and whether it does.
  bool HasAlpha() const { return (kHas & kAlphaMasks) && scene_.geometry().has_alpha(); }
  bool HasEnvironments() const {
    return (kHas & kEnvironments) && !scene_.lights().environments().empty();
  }
  bool HasBaseTextures() const {
    return (kHas & kOtherMaterials) && scene_.materials().has_base_textures();
  }
  /// Whether coats and glass are looked for: guides ask for the BSDF itself.
  bool HasCoats() const { return (kHas & kOtherMaterials) && !HasLampImages(); }
  bool HasLampImages() const { return (kHas & kLampImages) && !scene_.lamp_images().empty(); }
  bool HasMedia() const { return (kHas & kMedia) && !scene_.media().empty(); }
  bool ChoosesLights() const {
    return (kHas & kManyLights) && scene_.lights().SelectNeedsLowBits();
  }
  /// The lanes in `mask` whose BSDFs are none of those that go side by side.
  MaskLanes OtherMaterials(MaskLanes mask) const {
    if constexpr ((kHas & kOtherMaterials) == 0) return MaskLanes{};
    return mask & ~(lambertian_ | coated_ | glass_);
  }
  MaskLanes Glass(MaskLanes mask) const {
    if constexpr ((kHas & kOtherMaterials) == 0) return MaskLanes{};
    return mask & glass_;
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

  Vec2Lanes Get2D(BouncePair pair, MaskLanes mask) const {
    constexpr int32_t kPerBounce = kPairsPerBounce, kFirst = kPairFirstBounce;
    return sampler_.Get2D(depth_ * kPerBounce + (kFirst + static_cast<int32_t>(pair)), mask);
  }

  // path_lanes_extend.h

  /// Sends rays to their next vertices, which wait to be shaded then, or ends their paths.
  void Extend(const PathBatch& batch);
  /// Sends rays through the media before what they have met; returns the lanes that arrive with
  /// anything, at their hit or at a point of a medium, of which hits_ has the distance then.
  [[gnu::noinline]] MaskLanes Fly(const PathBatch& batch, MaskLanes alive, MaskLanes met);
  void AddEnvironment(int lane, int path);
  [[gnu::noinline]] void AddEmission(int lane, int path);
  /// To the queues of their kinds.
  void Sort(const PathBatch& batch, MaskLanes mask);

  // path_lanes_shade.h

  /// Scatters light at vertices: takes what lights send there and chooses where the paths go on.
  void Shade(const PathBatch& batch);
  void Load(const PathBatch& batch);
  void Save(const PathBatch& batch);
  /// All but the reflectances of bases, which may still be on their way from memory.
  void FindBsdfs(MaskLanes mask);
  void MakeBases(MaskLanes mask);
  /// The ray that met the path's vertex.
  Ray RayTo(int path) const {
    const PathState& state = states_[path];
    return {.origin = state.origin,
            .direction = state.direction,
            .time = state.time,
            .id = state.ray_id};
  }

  /// The BSDF of the lane's vertex; turns its frame where the material is not isotropic.
  [[gnu::noinline]] const Bsdf& BsdfOf(int lane, Vec3f wo);
  void DescribeFirstHit(int lane);
  void StartGuides(MaskLanes mask);
  /// Chooses the next directions; returns the lanes that have one.
  MaskLanes Scatter(MaskLanes mask);
  [[gnu::noinline]] std::optional<BsdfSample> SampleOf(int lane, float u_lobe, Vec2f u) const;
  MaskLanes SurviveRoulette(MaskLanes mask);
  MaskLanes SidesAgree(Vec3Lanes w, FloatLanes w_z) const { return Dot(w, surface_.ng) * w_z > 0; }
  /// The media that rays enter which leave the vertices towards `w`.
  IntLanes MediumTowards(const Vec3Lanes& w, MaskLanes mask) const {
    const MediumSet& media = scene_.media();
    const MaskLanes border = mask & (surface_.material >= media.first_border()) & ~in_medium_;
    return Any(border) ? media.Entered(surface_.material, surface_.ng, w, medium_, border)
                       : medium_;
  }

  // path_lanes_light.h

  /// Samples a light for each lane of `mask`, as light_ says; returns those that have found one.
  MaskLanes SampleLights(MaskLanes mask);
  /// Makes shadow_ of what was found; returns the lanes that have a shadow ray.
  MaskLanes AddDirectLight(MaskLanes mask);
  /// Density and value of a BSDF that is not one of the common kinds.
  [[gnu::noinline]] BsdfValue ValueOf(int lane, Vec3f wi) const {
    return EvalPdf(*bsdf_[lane], wo_.Get(lane), wi);
  }

  MaskLanes ShadowRoulette(MaskLanes mask, RgbLanes* contribution) const;
  /// Lets shadow_ wait for others; `ended` are the paths that wait for nothing else.
  void PushShadows(const PathBatch& batch, MaskLanes mask, MaskLanes ended);
  /// Traces shadow rays, and adds what they bring to their paths.
  void Connect(const ShadowQueue::Lanes& shadows, MaskLanes mask);
  void ConnectWaiting() {
    const MaskLanes mask = FirstLanes(shadows_.size());
    Connect(shadows_.Take(), mask);
  }

  [[gnu::noinline]] void Fade(const ShadowQueue::Lanes& shadows, MaskLanes mask,
                              RgbLanes* contribution) const;

  const Scene& scene_;
  const PathSettings settings_;

  // The paths, each in one of these queues, or with nothing left but a ray in shadows_.
  PathStates states_;
  SamplerLanes<Sampler> sampler_{kPaths + 1};
  PathQueue free_, to_trace_, finished_;
  std::array<PathQueue, kKinds> to_shade_;
  ShadowQueue shadows_;
  /// PathQueue::pushed of to_trace_ before the first path came that has a ray in shadows_.
  int64_t waiting_since_ = 0;
  std::array<Hit, kPaths> vertex_hits_;  ///< Of vertices of kOther.
  std::array<PathSample, kPaths> first_hit_;

  // Of the paths in the stage.
  const PathBatch* batch_ = nullptr;
  RayLanes ray_;
  FloatLanes sure_survival_ = {};
  RgbLanes beta_, radiance_;
  FloatLanes eta_scale_ = {}, bsdf_pdf_ = {};
  MaskLanes specular_ = {}, to_lamp_ = {};
  IntLanes medium_ = {};
  IntLanes depth_ = {}, shadow_rays_ = {};
  HitLanes hits_;
  SurfaceLanes surface_;
  MaskLanes in_medium_ = {};  ///< Of surface_ the points are known, and ng is the way back.
  FrameLanes frame_;
  FloatLanes wo_z_ = {};
  LightReceiverLanes receiver_;
  LightSampleLanes light_;
  FloatLanes root_sum_ = {};  ///< For the LightReceivers that vertices are for emission.
  ShadowQueue::Lanes shadow_;
  // How it scatters: as Lambert says, by reflectance_; by that under coat_; as glass; or by bsdf_.
  MaskLanes lambertian_ = {}, coated_ = {}, glass_ = {};
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

#include "worker/integrator/path_lanes_extend.h"
#include "worker/integrator/path_lanes_light.h"
#include "worker/integrator/path_lanes_shade.h"
