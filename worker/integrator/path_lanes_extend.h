#pragma once

#include "worker/integrator/path_lanes.h"

// The part of PathLanes that sends rays from vertex to vertex. Included by path_lanes.h alone.

namespace strata {

template <typename Sampler, uint32_t kHas>
template <typename Next, typename CameraRays>
inline bool PathLanes<Sampler, kHas>::Start(Next next, CameraRays rays) {
  const PathBatch free = free_.Take();
  int count = 0;
  while (count < kLanes && next(free.path.at[count], sampler_)) ++count;
  const PathBatch batch(free.ids, FirstLanes(count));
  free_.Push(free.ids, ~batch.mask);
  sampler_.Choose(batch.path);
  const RayLanes camera = rays(
      [&](SamplePair pair) {
        return sampler_.Get2D(SameInt(static_cast<int32_t>(pair)), batch.mask);
      },
      batch);
  const FloatLanes one = SameFloat(1);
  const FloatLanes sure = states_.Load(offsetof(PathState, bsdf_pdf), batch).v[3];
  states_.Store(offsetof(PathState, origin), batch, RowsOf(camera.origin));
  states_.Store(offsetof(PathState, direction), batch, RowsOf(camera.direction, camera.time));
  states_.Store(offsetof(PathState, beta), batch, {{one, one, one, one}});
  states_.Store(offsetof(PathState, radiance), batch,
                RowsOf(RgbLanes{}, AsFloats(SameInt(PathState::kSpecular))));
  states_.Store(offsetof(PathState, bsdf_pdf), batch, RowsOf(RgbLanes{}, sure));
  if (HasMedia()) {
    const FloatLanes medium = AsFloats(SameInt(scene_.media().camera_medium()));
    states_.Store(offsetof(PathState, uv), batch,
                  {{FloatLanes{}, FloatLanes{}, medium, FloatLanes{}}});
  }
  if (HasAlpha()) {
    const Vec2Lanes u = sampler_.Get2D(SameInt(kPairFilm), batch.mask);
    ForEachLane(batch.mask, [&](int lane) {
      states_[batch.path.at[lane]].ray_id = path_detail::RayId({u.x[lane], u.y[lane]}, false);
    });
  }
  if (settings_.first_hit)
    ForEachLane(batch.mask, [&](int lane) { first_hit_[batch.path.at[lane]] = {}; });
  to_trace_.Push(batch.ids, batch.mask);
  return count == kLanes;
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::Extend(const PathBatch& batch) {
  const MaskLanes mask = batch.mask;
  // Emission comes after the light that is on its way to the vertex before.
  if (shadows_.size() > 0 && to_trace_.taken() > waiting_since_) ConnectWaiting();
  const RowLanes origin = states_.Load(offsetof(PathState, origin), batch),
                 direction = states_.Load(offsetof(PathState, direction), batch);
  ray_.origin = VectorOf(origin);
  ray_.id = AsInts(origin.v[3]);
  ray_.direction = VectorOf(direction);
  ray_.time = direction.v[3];
  depth_ = AsInts(states_.Load(offsetof(PathState, bsdf_pdf), batch).v[1]);
  const MaskLanes met = Intersect(scene_.geometry(), ray_, mask, &hits_);
  MaskLanes arrived = mask;
  if (HasMedia()) arrived = Fly(batch, mask, met);
  const MaskLanes found = arrived & (met | InMedium(arrived));
  if (HasEnvironments())
    ForEachLane(arrived & ~found, [&](int lane) { AddEnvironment(lane, batch.path.at[lane]); });
  MaskLanes going = found;
  if (Any(found)) {
    const MaskLanes at_surface = found & ~InMedium(found);
    FindSurfaces(scene_.geometry(), ray_, hits_, at_surface, HasBaseTextures(), &surface_);
    ForEachLane(InMedium(found), [&](int lane) {
      surface_.Set(lane, path_detail::PointInMedium(ray_.Get(lane), hits_.t[lane]));
    });
    ForEachLane(at_surface & (surface_.light >= 0),
                [&](int lane) { AddEmission(lane, batch.path.at[lane]); });
    going &= ~((depth_ == settings_.max_depth) & (depth_ > 0));
    states_.Store(offsetof(PathState, p), batch, RowsOf(surface_.p, surface_.offset));
    states_.Store(offsetof(PathState, ng), batch, RowsOf(surface_.ng, AsFloats(surface_.material)));
    states_.Store(offsetof(PathState, n), batch, RowsOf(surface_.ns));
    if (HasMedia() || HasBaseTextures())
      states_.Store(offsetof(PathState, uv), batch,
                    {{surface_.uv.x, surface_.uv.y, AsFloats(medium_), AsFloats(InMedium(found))}});
    Sort(batch, going);
  }
  finished_.Push(batch.ids, mask & ~going);
}

template <typename Sampler, uint32_t kHas>
MaskLanes PathLanes<Sampler, kHas>::Fly(const PathBatch& batch, MaskLanes alive, MaskLanes met) {
  const MediumSet& media = scene_.media();
  in_medium_ = MaskLanes{};
  medium_ = AsInts(states_.Load(offsetof(PathState, uv), batch).v[2]);
  const MaskLanes flying = media.borders() ? alive : alive & (medium_ != kNoMedium);
  if (!Any(flying)) return alive;
  if (media.only_absorbs()) {
    const FloatLanes length = met ? hits_.t : ray_.t_max;
    const RowLanes beta = states_.Load(offsetof(PathState, beta), batch);
    const RgbLanes left =
        Select(flying, ColorOf(beta) * media.Absorption(medium_, length, flying), ColorOf(beta));
    states_.Store(offsetof(PathState, beta), batch, RowsOf(left, beta.v[3]));
    return alive & ~IsBlack(left);
  }
  Vec2Lanes u;
  if (media.scatters()) {
    sampler_.Choose(batch.path);
    u = sampler_.Get2D(depth_ + static_cast<int32_t>(kPairFirstFlight), flying);
  }
  ForEachLane(flying, [&](int lane) {
    PathState& state = states_[batch.path.at[lane]];
    Ray ray = ray_.Get(lane);
    if (met[lane]) ray.t_max = hits_.t[lane];
    const Flight flight = media.Fly(ray, medium_[lane], state.beta, {u.x[lane], u.y[lane]});
    state.radiance += state.beta * flight.emitted;
    state.beta *= flight.weight;
    medium_[lane] = flight.medium;
    if (IsBlack(state.beta)) alive[lane] = 0;
    if (!flight.scattered) return;
    in_medium_[lane] = -1;
    hits_.t[lane] = flight.t;
  });
  return alive;
}

namespace path_detail {

/// Of emission that a path's ray has met.
template <typename LightPdf>
float EmissionWeight(const PathState& state, LightPdf&& light_pdf) {
  return state.flags & PathState::kSpecular ? 1 : PowerHeuristic(state.bsdf_pdf, light_pdf());
}

}  // namespace path_detail

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::AddEnvironment(int lane, int path) {
  const LightSet& lights = scene_.lights();
  PathState& state = states_[path];
  const Vec3f origin = ray_.origin.Get(lane), direction = ray_.direction.Get(lane);
  for (uint32_t light : lights.environments()) {
    const float weight = path_detail::EmissionWeight(
        state, [&] { return lights.EnvironmentPdf(light, state.p, direction); });
    state.radiance += state.beta * lights.EnvironmentLe(light, origin, direction) * weight;
  }
}

template <typename Sampler, uint32_t kHas>
void PathLanes<Sampler, kHas>::AddEmission(int lane, int path) {
  const LightSet& lights = scene_.lights();
  PathState& state = states_[path];
  const uint32_t surface = static_cast<uint32_t>(surface_.light[lane]);
  const Vec3f direction = ray_.direction.Get(lane), ng = surface_.ng.Get(lane);
  const Rgb radiance = lights.SurfaceLe(surface, ng, -direction, [&] {
    return scene_.geometry().Surface(ray_.Get(lane), hits_.Get(lane));
  });
  if (IsBlack(radiance)) return;
  const float weight = path_detail::EmissionWeight(state, [&] {
    return lights.SurfacePdf(surface, state.Previous(),
                             {surface_.p.Get(lane), ng, direction, hits_.t[lane]});
  });
  state.radiance += state.beta * radiance * weight;
}

template <typename Sampler, uint32_t kHas>
inline void PathLanes<Sampler, kHas>::Sort(const PathBatch& batch, MaskLanes mask) {
  if constexpr ((kHas & kOtherMaterials) == 0) {
    to_shade_[kBare].Push(batch.ids, mask);
    return;
  }
  const IntLanes flags = FlagsOf(scene_.materials(), surface_.material, mask);
  const MaskLanes base = mask & ~InMedium(mask) & ((flags & BaseRow::kBase) != 0);
  const MaskLanes coat = base & ((flags & BaseRow::kCoat) != 0);
  const MaskLanes glass = mask & ~InMedium(mask) & ((flags & BaseRow::kGlass) != 0);
  const MaskLanes other = mask & ~(HasCoats() ? base | glass : base & ~coat);
  to_shade_[kBare].Push(batch.ids, base & ~coat);
  to_shade_[kCoated].Push(batch.ids, coat & ~other);
  to_shade_[kGlass].Push(batch.ids, glass & ~other);
  to_shade_[kOther].Push(batch.ids, other);
  ForEachLane(other, [&](int lane) { vertex_hits_[batch.path.at[lane]] = hits_.Get(lane); });
}

}  // namespace strata
