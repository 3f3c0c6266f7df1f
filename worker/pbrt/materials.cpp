#include <algorithm>
#include <set>

#include "worker/pbrt/entities.h"

namespace strata {
namespace {

constexpr int kMaxMixDepth = 16;

/// The colour of a named metal's index, as pbrt's default for conductors.
Rgb NamedIndex(std::string_view name, ReadContext& context) {
  Parameter parameter;
  parameter.type = "spectrum";
  parameter.strings = {std::string(name)};
  return *ReadColor(parameter, SpectrumUse::kUnbounded, "srgb", context);
}

}  // namespace

MaterialTable::MaterialTable(ReadContext& context, TextureTable& textures)
    : context_(context), textures_(textures) {
  // Shapes before any Material are of pbrt's default.
  ParameterReader none("Material \"diffuse\"", {}, {});
  const TextureId gray =
      textures_.Color(none, "reflectance", Rgb::Gray(0.5f), SpectrumUse::kReflectance, "srgb");
  context_.scene.materials.push_back(DiffuseMaterial{gray});
  where_.emplace_back();
}

Roughness MaterialTable::ReadRoughness(ParameterReader& parameters, const std::string& prefix,
                                       bool remap) {
  // "roughness" stands in for whichever of the two is not given.
  Roughness roughness;
  roughness.remap = remap;
  const TextureId both = textures_.Float(parameters, prefix + "roughness", std::nullopt);
  roughness.u = textures_.Float(parameters, prefix + "uroughness", std::nullopt);
  roughness.v = textures_.Float(parameters, prefix + "vroughness", std::nullopt);
  if (roughness.u == kNoTexture) roughness.u = both;
  if (roughness.v == kNoTexture) roughness.v = both;
  for (const TextureId id : {roughness.u, roughness.v}) {
    const std::optional<Rgb> value = textures_.ConstantValue(id);
    if (value && value->r < 0) parameters.Fail(parameters.where(), "a roughness is negative");
  }
  return roughness;
}

float MaterialTable::ReadEta(ParameterReader& parameters, std::string_view name) {
  double eta = 1.5;
  if (const Parameter* parameter = parameters.Take(name)) {
    if (parameter->type == "spectrum") {
      absl::StatusOr<Spectrum> spectrum = ReadSpectrum(*parameter, context_);
      if (!spectrum.ok()) {
        parameters.Fail(spectrum.status());
        return 1.5f;
      }
      eta = AtSodiumLine(*spectrum);
      context_.Warn(parameter->where,
                    "the refractive index is taken at 589 nm for all colours; there is no "
                    "dispersion");
    } else {
      eta = parameters.Float(name, eta);
    }
    if (!(eta > 0)) {
      parameters.Fail(parameter->where, StrCat("\"", name, "\" must be more than 0, not ", eta));
    }
  }
  return static_cast<float>(eta);
}

void MaterialTable::ReadConductor(ParameterReader& parameters, const std::string& prefix,
                                  std::string_view color_space, TextureId& eta, TextureId& k,
                                  TextureId& reflectance) {
  reflectance = textures_.Color(parameters, "reflectance", std::nullopt, SpectrumUse::kReflectance,
                                color_space);
  if (reflectance != kNoTexture) {
    if (parameters.Has(prefix + "eta") || parameters.Has(prefix + "k")) {
      parameters.Fail(parameters.where(),
                      StrCat("\"reflectance\" excludes \"", prefix, "eta\" and \"", prefix, "k\""));
    }
    return;
  }
  eta = textures_.Color(parameters, prefix + "eta", NamedIndex("metal-Cu-eta", context_),
                        SpectrumUse::kUnbounded, color_space);
  k = textures_.Color(parameters, prefix + "k", NamedIndex("metal-Cu-k", context_),
                      SpectrumUse::kUnbounded, color_space);
}

void MaterialTable::WarnOfLayers(ParameterReader& parameters) {
  // The closed form of the coats has no random walk to bound, and no phase function.
  parameters.Integer("maxdepth", 10);
  parameters.Integer("nsamples", 1);
  if (textures_.ConstantValue(textures_.Float(parameters, "g", 0.0f)) != Rgb{}) {
    context_.Warn(parameters.where(), "the asymmetry \"g\" of a coat's layer is ignored");
  }
}

CoatedDiffuseMaterial MaterialTable::ReadCoatedDiffuse(ParameterReader& parameters,
                                                       std::string_view color_space) {
  CoatedDiffuseMaterial m;
  m.roughness = ReadRoughness(parameters, "", parameters.Bool("remaproughness", true));
  m.reflectance = textures_.Color(parameters, "reflectance", Rgb::Gray(0.5f),
                                  SpectrumUse::kReflectance, color_space);
  m.eta = ReadEta(parameters, "eta");
  m.albedo = textures_.Color(parameters, "albedo", Rgb{}, SpectrumUse::kReflectance, color_space);
  m.thickness = static_cast<float>(parameters.Float("thickness", 0.01));
  WarnOfLayers(parameters);
  return m;
}

CoatedConductorMaterial MaterialTable::ReadCoatedConductor(ParameterReader& parameters,
                                                           std::string_view color_space) {
  CoatedConductorMaterial m;
  const bool remap = parameters.Bool("remaproughness", true);
  m.interface_roughness = ReadRoughness(parameters, "interface.", remap);
  m.conductor_roughness = ReadRoughness(parameters, "conductor.", remap);
  m.interface_eta = ReadEta(parameters, "interface.eta");
  ReadConductor(parameters, "conductor.", color_space, m.eta, m.k, m.reflectance);
  if (parameters.Has("thickness") && parameters.Float("thickness", 0.01) != 0.01) {
    context_.Warn(parameters.where(),
                  "the \"thickness\" of a coated conductor's layer is ignored; it is 0.01");
  }
  if (textures_.ConstantValue(textures_.Color(parameters, "albedo", Rgb{},
                                              SpectrumUse::kReflectance, color_space)) != Rgb{}) {
    context_.Warn(parameters.where(), "the \"albedo\" of a coated conductor's layer is ignored");
  }
  WarnOfLayers(parameters);
  return m;
}

BlinnMaterial MaterialTable::ReadBlinn(ParameterReader& parameters, std::string_view color_space) {
  BlinnMaterial m;
  const Parameter* eta = parameters.Take("eta");
  if (eta && eta->type == "float") {
    // A dielectric; metals have spectra.
    const float index = ReadEta(parameters, "eta");
    if (parameters.Has("k") || parameters.Has("reflectance"))
      parameters.Fail(eta->where, "a \"float eta\" excludes \"k\" and \"reflectance\"");
    m.eta = textures_.Constant(index);
    m.k = textures_.Constant(0);
  } else {
    ReadConductor(parameters, "", color_space, m.eta, m.k, m.reflectance);
  }
  m.exponent = ReadExponent(parameters, "exponent", 100);
  return m;
}

AshikhminShirleyMaterial MaterialTable::ReadAshikhminShirley(ParameterReader& parameters,
                                                             std::string_view color_space) {
  AshikhminShirleyMaterial m;
  m.reflectance = textures_.Color(parameters, "reflectance", Rgb::Gray(0.5f),
                                  SpectrumUse::kReflectance, color_space);
  m.specular = textures_.Color(parameters, "specular", Rgb::Gray(0.05f), SpectrumUse::kReflectance,
                               color_space);
  const TextureId both = ReadExponent(parameters, "exponent", 100);
  m.u_exponent = ReadExponent(parameters, "uexponent", std::nullopt);
  m.v_exponent = ReadExponent(parameters, "vexponent", std::nullopt);
  if (m.u_exponent == kNoTexture) m.u_exponent = both;
  if (m.v_exponent == kNoTexture) m.v_exponent = both;
  return m;
}

TextureId MaterialTable::ReadExponent(ParameterReader& parameters, std::string_view name,
                                      std::optional<float> fallback) {
  const TextureId id = textures_.Float(parameters, name, fallback);
  const std::optional<Rgb> value = textures_.ConstantValue(id);
  if (value && !(value->r >= 0))
    parameters.Fail(parameters.where(), StrCat("\"", name, "\" must be 0 or more"));
  return id;
}

SurfaceDetail MaterialTable::ReadDetail(ParameterReader& parameters) {
  SurfaceDetail detail;
  detail.normal_map = textures_.NormalMap(parameters, "normalmap");
  const TextureId displacement = textures_.Float(parameters, "displacement", std::nullopt);
  // A height that is the same everywhere turns no normal.
  if (textures_.ConstantValue(displacement)) return detail;
  if (detail.Any() && displacement != kNoTexture) {
    context_.Warn(parameters.where(),
                  "a material has either a \"normalmap\" or a \"displacement\"; the latter is "
                  "ignored");
    return detail;
  }
  detail.displacement = displacement;
  return detail;
}

MixMaterial MaterialTable::ReadMix(ParameterReader& parameters) {
  MixMaterial mix;
  const std::vector<std::string> names = parameters.Strings("materials");
  if (names.size() != 2) {
    parameters.Fail(parameters.where(),
                    StrCat(parameters.directive(), " wants \"string materials\" of two names"));
    return mix;
  }
  mix.a = Use(names[0], parameters.where());
  mix.b = Use(names[1], parameters.where());
  mix.amount = textures_.Float(parameters, "amount", 0.5f);
  return mix;
}

absl::StatusOr<MaterialDescription> MaterialTable::Read(const std::string& type,
                                                        std::string_view color_space,
                                                        ParameterReader& parameters) {
  const auto color = [&](std::string_view name, float fallback) {
    return textures_.Color(parameters, name, Rgb::Gray(fallback), SpectrumUse::kReflectance,
                           color_space);
  };
  const auto remap = [&] { return parameters.Bool("remaproughness", true); };

  if (type == "diffuse") return DiffuseMaterial{color("reflectance", 0.5f)};
  if (type == "conductor") {
    ConductorMaterial m;
    ReadConductor(parameters, "", color_space, m.eta, m.k, m.reflectance);
    m.roughness = ReadRoughness(parameters, "", remap());
    return m;
  }
  if (type == "dielectric") {
    return DielectricMaterial{ReadEta(parameters, "eta"), ReadRoughness(parameters, "", remap())};
  }
  if (type == "thindielectric") return ThinDielectricMaterial{ReadEta(parameters, "eta")};
  if (type == "coateddiffuse") return ReadCoatedDiffuse(parameters, color_space);
  if (type == "coatedconductor") return ReadCoatedConductor(parameters, color_space);
  if (type == "diffusetransmission") {
    return DiffuseTransmissionMaterial{color("reflectance", 0.25f), color("transmittance", 0.25f),
                                       static_cast<float>(parameters.Float("scale", 1))};
  }
  if (type == "blinn") return ReadBlinn(parameters, color_space);
  if (type == "ashikhminshirley") return ReadAshikhminShirley(parameters, color_space);
  if (type == "mix") return ReadMix(parameters);
  if (type == "mixture") {
    MixMaterial sum = ReadMix(parameters);
    sum.sum = true;
    return sum;
  }
  if (type == "interface" || type.empty()) return InterfaceMaterial{};
  return ErrorAt(parameters.where(),
                 StrCat("material \"", type,
                        "\" is not supported; use diffuse, conductor, "
                        "dielectric, thindielectric, coateddiffuse, coatedconductor, "
                        "diffusetransmission, mix, interface, blinn, ashikhminshirley or "
                        "mixture"));
}

absl::StatusOr<MaterialId> MaterialTable::Add(const std::string& type, std::string_view color_space,
                                              ParameterReader& parameters) {
  SurfaceDetail detail = ReadDetail(parameters);
  if (detail.Any() && (type == "mix" || type == "interface")) {
    context_.Warn(
        parameters.where(),
        StrCat("the \"normalmap\" or \"displacement\" of a material \"", type, "\" is ignored"));
    detail = {};
  }
  STRATA_ASSIGN_OR_RETURN(MaterialDescription material, Read(type, color_space, parameters));
  STRATA_RETURN_IF_ERROR(parameters.Finish(context_.warnings));
  context_.scene.materials.push_back(std::move(material));
  where_.push_back(parameters.where());
  const auto id = static_cast<MaterialId>(where_.size() - 1);
  if (detail.Any()) context_.scene.surface_details[id] = detail;
  return id;
}

absl::Status MaterialTable::Define(const std::string& name, std::string_view color_space,
                                   ParameterReader& parameters) {
  if (!parameters.Has("type")) {
    return ErrorAt(parameters.where(),
                   StrCat("MakeNamedMaterial \"", name, "\" wants a \"string type\""));
  }
  const std::string type = parameters.String("type", "");
  STRATA_ASSIGN_OR_RETURN(const MaterialId id, Add(type, color_space, parameters));
  NamedPart& named = named_[name];
  if (named.defined) {
    context_.Warn(parameters.where(), StrCat("material \"", name,
                                             "\" is defined again, as only pbrt-v3 allows; what "
                                             "follows has this one"));
    named.id = id;
  } else if (named.first_use.line == 0) {
    named.id = id;
  } else {
    // Used before: the slot that was reserved then becomes the definition.
    context_.scene.materials[named.id] = std::move(context_.scene.materials[id]);
    context_.scene.materials.pop_back();
    where_[named.id] = where_[id];
    where_.pop_back();
    if (auto detail = context_.scene.surface_details.extract(id)) {
      detail.key() = named.id;
      context_.scene.surface_details.insert(std::move(detail));
    }
  }
  named.defined = true;
  return absl::OkStatus();
}

MaterialId MaterialTable::Use(const std::string& name, const SourceLocation& where) {
  const auto [it, is_new] = named_.try_emplace(name);
  if (is_new) {
    context_.scene.materials.push_back(DiffuseMaterial{});  // until it is defined
    where_.push_back(where);
    it->second = {static_cast<MaterialId>(where_.size() - 1), where, false};
  }
  return it->second.id;
}

absl::Status MaterialTable::CheckAllDefined() const {
  STRATA_RETURN_IF_ERROR(strata::CheckAllDefined(named_, [](std::string_view name) {
    return StrCat("material \"", name, "\" is not defined; define it with MakeNamedMaterial");
  }));
  // Mixes are chosen from by recursion: their depth is bounded, and so they have no cycles.
  const std::vector<MaterialDescription>& materials = context_.scene.materials;
  std::vector<int> depth(materials.size(), 0);
  for (int round = 0; round <= kMaxMixDepth; ++round) {
    bool changed = false;
    for (size_t i = 0; i < materials.size(); ++i) {
      const auto* mix = std::get_if<MixMaterial>(&materials[i]);
      if (!mix) continue;
      const int below = 1 + std::max(depth[mix->a], depth[mix->b]);
      if (below > kMaxMixDepth) {
        return ErrorAt(where_[i], StrCat("mix materials contain themselves, or are nested "
                                         "more than ",
                                         kMaxMixDepth, " deep"));
      }
      changed |= below > depth[i];
      depth[i] = std::max(depth[i], below);
    }
    if (!changed) break;
  }
  return absl::OkStatus();
}

}  // namespace strata
