#include "worker/gltf/materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "common/text.h"

namespace strata {
namespace {

constexpr const char* kClearcoat = "KHR_materials_clearcoat";
constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";
constexpr const char* kIor = "KHR_materials_ior";
constexpr const char* kSpecular = "KHR_materials_specular";
/// Smoother surfaces let light pass in one direction only: GGX's alpha is below 0.001.
constexpr double kClearRoughness = 0.032;
constexpr const char* kTransmission = "KHR_materials_transmission";
constexpr const char* kUnlit = "KHR_materials_unlit";
constexpr const char* kVolume = "KHR_materials_volume";

Rgb ToRgb(const std::vector<double>& color) {
  return {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])};
}

/// Reflectance at normal incidence of a dielectric; index 0 stands for one that reflects all.
float NormalReflectance(double ior) {
  if (ior == 0) return 1;
  const double root = (ior - 1) / (ior + 1);
  return static_cast<float>(root * root);
}

}  // namespace

struct MaterialMaker::Source {
  const tinygltf::Material* material;
  std::string element;
  TextureReference base_color, metallic_roughness, normal, emissive;

  GltfExtension Extension(const GltfDocument& document, const char* name) const {
    return GltfExtension(document, material->extensions, name, element);
  }
};

absl::StatusOr<MaterialMaker::Source> MaterialMaker::Read(int index) {
  static const tinygltf::Material kDefault;
  Source source;
  source.material = &kDefault;
  if (index >= 0) {
    STRATA_ASSIGN_OR_RETURN(source.material, document_.Find(document_.model().materials, index,
                                                            "material", "materials"));
  }
  source.element = ElementName("materials", index);
  const tinygltf::Material& m = *source.material;
  const std::string pbr = source.element + ".pbrMetallicRoughness";
  STRATA_ASSIGN_OR_RETURN(
      source.base_color,
      ReferTo(document_, m.pbrMetallicRoughness.baseColorTexture, pbr + ".baseColorTexture"));
  STRATA_ASSIGN_OR_RETURN(source.metallic_roughness,
                          ReferTo(document_, m.pbrMetallicRoughness.metallicRoughnessTexture,
                                  pbr + ".metallicRoughnessTexture"));
  STRATA_ASSIGN_OR_RETURN(source.normal,
                          ReferTo(document_, m.normalTexture, source.element + ".normalTexture"));
  STRATA_ASSIGN_OR_RETURN(
      source.emissive, ReferTo(document_, m.emissiveTexture, source.element + ".emissiveTexture"));
  const std::vector<double>& base = m.pbrMetallicRoughness.baseColorFactor;
  if (base.size() != 4)
    return document_.Error(pbr + ".baseColorFactor", "it must be an array of 4 numbers");
  if (!m.emissiveFactor.empty() && m.emissiveFactor.size() != 3)
    return document_.Error(source.element + ".emissiveFactor", "it must be an array of 3 numbers");
  return source;
}

absl::StatusOr<CoordinateSets> MaterialMaker::CoordinatesOf(int index) {
  STRATA_ASSIGN_OR_RETURN(const Source source, Read(index));
  return CoordinatesOf(source);
}

absl::StatusOr<CoordinateSets> MaterialMaker::CoordinatesOf(const Source& source) {
  std::vector<TextureReference> all = {source.normal, source.base_color, source.metallic_roughness,
                                       source.emissive};
  for (const auto& [extension, names] :
       std::initializer_list<std::pair<const char*, std::vector<const char*>>>{
           {kTransmission, {"transmissionTexture"}},
           {kSpecular, {"specularTexture", "specularColorTexture"}},
           {kClearcoat, {"clearcoatTexture", "clearcoatRoughnessTexture"}}}) {
    for (const char* name : names) {
      STRATA_ASSIGN_OR_RETURN(const TextureReference reference,
                              ReferTo(document_, source.Extension(document_, extension), name));
      all.push_back(reference);
    }
  }
  CoordinateSets sets;
  for (const TextureReference& reference : all) {
    const int set = reference.tex_coord;
    if (reference.index < 0 || set == sets.first || set == sets.second) continue;
    if (sets.first < 0) {
      sets.first = set;
    } else if (sets.second < 0) {
      sets.second = set;
    } else {
      document_.Warn(reference.element, StrCat("TEXCOORD_", set,
                                               " is a third set in one material, "
                                               "of which two are supported; TEXCOORD_",
                                               sets.first, " is used"));
    }
  }
  return sets;
}

