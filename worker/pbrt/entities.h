#pragma once

#include <absl/container/flat_hash_map.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "worker/pbrt/animated_transform.h"
#include "worker/pbrt/context.h"
#include "worker/pbrt/named_parts.h"
#include "worker/pbrt/parameters.h"
#include "worker/pbrt/values.h"

// The things a pbrt file describes, each read from the parameters of its directive. Defaults are
// pbrt-v4's. All return located errors and add warnings to the context.

namespace strata {

// ---- textures ----

/// Adds textures to the scene and knows the names under which the file defines them. Materials and
/// shapes may name one before its definition, as in pbrt-v4; other textures may not.
class TextureTable {
 public:
  explicit TextureTable(ReadContext& context) : context_(context) {}

  /// Texture "name" "float|spectrum" "class".
  absl::Status Define(const std::string& name, const std::string& value_type,
                      const std::string& texture_class, const Transform& world_from_texture,
                      std::string_view color_space, ParameterReader& parameters);

  /// The texture of a float parameter, which may name one; `fallback` none gives kNoTexture.
  TextureId Float(ParameterReader& parameters, std::string_view name,
                  std::optional<float> fallback);
  /// The texture of a colour parameter, which may name one.
  TextureId Color(ParameterReader& parameters, std::string_view name, std::optional<Rgb> fallback,
                  SpectrumUse use, std::string_view color_space);
  /// An image that no Texture directive names.
  TextureId Image(ImageTexture image) { return Add(std::move(image), 1); }
  /// The same number everywhere.
  TextureId Constant(float value) { return Add(ConstantTexture{Rgb::Gray(value)}, 1); }
  /// The tangent-space normals of the image that the string parameter names; kNoTexture without.
  TextureId NormalMap(ParameterReader& parameters, std::string_view name);
  /// Where the parameter is a constant, its value.
  std::optional<Rgb> ConstantValue(TextureId id) const;
  /// An error for names that were used but never defined.
  absl::Status CheckAllDefined() const;

 private:
  struct Named {
    TextureId id = kNoTexture;
    SourceLocation first_use;
    bool defined = false;
  };
  using Names = absl::flat_hash_map<std::string, Named>;

  TextureId Add(TextureDescription texture, int depth);
  /// The texture that a parameter names, of the kind that `names` has.
  TextureId Find(ParameterReader& parameters, const Parameter& parameter, Names& names);
  absl::Status NoSuchTexture(const std::string& name, const Names& names,
                             const SourceLocation& where) const;
  const Names& OtherThan(const Names& names) const {
    return &names == &floats_ ? spectra_ : floats_;
  }
  /// What Define adds, unnamed.
  absl::StatusOr<TextureId> AddOfClass(const std::string& texture_class, bool scalar,
                                       const Transform& world_from_texture,
                                       std::string_view color_space, ParameterReader& parameters);
  /// "scale" of a scale texture: a number or, as in pbrt-v3 and if not `scalar`, a colour.
  TextureId Factor(ParameterReader& parameters, bool scalar, std::string_view color_space);
  /// One more than the deepest of the inputs; an error beyond what evaluation may recurse.
  int DepthOver(ParameterReader& parameters, std::initializer_list<TextureId> inputs);
  std::optional<ImageTexture> ReadImage(ParameterReader& parameters, bool scalar);

  ReadContext& context_;
  Names floats_, spectra_;
  bool defining_ = false;    ///< Within Define.
  std::vector<int> depths_;  ///< Of each texture of the scene; 1 for leaves.
};

// ---- materials ----

/// Adds materials to the scene. A name may be used before its definition, as in pbrt.
class MaterialTable {
 public:
  MaterialTable(ReadContext& context, TextureTable& textures);

  /// Material "type"; the id of the new material.
  absl::StatusOr<MaterialId> Add(const std::string& type, std::string_view color_space,
                                 ParameterReader& parameters);
  /// MakeNamedMaterial "name".
  absl::Status Define(const std::string& name, std::string_view color_space,
                      ParameterReader& parameters);
  /// NamedMaterial "name".
  MaterialId Use(const std::string& name, const SourceLocation& where);
  /// Errors for names that were used but never defined, and mixes that contain themselves.
  absl::Status CheckAllDefined() const;

