#include "worker/bsdf/material.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "worker/scene/references.h"

namespace strata {
namespace {

/// Mixes, whose parts are not asked, are taken for what may be turned.
bool IsIsotropicMaterial(const MaterialDescription& material, const TextureSet& textures) {
  const auto even = [&](const Roughness& roughness) {
    const TextureId u = roughness.u, v = roughness.v;
    if (u == v) return true;
    const auto constant = [&](TextureId id) { return id != kNoTexture && textures.IsConstant(id); };
    return constant(u) && constant(v) && textures.Eval(u, {}, {}) == textures.Eval(v, {}, {});
  };
  if (const auto* m = std::get_if<ConductorMaterial>(&material)) return even(m->roughness);
  if (const auto* m = std::get_if<DielectricMaterial>(&material)) return even(m->roughness);
  if (const auto* m = std::get_if<CoatedDiffuseMaterial>(&material)) return even(m->roughness);
  if (const auto* m = std::get_if<CoatedConductorMaterial>(&material))
    return even(m->interface_roughness) && even(m->conductor_roughness);
  if (const auto* m = std::get_if<AshikhminShirleyMaterial>(&material))
    return even({m->u_exponent, m->v_exponent});
  return !std::holds_alternative<MixMaterial>(material);
}

/// The index of a coat, 0 for materials without one.
float CoatEta(const MaterialDescription& material) {
  if (const auto* m = std::get_if<CoatedDiffuseMaterial>(&material)) return m->eta;
  if (const auto* m = std::get_if<CoatedConductorMaterial>(&material)) return m->interface_eta;
  return 0;
}

/// Empty when the numbers that are no textures are in their ranges, else what is wrong.
std::string NumbersProblem(const MaterialDescription& material) {
  const float coat_eta = CoatEta(material);
  if (coat_eta != 0 && !(coat_eta >= 1 && coat_eta <= 100)) {
    return absl::StrCat("the index of a coat must be 1 to 100, not ", coat_eta);
  }
  float eta = 1;
  if (const auto* m = std::get_if<DielectricMaterial>(&material)) eta = m->eta;
  if (const auto* m = std::get_if<ThinDielectricMaterial>(&material)) eta = m->eta;
  if (!(eta >= 0.01f && eta <= 100)) {
    return absl::StrCat("the index of refraction must be 0.01 to 100, not ", eta);
  }
  if (const auto* m = std::get_if<CoatedDiffuseMaterial>(&material);
      m && !(m->thickness >= 0 && std::isfinite(m->thickness))) {
    return absl::StrCat("the thickness of a coat must be 0 or more, not ", m->thickness);
  }
  if (const auto* m = std::get_if<DiffuseTransmissionMaterial>(&material);
      m && !(m->scale >= 0 && std::isfinite(m->scale))) {
    return absl::StrCat("the scale of a diffuse transmission must be 0 or more, not ", m->scale);
  }
  if (const auto* m = std::get_if<MetallicRoughnessMaterial>(&material);
      m && !(m->f0 >= 0 && m->f0 <= 1)) {
    return absl::StrCat("the reflectance at normal incidence must be 0 to 1, not ", m->f0);
  }
  return "";
}

/// Where a walk over the mixes has been.
enum class Visit : uint8_t { kNever, kOpen, kDone };

/// False when the mix at `id` contains itself. Depth first; `seen` is shared between calls.
bool MixesEnd(const std::vector<MaterialDescription>& materials, MaterialId id,
              std::vector<Visit>& seen) {
  const auto* mix = std::get_if<MixMaterial>(&materials[id]);
  if (!mix || seen[id] == Visit::kDone) return true;
  if (seen[id] == Visit::kOpen) return false;
  seen[id] = Visit::kOpen;
  const bool ends = MixesEnd(materials, mix->a, seen) && MixesEnd(materials, mix->b, seen);
  seen[id] = Visit::kDone;
  return ends;
}

/// How many BSDFs a point of the material may be the sum of.
int MostParts(const std::vector<MaterialDescription>& materials, MaterialId id) {
  const auto* mix = std::get_if<MixMaterial>(&materials[id]);
  if (!mix) return 1;
  const int a = MostParts(materials, mix->a), b = MostParts(materials, mix->b);
  return std::min(mix->sum ? a + b : std::max(a, b), MixtureParts::kMax + 1);
}

Rgb Clamp01(Rgb c) {
  return {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
}
Rgb AtLeast(Rgb c, float least) {
  return {std::max(c.r, least), std::max(c.g, least), std::max(c.b, least)};
}

/// A material's parameters at one point.
struct Lookup {
  const TextureSet& textures;
  const std::map<float, CoatInterface>& coats;
  const std::map<float, AlbedoTable>& trapped_light;
  const SchlickAlbedo* schlick;  ///< Null where no material needs it.
  SurfaceUv uv;
  Vec3f p;

  Rgb Color(TextureId id) const { return textures.Eval(id, uv, p); }
  Rgb Reflectance(TextureId id) const { return Clamp01(Color(id)); }
  Rgb ReflectanceOr(TextureId id, Rgb otherwise) const {
    return id == kNoTexture ? otherwise : Reflectance(id);
  }
  /// Not negative, and without an upper end.
  Rgb FactorOr(TextureId id, Rgb otherwise) const {
    if (id == kNoTexture) return otherwise;
    const Rgb c = Color(id);
    return {std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)};
  }
  float FractionOr(TextureId id, float otherwise) const {
    return id == kNoTexture ? otherwise : std::clamp(Color(id).r, 0.0f, 1.0f);
  }

  Ggx Microfacets(const Roughness& roughness) const {
    const auto alpha = [&](TextureId id) {
      const float value = std::clamp(id == kNoTexture ? 0 : Color(id).r, 0.0f, 1.0f);
      return roughness.remap ? std::sqrt(value) : value;
    };
    const float u = alpha(roughness.u);
    return Ggx::FromAlpha(u, roughness.v == roughness.u ? u : alpha(roughness.v));
  }

  /// Beyond the largest a lobe is narrower than directions are exact.
  float Exponent(TextureId id) const {
    constexpr float kLargest = 1e6f;
    const float exponent = Color(id).r;
    return exponent > 0 ? std::min(exponent, kLargest) : 0;
  }

  struct Metal {
    Rgb eta, k;
  };
  /// By its index, or the metal of eta 1 that has a reflectance at normal incidence.
  Metal MetalIndex(TextureId eta, TextureId k, TextureId reflectance) const {
    // An index of 0 is no metal, and 0 / 0 for Fresnel.
    if (reflectance == kNoTexture) return {AtLeast(Color(eta), 1e-3f), AtLeast(Color(k), 0)};
    const auto k_of = [](float r) {
      const float below_one = std::clamp(r, 0.0f, 0.9999f);
      return 2 * std::sqrt(below_one / (1 - below_one));
    };
    const Rgb r = Color(reflectance);
    return {Rgb::Gray(1), {k_of(r.r), k_of(r.g), k_of(r.b)}};
  }

  Coat CoatOf(float eta, const Roughness& roughness, float thickness, TextureId albedo) const {
    // The layer's extinction is 1 per unit; what it scatters goes on as if it were not.
    const Rgb scattered = albedo == kNoTexture ? Rgb{} : Reflectance(albedo);
    return {&coats.at(eta), Microfacets(roughness), (Rgb::Gray(1) - scattered) * thickness};
  }

  Bsdf operator()(const DiffuseMaterial& m) const {
    return DiffuseBsdf{Reflectance(m.reflectance)};
  }
  Bsdf operator()(const ConductorMaterial& m) const {
    const Metal metal = MetalIndex(m.eta, m.k, m.reflectance);
    return ConductorBsdf{metal.eta, metal.k, Microfacets(m.roughness)};
  }
  Bsdf operator()(const DielectricMaterial& m) const {
    return DielectricBsdf{m.eta, Microfacets(m.roughness)};
  }
  Bsdf operator()(const ThinDielectricMaterial& m) const { return ThinDielectricBsdf{m.eta}; }
  Bsdf operator()(const CoatedDiffuseMaterial& m) const {
    return CoatedDiffuseBsdf(CoatOf(m.eta, m.roughness, m.thickness, m.albedo),
                             Reflectance(m.reflectance));
  }
  Bsdf operator()(const CoatedConductorMaterial& m) const {
    const Metal metal = MetalIndex(m.eta, m.k, m.reflectance);
    const float inverse_eta = 1 / m.interface_eta;
    return CoatedConductorBsdf(
        CoatOf(m.interface_eta, m.interface_roughness, kConductorCoatThickness, kNoTexture),
        &trapped_light.at(m.interface_eta), metal.eta * inverse_eta, metal.k * inverse_eta,
        Microfacets(m.conductor_roughness));
  }
  Bsdf operator()(const DiffuseTransmissionMaterial& m) const {
    return DiffuseTransmissionBsdf{Clamp01(Color(m.reflectance) * m.scale),
                                   Clamp01(Color(m.transmittance) * m.scale)};
  }
  Bsdf operator()(const BlinnMaterial& m) const {
    const Metal metal = MetalIndex(m.eta, m.k, m.reflectance);
    return BlinnBsdf{metal.eta, metal.k, Exponent(m.exponent)};
  }
  Bsdf operator()(const AshikhminShirleyMaterial& m) const {
    return AshikhminShirleyBsdf{Reflectance(m.reflectance),
                                Reflectance(m.specular),
                                {Exponent(m.u_exponent), Exponent(m.v_exponent)}};
  }
  Bsdf operator()(const MetallicRoughnessMaterial& m) const {
    const float roughness = FractionOr(m.roughness, 1);
    const float coat_roughness = FractionOr(m.coat_roughness, 0);
    return MetallicRoughnessBsdf(schlick,
                                 {.base_color = ReflectanceOr(m.base_color, Rgb::Gray(1)),
                                  .metallic = FractionOr(m.metallic, 1),
                                  .alpha = roughness * roughness,
                                  .f0 = m.f0,
                                  .specular_color = FactorOr(m.specular_color, Rgb::Gray(1)),
                                  .specular = FractionOr(m.specular, 1),
                                  .transmission = FractionOr(m.transmission, 0),
                                  .coat = FractionOr(m.coat, 0),
                                  .coat_alpha = coat_roughness * coat_roughness});
  }
  /// Mixes are resolved before; an interface is glass of index 1.
  Bsdf operator()(const MixMaterial&) const { return ThinDielectricBsdf{1}; }
  Bsdf operator()(const InterfaceMaterial&) const { return ThinDielectricBsdf{1}; }

  /// pbrt-v4's default; the description of coated conductors has none of its own.
  static constexpr float kConductorCoatThickness = 0.01f;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MaterialSet>> MaterialSet::Build(
    std::vector<MaterialDescription> materials, const TextureSet& textures,
    const std::map<MaterialId, SurfaceDetail>& details) {
  std::unique_ptr<MaterialSet> set(new MaterialSet(textures));
  const auto count = static_cast<MaterialId>(materials.size());
  const auto error = [](MaterialId id, const std::string& problem) {
    return absl::InvalidArgumentError(absl::StrCat("material ", id, ": ", problem));
  };
  const auto exists = [&](MaterialId id) { return id >= 0 && id < count; };
  for (MaterialId id = 0; id < count; ++id) {
    const std::string problem = NumbersProblem(materials[id]);
    if (!problem.empty()) return error(id, problem);
    const auto* mix = std::get_if<MixMaterial>(&materials[id]);
    if (mix && !(exists(mix->a) && exists(mix->b))) {
      return error(id, "the mix names a material that does not exist");
    }
  }
  std::vector<Visit> seen(materials.size(), Visit::kNever);
  for (MaterialId id = 0; id < count; ++id) {
    if (!MixesEnd(materials, id, seen)) return error(id, "the mix contains itself");
    if (MostParts(materials, id) > MixtureParts::kMax)
      return error(id, absl::StrCat("the sum has more than ", MixtureParts::kMax,
                                    " parts, with those of its materials"));
    if (const float eta = CoatEta(materials[id]); eta != 0) set->coats_.try_emplace(eta, eta);
    if (const auto* m = std::get_if<CoatedConductorMaterial>(&materials[id]);
        m && !set->trapped_light_.contains(m->interface_eta)) {
      set->trapped_light_.emplace(m->interface_eta, TabulateTrappedLight(m->interface_eta));
    }
    if (std::holds_alternative<MetallicRoughnessMaterial>(materials[id]) && !set->schlick_)
      set->schlick_ = std::make_unique<SchlickAlbedo>();
  }
  set->materials_ = std::move(materials);
  for (const MaterialDescription& material : set->materials_) {
    Entry entry;
    entry.plain_frame = IsIsotropicMaterial(material, textures);
    entry.constant = !std::holds_alternative<MixMaterial>(material);
    ForEachTexture(material, [&](TextureId id) {
      if (id != kNoTexture && !textures.IsConstant(id)) entry.constant = false;
    });
    if (entry.constant)
      entry.bsdf = std::visit(
          Lookup{textures, set->coats_, set->trapped_light_, set->schlick_.get(), {}, {}},
          material);
    set->entries_.push_back(entry);
  }
  STRATA_RETURN_IF_ERROR(set->SetDetails(details));
  for (MaterialId id = 0; id < count; ++id) {
    set->base_rows_.push_back(set->BaseRowOf(id));
    if (set->base_rows_.back().flags & BaseRow::kTexture) set->has_base_textures_ = true;
  }
  return set;
}

BaseRow MaterialSet::BaseRowOf(MaterialId id) const {
  const auto* diffuse = std::get_if<DiffuseMaterial>(&materials_[id]);
  const auto* coated = std::get_if<CoatedDiffuseMaterial>(&materials_[id]);
  const Entry& entry = entries_[id];
  if (entry.has_detail || !entry.plain_frame) return {};
  if (const auto* glass = std::get_if<DielectricBsdf>(Constant(id)); glass && glass->IsSmooth()) {
    BaseRow row;
    row.flags = BaseRow::kGlass;
    row.eta = glass->eta;
    return row;
  }
  if (!diffuse && !coated) return {};
  const TextureId reflectance = diffuse ? diffuse->reflectance : coated->reflectance;
  if (!textures_.NeedsFirstUvOnly(reflectance)) return {};
  BaseRow row;
  row.flags = BaseRow::kBase;
  if (textures_.IsConstant(reflectance)) {
    row.reflectance = Clamp01(textures_.Eval(reflectance, {}, {}));
  } else {
    row.flags |= BaseRow::kTexture;
    row.texture = reflectance;
  }
  if (diffuse) return row;
  for (const TextureId other : {coated->roughness.u, coated->roughness.v, coated->albedo}) {
    if (!textures_.IsConstant(other)) return {};
  }
  row.SetCoat(std::get<CoatedDiffuseBsdf>(MakeBsdf(id, {}, {})));
  return row;
}

absl::Status MaterialSet::SetDetails(const std::map<MaterialId, SurfaceDetail>& details) {
  for (const auto& [id, detail] : details) {
    if (id < 0 || static_cast<size_t>(id) >= entries_.size())
      return absl::InvalidArgumentError(absl::StrCat("there is a normal or bump map for material ",
                                                     id, ", which does not exist"));
    const auto* mix = std::get_if<MixMaterial>(&materials_[id]);
    if (!detail.Any() || (mix && !mix->sum)) continue;
    entries_[id].detail = detail;
    entries_[id].has_detail = true;
    entries_[id].plain_frame = false;
  }
  // Mixes of mixes may stand in any order; they are no deeper than there are materials.
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t id = 0; id < materials_.size(); ++id) {
      const auto* mix = std::get_if<MixMaterial>(&materials_[id]);
      if (!mix || mix->sum || entries_[id].has_detail) continue;
      entries_[id].has_detail = entries_[mix->a].has_detail || entries_[mix->b].has_detail;
      changed |= entries_[id].has_detail;
    }
  }
  return absl::OkStatus();
}

SurfacePoint MaterialSet::WithDetail(const SurfacePoint& point,
                                     const SurfaceDerivatives& derivatives, Vec3f wo,
                                     float u_mix) const {
  const MaterialId id = Choose(point.material, point.TextureUv(), point.p, u_mix).id;
  const std::optional<SurfaceDetail>& detail = entries_[id].detail;
  return detail ? ApplyDetail(*detail, textures_, derivatives, point, wo) : point;
}

MaterialSet::Choice MaterialSet::Choose(MaterialId id, SurfaceUv uv, Vec3f p, float u_mix) const {
  while (const auto* mix = std::get_if<MixMaterial>(&materials_[id])) {
    if (mix->sum) break;
    const float amount = std::clamp(textures_.Eval(mix->amount, uv, p).r, 0.0f, 1.0f);
    const bool second = u_mix < amount;
    // The rest of the number serves the next mix.
    u_mix = second ? u_mix / amount : (u_mix - amount) / (1 - amount);
    id = second ? mix->b : mix->a;
  }
  return {id, u_mix};
}

Bsdf MaterialSet::MakeBsdf(MaterialId id, SurfaceUv uv, Vec3f p) const {
  const Entry& entry = entries_[id];
  if (entry.constant) return entry.bsdf;
  return std::visit(Lookup{textures_, coats_, trapped_light_, schlick_.get(), uv, p},
                    materials_[id]);
}

void MaterialSet::AddParts(MaterialId id, float weight, SurfaceUv uv, Vec3f p, float u_mix,
                           MixtureParts* parts) const {
  if (!(weight > 0)) return;
  const Choice choice = Choose(id, uv, p, u_mix);
  const auto* sum = std::get_if<MixMaterial>(&materials_[choice.id]);
  if (!sum) return parts->Add(MakeBsdf(choice.id, uv, p), weight);
  const float amount = std::clamp(textures_.Eval(sum->amount, uv, p).r, 0.0f, 1.0f);
  AddParts(sum->a, weight * (1 - amount), uv, p, choice.u_mix, parts);
  AddParts(sum->b, weight * amount, uv, p, choice.u_mix, parts);
}

const Bsdf& MaterialSet::Evaluate(MaterialId id, SurfaceUv uv, Vec3f p, float u_mix,
                                  BsdfRoom* room) const {
  const Choice choice = Choose(id, uv, p, u_mix);
  if (entries_[choice.id].constant) return entries_[choice.id].bsdf;
  if (!std::holds_alternative<MixMaterial>(materials_[choice.id]))
    return room->bsdf = MakeBsdf(choice.id, uv, p);
  room->parts.count = 0;
  AddParts(choice.id, 1, uv, p, choice.u_mix, &room->parts);
  if (room->parts.count == 1) return room->bsdf = room->parts.bsdfs[0];
  return room->bsdf = MixtureBsdf{&room->parts};
}

}  // namespace strata