absl::StatusOr<bool> MaterialMaker::IsUnlit(int index) {
  STRATA_ASSIGN_OR_RETURN(const Source source, Read(index));
  return source.Extension(document_, kUnlit).present();
}

absl::StatusOr<SurfaceDescription> MaterialMaker::Make(int index, const VertexColor& vertices) {
  const bool own = vertices.color != kNoTexture || vertices.alpha != kNoTexture;
  const std::array<float, 4> color = {vertices.constant.r, vertices.constant.g, vertices.constant.b,
                                      vertices.constant_alpha};
  if (const auto made = made_.find({index, color}); !own && made != made_.end())
    return made->second;
  STRATA_ASSIGN_OR_RETURN(const Source source, Read(index));
  STRATA_ASSIGN_OR_RETURN(const SurfaceDescription surface, Build(source, vertices));
  if (!own) made_[{index, color}] = surface;
  return surface;
}

absl::StatusOr<SurfaceDescription> MaterialMaker::Build(const Source& source,
                                                        const VertexColor& vertices) {
  const tinygltf::Material& m = *source.material;
  STRATA_ASSIGN_OR_RETURN(const CoordinateSets sets, CoordinatesOf(source));
  textures_.SetSecondCoordinates(sets.second);
  if (m.occlusionTexture.index >= 0)
    document_.Warn(source.element + ".occlusionTexture",
                   "occlusion is left out: the paths find it themselves");
  SurfaceDescription surface;
  STRATA_ASSIGN_OR_RETURN(const TextureId base_color, BaseColor(source, vertices));
  STRATA_ASSIGN_OR_RETURN(surface.alpha, Alpha(source, vertices));
  if (source.Extension(document_, kUnlit).present()) {
    document_.Warn(source.element, "it is unlit: it emits its base colour, and lights others");
    surface.material = Add(DiffuseMaterial{textures_.Constant({})});
    surface.emission =
        AreaEmission{.radiance = {1, 1, 1}, .two_sided = true, .texture = base_color};
    return surface;
  }
  STRATA_ASSIGN_OR_RETURN(MetallicRoughnessMaterial material,
                          MetallicRoughnessOf(source, base_color));
  const size_t first = document_.scene.materials.size();
  STRATA_RETURN_IF_ERROR(AddVolume(source, std::move(material), &surface));
  STRATA_ASSIGN_OR_RETURN(const SurfaceDetail detail, Detail(source));
  for (size_t id = first; detail.Any() && id < document_.scene.materials.size(); ++id) {
    // A mix has the details of its parts.
    if (!std::holds_alternative<MixMaterial>(document_.scene.materials[id]))
      document_.scene.surface_details[static_cast<MaterialId>(id)] = detail;
  }
  STRATA_ASSIGN_OR_RETURN(surface.emission, Emission(source));
  return surface;
}

absl::StatusOr<TextureId> MaterialMaker::BaseColor(const Source& source,
                                                   const VertexColor& vertices) {
  const Rgb factor =
      ToRgb(source.material->pbrMetallicRoughness.baseColorFactor) * vertices.constant;
  TextureId color = vertices.color;
  if (source.base_color.index >= 0) {
    STRATA_ASSIGN_OR_RETURN(const TextureId image, textures_.Color(source.base_color));
    color = textures_.Product(color, image);
  }
  if (color != kNoTexture && factor == Rgb{1, 1, 1}) return color;
  return textures_.Product(color, textures_.Constant(factor));
}

absl::StatusOr<AlphaMask> MaterialMaker::Alpha(const Source& source, const VertexColor& vertices) {
  const tinygltf::Material& m = *source.material;
  if (m.alphaMode == "OPAQUE") return AlphaMask{};
  const float factor =
      static_cast<float>(m.pbrMetallicRoughness.baseColorFactor[3]) * vertices.constant_alpha;
  AlphaMask mask;
  mask.texture = vertices.alpha;
  if (source.base_color.index >= 0) {
    STRATA_ASSIGN_OR_RETURN(const TextureId image, textures_.Alpha(source.base_color));
    mask.texture = textures_.Product(mask.texture, image);
  }
  if (factor != 1)
    mask.texture = textures_.Product(mask.texture, textures_.Constant(Rgb::Gray(factor)));
  if (m.alphaMode == "MASK") mask.cutoff = static_cast<float>(m.alphaCutoff);
  // A cutoff above 1 leaves nothing, even of what has no alpha.
  if (mask.cutoff > 1 && mask.texture == kNoTexture)
    mask.texture = textures_.Constant(Rgb::Gray(1));
  return mask;
}

