#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "common/status.h"
#include "worker/bsdf/base_row.h"
#include "worker/bsdf/bsdf.h"
#include "worker/bsdf/mixture_parts.h"
#include "worker/geometry/surface_detail.h"
#include "worker/geometry/texture.h"
#include "worker/scene/description.h"

namespace strata {

/// Room for a BSDF that is made for one point, with the parts of it if it is a mixture.
struct BsdfRoom {
  Bsdf bsdf;
  MixtureParts parts;
};

/// All materials of a scene, ready to be evaluated (PBRT 10.5). Immutable after Build, so
/// thread-safe.
class MaterialSet {
 public:
  /// `textures` outlives the set. INVALID_ARGUMENT with the material's index when a parameter is
  /// out of its range, an id leads nowhere, a mix contains itself, or a sum has too many parts.
  static absl::StatusOr<std::unique_ptr<MaterialSet>> Build(
      std::vector<MaterialDescription> materials, const TextureSet& textures,
      const std::map<MaterialId, SurfaceDetail>& details = {});

  /// How the surface scatters at texture coordinates `uv` and the world-space point `p`. `u_mix` in
  /// [0, 1) chooses among the materials of a mix. An interface lets everything pass. The result is
  /// in `room`, or in the set.
  const Bsdf& Evaluate(MaterialId id, SurfaceUv uv, Vec3f p, float u_mix, BsdfRoom* room) const;
  /// The BSDF of a material that is the same everywhere, without a copy; null for others.
  const Bsdf* Constant(MaterialId id) const {
    const Entry& entry = entries_[id];
    return entry.constant ? &entry.bsdf : nullptr;
  }
  /// One for each material.
  const std::vector<BaseRow>& base_rows() const { return base_rows_; }
  /// Whether the reflectance of any of them varies.
  bool has_base_textures() const { return has_base_textures_; }
  /// Whether it looks the same however it is turned about the shape's own shading normal, so that
  /// any tangent will do.
  bool HasPlainFrame(MaterialId id) const { return entries_[id].plain_frame; }
  /// Whether the shading normal is that of a map, as WithDetail has it.
  bool HasDetail(MaterialId id) const { return entries_[id].has_detail; }
  /// `point`, of a material that has detail, as seen along `wo`; see ApplyDetail. `u_mix` as in
  /// Evaluate.
  SurfacePoint WithDetail(const SurfacePoint& point, const SurfaceDerivatives& derivatives,
                          Vec3f wo, float u_mix) const;

 private:
  /// A material that is the same everywhere is made once.
  struct Entry {
    bool constant = false;
    bool plain_frame = false;
    bool has_detail = false;  ///< Of its own or, in a mix, of a part.
    std::optional<SurfaceDetail> detail;
    Bsdf bsdf;
  };

  explicit MaterialSet(const TextureSet& textures) : textures_(textures) {}
  /// Adds what the sum at `id` consists of at the point, `weight` times.
  void AddParts(MaterialId id, float weight, SurfaceUv uv, Vec3f p, float u_mix,
                MixtureParts* parts) const;
  /// The BSDF of a material that is no mix.
  Bsdf MakeBsdf(MaterialId id, SurfaceUv uv, Vec3f p) const;
  struct Choice {
    MaterialId id = 0;
    float u_mix = 0;  ///< What is left of the random number.
  };
  /// What `id` comes to where it is a mix, but not a sum.
  Choice Choose(MaterialId id, SurfaceUv uv, Vec3f p, float u_mix) const;
  BaseRow BaseRowOf(MaterialId id) const;
  absl::Status SetDetails(const std::map<MaterialId, SurfaceDetail>& details);

  const TextureSet& textures_;
  std::vector<MaterialDescription> materials_;
  std::vector<Entry> entries_;
  std::vector<BaseRow> base_rows_;
  bool has_base_textures_ = false;
  std::map<float, CoatInterface> coats_;        ///< By index of refraction.
  std::map<float, AlbedoTable> trapped_light_;  ///< Of coats over metals, likewise.
  std::unique_ptr<SchlickAlbedo> schlick_;      ///< If a material needs it.
};

}  // namespace strata
