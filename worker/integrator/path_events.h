#pragma once

#include <cstdint>
#include <optional>

#include "common/job.h"
#include "worker/bsdf/bsdf.h"
#include "worker/light/light_set.h"
#include "worker/medium/medium_set.h"
#include "worker/sampling/mis.h"
#include "worker/sampling/roulette.h"

// What a path is made of: how it is to go, what happens on its way, and what it found.

namespace strata {

struct PathSettings {
  int max_depth = 5;  ///< Bounces, as pbrt-v4's maxdepth: 0 shows emission alone.
  DirectStrategy direct = DirectStrategy::kMis;
  double mis_beta = kPower;  ///< JobSpec::mis_beta.
  SamplingRoutines routines = SamplingRoutines::kPreserving;
  /// Throughput from which on a path surely goes on; 0: no roulette. At a half variance times time
  /// is near its least on the shared scenes (docs/performance.md).
  float sure_survival = 0.5f;
  float sure_shadow = kSureShadow;  ///< 0: no roulette for shadow rays.
  bool first_hit = false;           ///< Whether PathSample::hit and what follows it is wanted,
  bool albedo = false;              ///< and of that the albedo.
};

/// What one path found.
struct PathSample {
  Rgb radiance;
  uint32_t rays = 0;
  bool hit = false;  ///< Whether the camera ray met a surface; the rest speaks of that point.
  Rgb albedo;
  Vec3f normal;  ///< World, unit, shading.
  Vec3f position;
};

/// A vertex of a path, in the BSDF's terms: a point of a surface or, with its phase function for a
/// BSDF, of a medium.
struct PathVertex {
  SurfacePoint point;  ///< In a medium: p alone is known, and ng is wo_world.
  bool in_medium = false;
  Vec3f wo_world;  ///< Unit, back along the path.
  Frame frame;     ///< Of shading.
  Vec3f wo;
  const Bsdf* bsdf = nullptr;
};

/// One light sample and what became of it.
struct DirectSample {
  LightSet::Choice choice;
  LightSample light;
  Rgb f;  ///< BSDF times cosine.
  float bsdf_pdf = 0;
  float weight = 1;    ///< Of MIS.
  float survival = 1;  ///< Of the shadow ray's roulette.
  bool traced = true;  ///< Whether it survived.
  bool blocked = false;
  Rgb transmittance = {1, 1, 1};  ///< Of media on the way.
};

/// Is told of every event of a path, and says nothing: all calls vanish. The observer of `strata
/// replay` writes them down.
struct SilentObserver {
  void OnFlight(const Flight&) {}
  void OnMiss(const Ray&, Rgb /*radiance*/, float /*weight*/) {}
  void OnVertex(int /*depth*/, const Ray&, const PathVertex&, Rgb /*beta*/) {}
  void OnEmission(uint32_t /*light*/, Rgb /*radiance*/, float /*weight*/) {}
  void OnLight(const DirectSample&, Rgb /*contribution*/) {}
  void OnBsdf(const std::optional<BsdfSample>&, Vec3f /*wi_world*/) {}
  void OnRoulette(float /*survival*/, bool /*survived*/) {}
};

}  // namespace strata