absl::StatusOr<SurfaceDetail> MaterialMaker::Detail(const Source& source) {
  SurfaceDetail detail;
  if (source.normal.index < 0) return detail;
  STRATA_ASSIGN_OR_RETURN(detail.normal_map, textures_.Color(source.normal, true));
  detail.normal_scale = static_cast<float>(source.normal.scale);
  detail.y_along_v = true;
  return detail;
}

absl::StatusOr<MetallicRoughnessMaterial> MaterialMaker::MetallicRoughnessOf(const Source& source,
                                                                             TextureId base_color) {
  const tinygltf::PbrMetallicRoughness& pbr = source.material->pbrMetallicRoughness;
  MetallicRoughnessMaterial material;
  material.base_color = base_color;
  if (source.metallic_roughness.index >= 0) {
    STRATA_ASSIGN_OR_RETURN(material.roughness,
                            textures_.Channel(source.metallic_roughness, 1, pbr.roughnessFactor));
    STRATA_ASSIGN_OR_RETURN(material.metallic,
                            textures_.Channel(source.metallic_roughness, 2, pbr.metallicFactor));
  } else {
    material.roughness = textures_.Constant(Rgb::Gray(static_cast<float>(pbr.roughnessFactor)));
    material.metallic = textures_.Constant(Rgb::Gray(static_cast<float>(pbr.metallicFactor)));
  }
  STRATA_RETURN_IF_ERROR(AddExtensions(source, &material));
  return material;
}

absl::Status MaterialMaker::AddExtensions(const Source& source,
                                          MetallicRoughnessMaterial* material) {
  const GltfExtension ior = source.Extension(document_, kIor);
  STRATA_ASSIGN_OR_RETURN(const double index, ior.Number("ior", 1.5));
  if (index != 0 && index < 1)
    return document_.Error(ior.element(), "the index must be at least 1");
  material->f0 = NormalReflectance(index);

  const GltfExtension specular = source.Extension(document_, kSpecular);
  STRATA_ASSIGN_OR_RETURN(const double strength, specular.Number("specularFactor", 1));
  STRATA_ASSIGN_OR_RETURN(const TextureReference map,
                          ReferTo(document_, specular, "specularTexture"));
  if (map.index >= 0) {
    STRATA_ASSIGN_OR_RETURN(material->specular, textures_.Alpha(map));
  }
  if (strength != 1)
    material->specular = textures_.Product(
        material->specular, textures_.Constant(Rgb::Gray(static_cast<float>(strength))));
  STRATA_ASSIGN_OR_RETURN(const std::vector<double> color,
                          specular.Numbers("specularColorFactor", {1, 1, 1}));
  STRATA_ASSIGN_OR_RETURN(const TextureReference color_map,
                          ReferTo(document_, specular, "specularColorTexture"));
  if (color_map.index >= 0) {
    STRATA_ASSIGN_OR_RETURN(material->specular_color, textures_.Color(color_map));
  }
  if (ToRgb(color) != Rgb{1, 1, 1})
    material->specular_color =
        textures_.Product(material->specular_color, textures_.Constant(ToRgb(color)));

  const GltfExtension coat = source.Extension(document_, kClearcoat);
  STRATA_ASSIGN_OR_RETURN(material->coat,
                          Factor(coat, "clearcoatFactor", "clearcoatTexture", 0, 0));
  if (material->coat != kNoTexture) {
    STRATA_ASSIGN_OR_RETURN(material->coat_roughness, Factor(coat, "clearcoatRoughnessFactor",
                                                             "clearcoatRoughnessTexture", 1, 0));
    if (coat.Has("clearcoatNormalTexture"))
      document_.Warn(coat.element(), "the coat has the normals of what is below it");
  }

  const GltfExtension transmission = source.Extension(document_, kTransmission);
  STRATA_ASSIGN_OR_RETURN(material->transmission,
                          Factor(transmission, "transmissionFactor", "transmissionTexture", 0, 0));
  const double roughness = source.material->pbrMetallicRoughness.roughnessFactor;
  if (material->transmission != kNoTexture && roughness < kClearRoughness &&
      !document_.model().lights.empty())
    document_.Warn(transmission.element(),
                   StrCat("where its roughness is below ", kClearRoughness,
                          ", the light of punctual lights does not come through; give it more, or "
                          "use lights of some size"));
  return absl::OkStatus();
}

