#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "worker/gltf/document.h"
#include "worker/gltf/extension.h"
#include "worker/gltf/textures.h"

namespace strata {

/// Colours of vertices, which multiply the base colour and its alpha: a texture of their own, or
/// one value for all.
struct VertexColor {
  Rgb constant = {1, 1, 1};
  float constant_alpha = 1;
  TextureId color = kNoTexture, alpha = kNoTexture;
};

/// The sets of texture coordinates that a material looks up, as first and second of its meshes; -1:
/// none.
struct CoordinateSets {
  int first = -1, second = -1;
};

/// What a primitive's material makes of its surface.
struct SurfaceDescription {
  MaterialId material = 0;
  std::optional<AreaEmission> emission;
  AlphaMask alpha;
  std::optional<MediumBorder> border;
};

/// Makes the materials of a scene, each once. Both sides of a surface are rendered whether it is
/// doubleSided or not: a path tracer has no use for culling, and light that came through the back
/// of a wall would be wrong. One-sided surfaces emit from their front alone.
class MaterialMaker {
 public:
  explicit MaterialMaker(GltfDocument& document) : document_(document), textures_(document) {}

  /// `index` -1 is glTF's default material. With vertex colours that are a texture the material is
  /// the primitive's own.
  absl::StatusOr<SurfaceDescription> Make(int index, const VertexColor& vertices);

  /// The first is that of the normal map if there is one, as it makes the tangents. Of a third it
  /// warns, and has the first instead.
  absl::StatusOr<CoordinateSets> CoordinatesOf(int index);
  /// Whether the material emits its base colour.
  absl::StatusOr<bool> IsUnlit(int index);

  TextureMaker& textures() { return textures_; }
  /// Whether something shines at all places, and not by a map alone.
  bool has_lamps() const { return has_lamps_; }

 private:
  /// A material with the places of its textures, as the file has it.
  struct Source;
  absl::StatusOr<Source> Read(int index);
  absl::StatusOr<CoordinateSets> CoordinatesOf(const Source& source);
  absl::StatusOr<SurfaceDescription> Build(const Source& source, const VertexColor& vertices);

  absl::StatusOr<TextureId> BaseColor(const Source& source, const VertexColor& vertices);
  /// What of the surface is there: all of it if its alphaMode is OPAQUE.
  absl::StatusOr<AlphaMask> Alpha(const Source& source, const VertexColor& vertices);
  absl::StatusOr<SurfaceDetail> Detail(const Source& source);
  absl::StatusOr<MetallicRoughnessMaterial> MetallicRoughnessOf(const Source& source,
                                                                TextureId base_color);
  /// Of a body with KHR_materials_volume what passes the surface is refracted, as by glass, and
  /// absorbed within.
  absl::Status AddVolume(const Source& source, MetallicRoughnessMaterial material,
                         SurfaceDescription* surface);
  absl::Status AddAttenuation(const GltfExtension& volume, SurfaceDescription* surface);
  absl::Status AddExtensions(const Source& source, MetallicRoughnessMaterial* material);
  absl::StatusOr<std::optional<AreaEmission>> Emission(const Source& source);
  /// The product of the extension's factor and one channel of its texture; kNoTexture if it is
  /// `same` everywhere.
  absl::StatusOr<TextureId> Factor(const GltfExtension& extension, const std::string& factor,
                                   const std::string& texture, int channel, double same);
  MaterialId Add(MaterialDescription material);

  GltfDocument& document_;
  TextureMaker textures_;
  std::map<std::pair<int, std::array<float, 4>>, SurfaceDescription> made_;
  bool has_lamps_ = false;
};

}  // namespace strata
