#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <optional>

#include "common/job.h"
#include "worker/bsdf/bsdf.h"
#include "worker/integrator/hemisphere_strategy.h"
#include "worker/integrator/path_events.h"
#include "worker/light/lamp_guide.h"
#include "worker/light/light_set.h"
#include "worker/sampling/hash.h"
#include "worker/sampling/mis.h"
#include "worker/sampling/roulette.h"
#include "worker/sampling/routines.h"
#include "worker/sampling/sampler.h"
#include "worker/sampling/warp.h"
#include "worker/scene/scene.h"

// The unidirectional path tracer: one function template, compiled for each sampler and observer.

namespace strata {

namespace path_detail {

/// Shadow segments end short of the light by this part of their length: Embree's distances to
/// surfaces round, and the light must not shadow itself.
inline constexpr float kShadowEnd = 1 - 0x1p-14f;

/// Whether lights that directions meet are sampled too.
inline bool SamplesLights(DirectStrategy strategy) {
  return strategy == DirectStrategy::kMis || strategy == DirectStrategy::kLightOnly;
}
/// Whether directions come from the BSDF.
inline bool FollowsBsdf(DirectStrategy strategy) {
  return strategy != DirectStrategy::kCosine && strategy != DirectStrategy::kUniform;
}

inline Frame ShadingFrame(const SurfacePoint& point, Vec3f wo, bool isotropic) {
  // A surface that is seen from behind its interpolated normal is taken as flat.
  const bool seen = Dot(point.ns, wo) * Dot(point.ng, wo) > 0;
  const Vec3f n = seen ? point.ns : point.ng;
  return isotropic ? Frame::FromNormal(n) : Frame::FromNormalAndTangent(n, point.dpdu);
}

/// Where shading and geometric normal disagree about the side a direction lies on, the direction is
/// refused: light would leak through the surface.
inline bool SidesAgree(const PathVertex& vertex, Vec3f w_world, Vec3f w) {
  return Dot(vertex.point.ng, w_world) * w.z > 0;
}

/// The id of a ray (see Ray) made from the random numbers `u`: unlike its direction, these have the
/// same bits in both kernels.
inline uint32_t RayId(Vec2f u, bool shadow) {
  const uint64_t bits =
      (uint64_t{std::bit_cast<uint32_t>(u.x)} << 32) | std::bit_cast<uint32_t>(u.y);
  return static_cast<uint32_t>(HashCombine(shadow ? 1 : 0, bits));
}

inline Ray ShadowRay(const SurfacePoint& point, const LightSample& light, float time,
                     uint32_t ray_id) {
  Ray ray = {.origin = OffsetRayOrigin(point, light.wi),
             .direction = light.wi,
             .time = time,
             .id = ray_id};
  if (!light.infinite) {
    ray.direction = light.end - ray.origin;
    ray.t_max = kShadowEnd;
  }
  return ray;
}

/// All of a shadow ray's way, as media have it.
inline Ray WholeWay(Ray shadow, const LightSample& light) {
  if (!light.infinite) shadow.t_max = 1;
  return shadow;
}

/// The point of a medium where light was scattered after it came along `ray`.
inline SurfacePoint PointInMedium(const Ray& ray, float t) {
  SurfacePoint point;
  point.p = ray.origin + ray.direction * t;
  point.ng = point.ns = -ray.direction;
  return point;
}

}  // namespace path_detail

/// Follows one path from the camera. Holds what is carried from vertex to vertex.
template <typename Sampler, typename Observer>
class PathTracer {
 public:
  PathTracer(const Scene& scene, const PathSettings& settings, const Sampler& sampler,
             Observer& observer)
      : scene_(scene),
        settings_(settings),
        sampler_(sampler),
        observer_(observer),
        medium_(scene.media().camera_medium()) {}

