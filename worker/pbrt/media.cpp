#include <algorithm>
#include <iterator>

#include "worker/pbrt/entities.h"

namespace strata {
namespace {

#include "worker/pbrt/media_tables.inl"

MediumDescription ReadHomogeneous(ParameterReader& parameters, std::string_view color_space,
                                  ReadContext& context) {
  MediumDescription medium;
  medium.where = parameters.where();
  // What a colour has outside the gamut of Rec.709 would be a negative coefficient.
  const auto color = [&](std::string_view name, Rgb fallback, SpectrumUse use) {
    const Rgb c = ColorParameter(parameters, name, fallback, use, color_space, context);
    return Rgb{std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)};
  };
  // pbrt-v4's default; v3's is whole milk.
  const bool has_sigma = parameters.Has("sigma_a") || parameters.Has("sigma_s");
  medium.absorption = color("sigma_a", Rgb::Gray(1), SpectrumUse::kUnbounded);
  medium.scattering = color("sigma_s", Rgb::Gray(1), SpectrumUse::kUnbounded);
  if (const std::string preset = parameters.String("preset", ""); !preset.empty()) {
    const auto* found = std::find_if(std::begin(kMeasuredMedia), std::end(kMeasuredMedia),
                                     [&](const auto& medium) { return preset == medium.name; });
    if (found == std::end(kMeasuredMedia)) {
      parameters.Fail(parameters.where(),
                      StrCat("there is no preset \"", preset,
                             "\" of a medium; give \"sigma_a\" and \"sigma_s\" in its place"));
      return medium;
    }
    if (has_sigma)
      context.Warn(parameters.where(),
                   "\"sigma_a\" and \"sigma_s\" of a medium are ignored beside its \"preset\"");
    medium.absorption = found->absorption;
    medium.scattering = found->scattering;
  }
  const double scale = parameters.Float("scale", 1);
  if (scale < 0) parameters.Fail(parameters.where(), "the \"scale\" of a medium is negative");
  medium.absorption *= static_cast<float>(scale);
  medium.scattering *= static_cast<float>(scale);
  const double emission_scale = parameters.Float("Lescale", 1);
  if (emission_scale < 0)
    parameters.Fail(parameters.where(), "the \"Lescale\" of a medium is negative");
  medium.emission =
      color("Le", Rgb{}, SpectrumUse::kIlluminant) * static_cast<float>(emission_scale);
  if (!IsFinite(medium.absorption + medium.scattering) ||
      !IsFinite(medium.absorption * medium.emission))
    parameters.Fail(parameters.where(), "the medium is too dense or too bright for floats");
  medium.g = static_cast<float>(parameters.Float("g", 0));
  if (!(medium.g > -1 && medium.g < 1))
    parameters.Fail(parameters.where(), StrCat("the \"g\" of a medium is ", medium.g,
                                               "; it must lie between -1 and 1"));
  return medium;
}

}  // namespace

absl::Status MediumTable::Define(const std::string& name, std::string_view color_space,
                                 ParameterReader& parameters) {
  const std::string type = parameters.String("type", "");
  if (type.empty())
    return ErrorAt(parameters.where(),
                   StrCat("MakeNamedMedium \"", name, "\" wants a \"string type\""));
  MediumDescription medium;
  if (type == "homogeneous") {
    medium = ReadHomogeneous(parameters, color_space, context_);
  } else if (type == "uniformgrid" || type == "rgbgrid" || type == "cloud" || type == "nanovdb" ||
             type == "heterogeneous") {
    context_.Warn(parameters.where(),
                  StrCat("media of type \"", type, "\" are not supported, only \"homogeneous\"; \"",
                         name, "\" is left out, as if it were clear"));
    parameters.IgnoreAll();
  } else {
    return ErrorAt(parameters.where(), StrCat("there is no medium of type \"", type, "\""));
  }
  STRATA_RETURN_IF_ERROR(parameters.Finish(context_.warnings));
  NamedPart& named = Find(name, parameters.where());
  if (named.defined) {
    context_.Warn(parameters.where(), StrCat("medium \"", name,
                                             "\" is defined again, as only pbrt-v3 allows; what "
                                             "follows has this one"));
    named.id = static_cast<MediumId>(context_.scene.media.size());
    context_.scene.media.emplace_back();
  }
  named.defined = true;
  context_.scene.media[static_cast<size_t>(named.id)] = medium;
  return absl::OkStatus();
}

MediumId MediumTable::Use(const std::string& name, const SourceLocation& where) {
  return name.empty() ? kNoMedium : Find(name, where).id;
}

NamedPart& MediumTable::Find(const std::string& name, const SourceLocation& where) {
  const auto [it, is_new] = named_.try_emplace(name);
  if (is_new) {
    it->second.id = static_cast<MediumId>(context_.scene.media.size());
    it->second.first_use = where;
    context_.scene.media.emplace_back();
  }
  return it->second;
}

absl::Status MediumTable::CheckAllDefined() const {
  return strata::CheckAllDefined(named_, [](std::string_view name) {
    return StrCat("there is no medium \"", name, "\"; define it with MakeNamedMedium");
  });
}

}  // namespace strata