 private:
  absl::StatusOr<MaterialDescription> Read(const std::string& type, std::string_view color_space,
                                           ParameterReader& parameters);
  Roughness ReadRoughness(ParameterReader& parameters, const std::string& prefix, bool remap);
  float ReadEta(ParameterReader& parameters, std::string_view name);
  /// Fills either eta and k, whose names have the prefix, or the reflectance.
  void ReadConductor(ParameterReader& parameters, const std::string& prefix,
                     std::string_view color_space, TextureId& eta, TextureId& k,
                     TextureId& reflectance);
  CoatedDiffuseMaterial ReadCoatedDiffuse(ParameterReader& parameters,
                                          std::string_view color_space);
  CoatedConductorMaterial ReadCoatedConductor(ParameterReader& parameters,
                                              std::string_view color_space);
  /// The "normalmap" or the "displacement" of a material of any type.
  SurfaceDetail ReadDetail(ParameterReader& parameters);
  /// Of a power of a cosine; kNoTexture where it is not given and has no default.
  TextureId ReadExponent(ParameterReader& parameters, std::string_view name,
                         std::optional<float> fallback);
  BlinnMaterial ReadBlinn(ParameterReader& parameters, std::string_view color_space);
  AshikhminShirleyMaterial ReadAshikhminShirley(ParameterReader& parameters,
                                                std::string_view color_space);
  MixMaterial ReadMix(ParameterReader& parameters);
  void WarnOfLayers(ParameterReader& parameters);

  ReadContext& context_;
  TextureTable& textures_;
  NamedParts named_;
  std::vector<SourceLocation> where_;  ///< Of each material of the scene.
};

// ---- media ----

/// Adds media to the scene. A name may be used before its definition, as in pbrt.
class MediumTable {
 public:
  explicit MediumTable(ReadContext& context) : context_(context) {}

  /// MakeNamedMedium "name". Media that are not the same everywhere become clear ones, with a
  /// warning.
  absl::Status Define(const std::string& name, std::string_view color_space,
                      ParameterReader& parameters);
  /// A name of MediumInterface; none is empty space.
  MediumId Use(const std::string& name, const SourceLocation& where);
  /// Errors for names that were used but never defined.
  absl::Status CheckAllDefined() const;

 private:
  NamedPart& Find(const std::string& name, const SourceLocation& where);

  ReadContext& context_;
  NamedParts named_;
};

// ---- lights ----

/// LightSource "type".
absl::Status ReadLight(const std::string& type, const Transform& world_from_light,
                       std::string_view color_space, ParameterReader& parameters,
                       ReadContext& context);

/// AreaLightSource "diffuse", whose radiance may depend on the shape it is given to.
struct AreaLight {
  Rgb radiance;
  TextureId image = kNoTexture;  ///< Multiplies the radiance.
  bool two_sided = false;
  std::optional<double> power;  ///< If set, `radiance` is per power / (pi area) of each shape.
  SourceLocation where;
};
absl::StatusOr<AreaLight> ReadAreaLight(const std::string& type, std::string_view color_space,
                                        ParameterReader& parameters, TextureTable& textures,
                                        ReadContext& context);

// ---- shapes ----

/// The "alpha" of a shape; none where it leaves nothing there. That of a shape that is there
/// everywhere is no mask.
std::optional<AlphaMask> ReadAlpha(ParameterReader& parameters, bool emissive,
                                   TextureTable& textures, ReadContext& context);
/// Shape "type": its geometry, where a PLY file is still to be read (mesh_files.h). None (with a
/// warning) when it has no faces.
absl::StatusOr<std::optional<ShapeGeometry>> ReadShape(const std::string& type,
                                                       ParameterReader& parameters,
                                                       ReadContext& context);

/// Whether it is a mesh that has none, nor a file to read them from.
bool IsWithoutFaces(const ShapeGeometry& geometry);
void WarnWithoutFaces(const SourceLocation& where, ReadContext& context);

/// Shape "curve", of any basis and degree.
CurveShape ReadCurve(ParameterReader& parameters);
/// Adds the curves of `next` to those of `shape` if they differ in nothing else: hair is many small
/// shapes. False if they do, or are no curves.
bool JoinCurves(ShapeDescription& shape, const ShapeDescription& next);

/// Errors for a transform that is singular or takes the shape, as far as it is read, beyond what
/// floats hold.
absl::Status CheckPlacement(const ShapeGeometry& geometry, const Transform& to_world,
                            const SourceLocation& where);

/// Whether lengths all scale alike.
bool IsSimilarity(const Transform& transform);

/// The area of a shape in world space. Errors for curved shapes under a transform that is no
/// similarity.
absl::StatusOr<double> WorldArea(const ShapeGeometry& geometry, const Transform& to_world,
                                 const SourceLocation& where);

// ---- camera, film and the other directives before WorldBegin ----

/// The shutter is in seconds still.
absl::Status ReadCamera(const std::string& type, const AnimatedTransform& camera_from_world,
                        ParameterReader& parameters, ReadContext& context);
absl::Status ReadFilm(const std::string& type, ParameterReader& parameters, ReadContext& context);
absl::Status ReadPixelFilter(const std::string& type, ParameterReader& parameters,
                             ReadContext& context);
absl::Status ReadSampler(const std::string& type, ParameterReader& parameters,
                         ReadContext& context);
absl::Status ReadIntegrator(const std::string& type, ParameterReader& parameters,
                            ReadContext& context);

}  // namespace strata