  /// Light that arrives along `ray`. The sampler must have been started on the sample.
  PathSample Trace(Ray ray) {
    ray.id = RayId([&] { return sampler_.Get2D(kPairFilm); }, false);
    for (int depth = 0;; ++depth) {
      Hit hit;
      ++result_.rays;
      const bool met = scene_.geometry().Intersect(ray, &hit);
      if (met) ray.t_max = hit.t;
      const Flight flight = Fly(depth, ray);
      if (IsBlack(beta_)) break;
      if (!met && !flight.scattered) {
        AddEnvironment(ray);
        break;
      }
      PathVertex vertex;
      vertex.wo_world = -ray.direction;
      vertex.in_medium = flight.scattered;
      vertex.point = flight.scattered ? path_detail::PointInMedium(ray, flight.t)
                                      : scene_.geometry().Surface(ray, hit);
      if (vertex.point.light >= 0) AddEmission(ray, hit, vertex.point);

      const bool last = depth == settings_.max_depth;
      if (last && depth > 0) break;
      MakeBsdf(depth, ray, hit, vertex);
      observer_.OnVertex(depth, ray, vertex, beta_);
      if (depth == 0 && settings_.first_hit && !vertex.in_medium) DescribeFirstHit(vertex);
      if (last) break;

      StartGuide(depth, vertex);
      AddDirectLight(depth, vertex, ray.time);
      if (!Scatter(depth, vertex, &ray) || !SurvivesRoulette(depth)) break;
    }
    // A throughput that is no number is a defect of the sample, whether it met light or not.
    if (!IsFinite(beta_)) result_.radiance += beta_;
    return result_;
  }

 private:
  Vec2f Get2D(int depth, BouncePair pair) const {
    return sampler_.Get2D(kPairFirstBounce + static_cast<uint32_t>(depth) * kPairsPerBounce + pair);
  }

  /// See path_detail::RayId; 0 where ids do not matter. `u()` gives the random numbers.
  template <typename Numbers>
  uint32_t RayId(Numbers u, bool shadow) const {
    return scene_.geometry().has_alpha() ? path_detail::RayId(u(), shadow) : 0;
  }

  /// Sends the ray through the media before ray.t_max.
  Flight Fly(int depth, const Ray& ray) {
    const MediumSet& media = scene_.media();
    if (medium_ == kNoMedium && !media.borders()) return {};
    const Vec2f u = sampler_.Get2D(kPairFirstFlight + static_cast<uint32_t>(depth));
    const Flight flight = media.Fly(ray, medium_, beta_, u);
    result_.radiance += beta_ * flight.emitted;
    beta_ *= flight.weight;
    medium_ = flight.medium;
    observer_.OnFlight(flight);
    return flight;
  }

  /// MIS weight of emission that the BSDF's direction met, where light sampling would have found it
  /// with density `light_pdf()`.
  template <typename LightPdf>
  float EmissionWeight(LightPdf&& light_pdf) const {
    if (specular_ || !path_detail::SamplesLights(settings_.direct)) return 1;
    // Light sampling alone leaves out what it never finds, such as the dim parts of a sky.
    if (settings_.direct == DirectStrategy::kLightOnly) return light_pdf() > 0 ? 0 : 1;
    return HeuristicWeight(bsdf_pdf_, light_pdf());
  }

  /// MIS weight of a sample of density `pdf`, for which the other technique has `other_pdf`.
  float HeuristicWeight(float pdf, float other_pdf) const {
    if (settings_.mis_beta == kPower) return PowerHeuristic(pdf, other_pdf);
    const double shares[] = {pdf, other_pdf};
    return static_cast<float>(MisWeight(shares, 0, settings_.mis_beta));
  }

  void AddEnvironment(const Ray& ray) {
    for (uint32_t light : scene_.lights().environments()) {
      const Rgb radiance = scene_.lights().EnvironmentLe(light, ray.origin, ray.direction);
      const float weight = EmissionWeight(
          [&] { return scene_.lights().EnvironmentPdf(light, previous_.p, ray.direction); });
      result_.radiance += beta_ * radiance * weight;
      observer_.OnMiss(ray, radiance, weight);
    }
  }

  void AddEmission(const Ray& ray, const Hit& hit, const SurfacePoint& point) {
    const uint32_t surface = static_cast<uint32_t>(point.light);
    const Rgb radiance = scene_.lights().SurfaceLe(surface, point.ng, -ray.direction,
                                                   [&]() -> const SurfacePoint& { return point; });
    if (IsBlack(radiance)) return;
    const float weight = EmissionWeight([&] {
      return scene_.lights().SurfacePdf(surface, previous_,
                                        {point.p, point.ng, ray.direction, hit.t});
    });
    result_.radiance += beta_ * radiance * weight;
    observer_.OnEmission(scene_.lights().LightOfSurface(surface), radiance, weight);
  }

