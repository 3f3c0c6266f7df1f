#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "common/status.h"
#include "worker/geometry/rounding.h"
#include "worker/geometry/surface_uv.h"
#include "worker/math/vec.h"
#include "worker/scene/build_options.h"
#include "worker/scene/description.h"

// All surfaces of a scene behind one intersector. Embree is seen by geometry's .cpp files alone.

namespace strata {

class TextureSet;

struct Ray {
  Vec3f origin;
  Vec3f direction;  ///< Unit length for camera and path rays; shadow rays may be segments.
  float t_max = std::numeric_limits<float>::infinity();
  float time = 0;  ///< In [0, 1], of moving instances.
  /// Decides, with the place it meets, whether a surface of partial alpha is there for this ray.
  uint32_t id = 0;
};

/// What the intersector found; Surface() makes sense of it.
struct Hit {
  float t = 0;
  float u = 0, v = 0;     ///< Barycentric for triangles; parameters of a bilinear patch.
  Vec3f local;            ///< Of curved shapes: the point in the shape's own space; else Embree's
                          ///< normal.
  uint32_t geometry = 0;  ///< Embree geometry id.
  uint32_t primitive = 0;
  uint32_t instance = ~0u;  ///< ~0: not in an instance.
};

/// A point on a surface, in world space.
struct SurfacePoint {
  Vec3f p;
  Vec3f p_error;  ///< Absolute bound of the rounding error of p, per axis (PBRT 6.8).
  Vec3f ng;       ///< Unit geometric normal of the outer side (after ReverseOrientation).
  Vec3f ns;       ///< Unit shading normal, in the hemisphere of ng.
  Vec3f dpdu;     ///< Tangent along u; not normalized; may be zero.
  Vec2f uv;
  MaterialId material = 0;
  int32_t light = -1;  ///< Index into Geometry::emitters(), or -1.
  std::optional<Vec2f> second_uv;

  SurfaceUv TextureUv() const { return {uv, second_uv.value_or(uv)}; }
};

/// How a point of a surface and its shading normal (on the outer side) move with (u, v), in world
/// space.
struct SurfaceDerivatives {
  Vec3f dpdu, dpdv, dndu, dndv;
};

// Emissive shapes in world space, as light sampling wants them.
struct TriangleEmitter {
  Vec3f p0, p1, p2;
  Vec3f ng;  ///< Unit, of the emitting side.
  /// Of the corners; the second ones where the texture is looked up by those.
  Vec2f uv0 = {0, 0}, uv1 = {1, 0}, uv2 = {1, 1};
};
struct SphereEmitter {  ///< A full sphere under a similarity transform.
  Vec3f center;
  float radius = 0;
  bool inward = false;  ///< The emitting side is the inside.
  uint32_t shape = 0;   ///< As in OtherEmitter.
};
/// Any other shape: sampled by area through Geometry::SampleEmitter.
struct OtherEmitter {
  uint32_t shape = 0;  ///< Known to Geometry alone.
  Vec3f min, max;      ///< A box that holds it.
  bool flat = false;   ///< A disk.
  Vec3f ng;            ///< If flat: unit, of the emitting side.
};
struct Emitter {
  std::variant<TriangleEmitter, SphereEmitter, OtherEmitter> shape;
  Rgb radiance;
  bool two_sided = false;
  TextureId texture = kNoTexture;  ///< Multiplies the radiance, if set.
  float area = 0;                  ///< World.
  bool masked = false;             ///< By alpha: only parts of it are there.
};

/// Two triangles of one shape that make a rectangle, in world space.
struct FlatRectangle {
  Vec3f corner, unit1, unit2;  ///< Unit vectors along the edges.
  float length1 = 0, length2 = 0;
  MaterialId material = 0;
};

/// A point chosen on an emitter.
struct EmitterPoint {
  Vec3f p, ng;
  float offset = 0;    ///< OffsetDistance
  float pdf_area = 0;  ///< Per unit of world area.
};

class Geometry {
 public:
  /// Uses the shapes, objects, instances and materials (for interfaces, which are left out) of
  /// `scene`. INVALID_ARGUMENT with the location of a shape that cannot be built (singular
  /// transform, index out of range, ...). Emissive shapes in objects shine from every instance.
  static absl::StatusOr<std::unique_ptr<Geometry>> Build(const SceneDescription& scene,
                                                         const BuildOptions& options = {});
  ~Geometry();