absl::Status MaterialMaker::AddVolume(const Source& source, MetallicRoughnessMaterial material,
                                      SurfaceDescription* surface) {
  const GltfExtension volume = source.Extension(document_, kVolume);
  STRATA_ASSIGN_OR_RETURN(const double thickness, volume.Number("thicknessFactor", 0));
  if (thickness <= 0 || material.transmission == kNoTexture) {
    surface->material = Add(std::move(material));
    return absl::OkStatus();
  }
  STRATA_RETURN_IF_ERROR(AddAttenuation(volume, surface));
  const auto* color = std::get_if<ConstantTexture>(&document_.scene.textures[material.base_color]);
  if (!color || color->value != Rgb{1, 1, 1})
    document_.Warn(volume.element(), "the base colour does not tint the light that passes");
  STRATA_ASSIGN_OR_RETURN(const double index, source.Extension(document_, kIor).Number("ior", 1.5));
  const TextureId passing = std::exchange(material.transmission, kNoTexture);
  DielectricMaterial glass;
  glass.eta = static_cast<float>(std::clamp(index, 1.0, 100.0));
  const TextureId alpha = textures_.Product(material.roughness, material.roughness);
  glass.roughness = {.u = alpha, .v = alpha, .remap = false};
  const TextureId dielectric = textures_.Add(MixTexture{.a = textures_.Constant({1, 1, 1}),
                                                        .b = textures_.Constant({}),
                                                        .amount = material.metallic});
  const MaterialId border = Add(std::move(material)), interior = Add(std::move(glass));
  surface->material = Add(
      MixMaterial{.a = border, .b = interior, .amount = textures_.Product(passing, dielectric)});
  return absl::OkStatus();
}

absl::Status MaterialMaker::AddAttenuation(const GltfExtension& volume,
                                           SurfaceDescription* surface) {
  if (!volume.Has("attenuationDistance")) return absl::OkStatus();
  STRATA_ASSIGN_OR_RETURN(const double distance, volume.Number("attenuationDistance", 0));
  STRATA_ASSIGN_OR_RETURN(const std::vector<double> color,
                          volume.Numbers("attenuationColor", {1, 1, 1}));
  if (!(distance > 0))
    return document_.Error(volume.element(), "attenuationDistance must be positive");
  // What is left of white light after the distance; of black no more than this.
  constexpr double kLeast = 1e-6;
  const auto absorption = [&](double left) {
    return static_cast<float>(-std::log(std::clamp(left, kLeast, 1.0)) / distance);
  };
  MediumDescription medium;
  medium.where = document_.At(volume.element());
  medium.absorption = {absorption(color[0]), absorption(color[1]), absorption(color[2])};
  surface->border = MediumBorder{static_cast<MediumId>(document_.scene.media.size()), kNoMedium};
  document_.scene.media.push_back(medium);
  return absl::OkStatus();
}

absl::StatusOr<TextureId> MaterialMaker::Factor(const GltfExtension& extension,
                                                const std::string& factor,
                                                const std::string& texture, int channel,
                                                double same) {
  STRATA_ASSIGN_OR_RETURN(const double value, extension.Number(factor, same));
  STRATA_ASSIGN_OR_RETURN(const TextureReference reference, ReferTo(document_, extension, texture));
  if (reference.index >= 0 && value != 0) return textures_.Channel(reference, channel, value);
  if (value == same) return kNoTexture;
  return textures_.Constant(Rgb::Gray(static_cast<float>(value)));
}

absl::StatusOr<std::optional<AreaEmission>> MaterialMaker::Emission(const Source& source) {
  const tinygltf::Material& m = *source.material;
  const GltfExtension extension = source.Extension(document_, kEmissiveStrength);
  STRATA_ASSIGN_OR_RETURN(const double strength, extension.Number("emissiveStrength", 1));
  AreaEmission emission;
  if (!m.emissiveFactor.empty())
    emission.radiance = ToRgb(m.emissiveFactor) * static_cast<float>(strength);
  const Rgb radiance = emission.radiance;
  if (!IsFinite(radiance) || std::min({radiance.r, radiance.g, radiance.b}) < 0)
    return document_.Error(source.element + ".emissiveFactor",
                           "radiance must be finite and not negative");
  if (IsBlack(radiance)) return std::nullopt;
  emission.two_sided = m.doubleSided;
  if (source.emissive.index >= 0) {
    STRATA_ASSIGN_OR_RETURN(emission.texture, textures_.Color(source.emissive));
  } else {
    has_lamps_ = true;
  }
  return emission;
}

MaterialId MaterialMaker::Add(MaterialDescription material) {
  document_.scene.materials.push_back(std::move(material));
  return static_cast<MaterialId>(document_.scene.materials.size()) - 1;
}

}  // namespace strata