  static LightReceiver ReceiverAt(const PathVertex& vertex) {
    const Vec3f n = vertex.frame.z;
    return {vertex.point.p, vertex.wo.z < 0 ? -n : n, !Transmits(*vertex.bsdf), vertex.in_medium};
  }

  void MakeBsdf(int depth, const Ray& ray, const Hit& hit, PathVertex& vertex) {
    const SurfacePoint& point = vertex.point;
    if (vertex.in_medium) {
      vertex.frame = Frame::FromNormal(point.ng);
      vertex.wo = vertex.frame.ToLocal(vertex.wo_world);
      vertex.bsdf = &scene_.media().phase(medium_);
      return;
    }
    const MaterialSet& materials = scene_.materials();
    const bool detailed = materials.HasDetail(point.material);
    vertex.frame = path_detail::ShadingFrame(
        detailed ? materials.WithDetail(point, scene_.geometry().Derivatives(ray, hit),
                                        vertex.wo_world, Get2D(depth, kPairLobe).y)
                 : point,
        vertex.wo_world, materials.HasPlainFrame(point.material));
    vertex.wo = vertex.frame.ToLocal(vertex.wo_world);
    vertex.bsdf = materials.Constant(point.material);
    if (vertex.bsdf) return;
    vertex.bsdf = &materials.Evaluate(point.material, point.TextureUv(), point.p,
                                      Get2D(depth, kPairLobe).y, &bsdf_room_);
  }

  void DescribeFirstHit(const PathVertex& vertex) {
    result_.hit = true;
    result_.normal = vertex.frame.z;
    result_.position = vertex.point.p;
    if (settings_.albedo) result_.albedo = Albedo(*vertex.bsdf, vertex.wo);
  }

  /// A guided path goes on from what it is sent to (a mirror, a ball, the glow of a medium) to a
  /// lamp: two bounces more.
  void StartGuide(int depth, const PathVertex& vertex) {
    const LampImages& images = scene_.lamp_images();
    guided_ = !images.empty() && settings_.direct == DirectStrategy::kMis &&
              depth + 1 < settings_.max_depth && IsWorthGuiding(*vertex.bsdf);
    if (!guided_) return;
    guide_.Start(images, ReceiverAt(vertex), scene_.media().HazeOf(medium_));
    guided_ = guide_.share() > 0;
  }

  void AddDirectLight(int depth, const PathVertex& vertex, float time) {
    const LightSet& lights = scene_.lights();
    if (lights.empty() || IsDelta(*vertex.bsdf)) return;
    DirectSample direct;
    Vec2f u = Get2D(depth, kPairLight);
    const uint32_t ray_id = RayId([&] { return u; }, true);
    const float u_low = lights.SelectNeedsLowBits() ? Get2D(depth, kPairSelect).x : 0;
    direct.choice = lights.Select(ReceiverAt(vertex), u.x, u_low);
    if (!(direct.choice.probability > 0)) return;
    u.x = direct.choice.u;
    if (settings_.routines != SamplingRoutines::kPreserving &&
        lights.IsTriangle(direct.choice.light))
      u = TriangleNumbers(settings_.routines, u);
    const std::optional<LightSample> light = lights.Sample(direct.choice.light, vertex.point.p, u);
    if (!light || (!light->delta && !path_detail::SamplesLights(settings_.direct))) return;
    direct.light = *light;
    const Vec3f wi = vertex.frame.ToLocal(light->wi);
    if (!path_detail::SidesAgree(vertex, light->wi, wi)) return;
    direct.f = Eval(*vertex.bsdf, vertex.wo, wi);
    if (IsBlack(direct.f)) return;
    const float light_pdf = light->pdf * direct.choice.probability;
    if (!light->delta && settings_.direct == DirectStrategy::kMis) {
      direct.bsdf_pdf = Pdf(*vertex.bsdf, vertex.wo, wi);
      if (guided_) direct.bsdf_pdf = guide_.MixedPdf(direct.bsdf_pdf, light->wi);
      direct.weight = HeuristicWeight(light_pdf, direct.bsdf_pdf);
    }
    Rgb contribution = beta_ * direct.f * light->radiance * (direct.weight / light_pdf);
    ShadowRoulette(depth, &direct, &contribution);
    if (direct.traced) {
      ++result_.rays;
      const Ray ray = path_detail::ShadowRay(vertex.point, *light, time, ray_id);
      direct.blocked = scene_.geometry().Occluded(ray);
      if (!direct.blocked && !scene_.media().empty())
        direct.transmittance = scene_.media().Transmittance(path_detail::WholeWay(ray, *light),
                                                            MediumTowards(vertex, light->wi));
    }
    contribution *= direct.transmittance;
    if (direct.blocked || !direct.traced) contribution = {};
    result_.radiance += contribution;
    observer_.OnLight(direct, contribution);
  }