  /// The nearest hit in (0, ray.t_max); false if none. Thread-safe, as all that is const here.
  bool Intersect(const Ray& ray, Hit* hit) const;
  /// Whether anything lies in (0, ray.t_max).
  bool Occluded(const Ray& ray) const;
  SurfacePoint Surface(const Ray& ray, const Hit& hit) const;
  SurfaceDerivatives Derivatives(const Ray& ray, const Hit& hit) const;

  /// Whether any surface has an alpha mask, so that the ids of rays matter.
  bool has_alpha() const { return has_alpha_; }
  /// The textures of alpha masks. To be given before the first ray where there are masks; outlive
  /// the geometry.
  void SetTextures(const TextureSet& textures);

  const std::vector<Emitter>& emitters() const { return emitters_; }
  /// A point of an OtherEmitter, u in [0,1)^2. Uniform by area where the shape's transform is a
  /// similarity (and a bilinear patch is a parallelogram); otherwise its density varies over the
  /// shape, so use `pdf_area` of the point and not 1 / area.
  EmitterPoint SampleEmitter(const OtherEmitter& emitter, Vec2f u) const;
  /// The density, per unit of world area, with which SampleEmitter finds `p` on the emitter.
  float EmitterPdfArea(const OtherEmitter& emitter, Vec3f p) const;
  /// The surface's (u, v) at `p`, a point of the emitter with this `shape`.
  Vec2f EmitterUv(uint32_t shape, Vec3f p) const;

  /// The rectangles of materials that `wanted` accepts; not those in instances, nor bilinear
  /// patches.
  std::vector<FlatRectangle> Rectangles(const std::function<bool(MaterialId)>& wanted) const;

  struct Bounds {
    Vec3f min, max;
  };
  Bounds bounds() const { return bounds_; }
  /// Whether any instance moves, so that rays at different times meet different scenes.
  bool moves() const;
  /// Triangles held, those of a shared object once.
  uint64_t triangle_count() const { return triangle_count_; }

  /// What is behind, for benches that trace Embree's scene themselves: worker/geometry/state.h.
  struct State;
  const State& state() const { return *state_; }

 private:
  Geometry();
  std::unique_ptr<State> state_;
  std::vector<Emitter> emitters_;
  Bounds bounds_;
  uint64_t triangle_count_ = 0;
  bool has_alpha_ = false;
};

/// How far along ng rays have to start from `p` that leave a surface there: by the error bound
/// (PBRT 6.8.6), by what rounding may bring the start nearer, so that it needs no directed
/// rounding, and by twice as much again (docs/decisions.md).
inline float OffsetDistance(Vec3f p, Vec3f p_error, Vec3f ng) {
  return Dot(Abs(ng), Fma(Abs(p), Gamma(3), p_error)) * (1 + Gamma(16));
}
/// Where a ray that leaves `p` in direction `w` starts, so that it does not hit the surface it
/// leaves: OffsetDistance off it, on the side of w.
inline Vec3f OffsetRayOrigin(Vec3f p, float distance, Vec3f ng, Vec3f w) {
  return Fma(ng, Dot(w, ng) < 0 ? -distance : distance, p);
}
inline Vec3f OffsetRayOrigin(const SurfacePoint& point, Vec3f w) {
  return OffsetRayOrigin(point.p, OffsetDistance(point.p, point.p_error, point.ng), point.ng, w);
}

}  // namespace strata