  MediumId MediumTowards(const PathVertex& vertex, Vec3f w) const {
    if (vertex.in_medium) return medium_;
    return scene_.media().Entered(vertex.point.material, vertex.point.ng, w, medium_);
  }

  /// Russian roulette of a light sample that can add little. By the complement of the path's own
  /// number: both expectations are right whatever they share, and seldom do both end.
  void ShadowRoulette(int depth, DirectSample* direct, Rgb* contribution) const {
    const float sure = settings_.sure_shadow * MaxComponent(result_.radiance);
    const float most = MaxComponent(*contribution);
    if (!(most < sure)) return;
    direct->survival = SurvivalProbability(most, sure);
    direct->traced = 1 - Get2D(depth, kPairSelect).y < direct->survival;
    *contribution *= 1 / direct->survival;
  }

  /// Chooses the next direction. False when the path ends here.
  bool Scatter(int depth, const PathVertex& vertex, Ray* ray) {
    const float u_lobe = Get2D(depth, kPairLobe).x;
    const Vec2f u = Get2D(depth, kPairBsdf);
    const bool by_bsdf = path_detail::FollowsBsdf(settings_.direct);
    const std::optional<BsdfSample> sample =
        guided_   ? SampleGuided(*vertex.bsdf, vertex.frame, vertex.wo, guide_, u_lobe, u)
        : by_bsdf ? Sample(*vertex.bsdf, vertex.wo, u_lobe, u)
                  : SampleHemisphere(settings_.direct, settings_.routines, *vertex.bsdf, vertex.wo,
                                     u_lobe, u);
    const Vec3f wi = sample ? vertex.frame.ToWorld(sample->wi) : Vec3f{};
    observer_.OnBsdf(sample, wi);
    if (!sample || IsBlack(sample->weight)) return false;
    beta_ *= sample->weight;
    if (!path_detail::SidesAgree(vertex, wi, sample->wi)) return false;
    specular_ = sample->delta;
    to_lamp_ = sample->to_lamp || (to_lamp_ && sample->delta);
    bsdf_pdf_ = sample->pdf;
    if (sample->transmission) eta_scale_ *= sample->eta * sample->eta;
    previous_ = ReceiverAt(vertex);
    medium_ = MediumTowards(vertex, wi);
    ray->origin = OffsetRayOrigin(vertex.point, wi);
    ray->direction = wi;
    ray->t_max = std::numeric_limits<float>::infinity();
    ray->id = RayId([&] { return u; }, false);
    return true;
  }

  /// Russian roulette on the throughput, with what refraction into denser media took given back
  /// (PBRT 13.2.1). Not before the second bounce, as pbrt does.
  bool SurvivesRoulette(int depth) {
    const float throughput = MaxComponent(beta_) * eta_scale_;
    // Not a number goes on, to be counted as the defect it is.
    if (depth < 1 || to_lamp_ || !(throughput < settings_.sure_survival)) return true;
    const float survival = SurvivalProbability(throughput, settings_.sure_survival);
    const bool survives = Get2D(depth, kPairSelect).y < survival;
    beta_ *= 1 / survival;
    observer_.OnRoulette(survival, survives);
    return survives;
  }

  const Scene& scene_;
  const PathSettings& settings_;
  const Sampler& sampler_;
  Observer& observer_;

  PathSample result_;
  Rgb beta_ = {1, 1, 1};  ///< Throughput so far.
  MediumId medium_;       ///< That the ray starts in.
  float eta_scale_ = 1;
  bool specular_ = true;    ///< Light sampling could not have found what the ray meets next.
  float bsdf_pdf_ = 0;      ///< Of the ray's direction.
  LightReceiver previous_;  ///< The vertex the ray left.
  BsdfRoom bsdf_room_;      ///< Of the vertex, where it varies over the surface.
  bool to_lamp_ = false;    ///< A guide sent the ray, and glass alone was met since.
  bool guided_ = false;     ///< Of the vertex: directions may come from guide_.
  LampGuide guide_;
};

}  // namespace strata
