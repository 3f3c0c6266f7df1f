#include "worker/pbrt/version3.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "worker/math/elementary.h"

namespace strata {
namespace {

/// A type of a directive. `to` empty: refused, and `instead` says what to use.
struct TypeWord {
  std::string_view directive, from, to;
  std::string_view instead = "";
};

constexpr TypeWord kTypeWords[] = {
    {"Film", "image", "rgb"},
    {"Sampler", "random", "independent"},
    {"Sampler", "lowdiscrepancy", "sobol"},
    {"Sampler", "02sequence", "sobol"},
    {"Sampler", "maxmindist", "sobol"},
    {"Sampler", "bestcandidate", "sobol"},
    {"Camera", "environment", "spherical"},
    {"AreaLightSource", "area", "diffuse"},
    {"LightSource", "exinfinite", "infinite"},
    {"Material", "matte", "diffuse"},
    {"Material", "metal", "conductor"},
    {"Material", "mirror", "conductor"},
    {"Material", "glass", "dielectric"},
    {"Material", "plastic", "coateddiffuse"},
    {"Material", "substrate", "coateddiffuse"},
    {"Material", "uber", "coateddiffuse"},
    {"Material", "translucent", "diffusetransmission"},
    {"Material", "none", "interface"},
    {"Material", "disney", "", "diffuse, conductor, dielectric or a mix"},
    {"Material", "fourier", "", "conductor or coateddiffuse"},
    {"Material", "kdsubsurface", "", "diffusetransmission"},
    {"Shape", "cone", "", "a trianglemesh"},
    {"Shape", "paraboloid", "", "a trianglemesh"},
    {"Shape", "hyperboloid", "", "a trianglemesh"},
    {"Shape", "heightfield", "", "a trianglemesh"},
    {"Shape", "nurbs", "", "a bilinearmesh or trianglemesh"},
};

/// A parameter of a directive; `type` is v3's word for the directive's type, empty for all. `to`
/// empty: dropped, and `why` says what becomes of it.
struct ParameterWord {
  std::string_view directive, type, from, to;
  std::string_view why = "";
};

constexpr std::string_view kGlassIsClear = "all that is not reflected is transmitted";
constexpr std::string_view kCoatReflects = "the coat reflects by its index";
constexpr ParameterWord kParameterWords[] = {
    {"PixelFilter", "", "xwidth", "xradius"},
    {"PixelFilter", "", "ywidth", "yradius"},
    {"Shape", "loopsubdiv", "nlevels", "levels"},
    {"Shape", "", "st", "uv"},
    {"Shape", "", "shadowalpha", "", "shadows are as the shape is"},
    {"LightSource", "", "samples", "", "lights have no samples of their own"},
    {"LightSource", "", "nsamples", "", "lights have no samples of their own"},
    {"AreaLightSource", "", "samples", "", "lights have no samples of their own"},
    {"AreaLightSource", "", "nsamples", "", "lights have no samples of their own"},
    {"Film", "image", "maxsampleluminance", "", "samples are not clamped"},
    {"Texture", "imagemap", "trilinear", "", "images are filtered bilinearly"},
    {"Texture", "scale", "tex1", "tex"},
    {"Texture", "scale", "tex2", "scale"},
    {"Texture", "checkerboard", "aamode", "", "pixels are filtered by their samples"},
    {"Material", "", "bumpmap", "displacement"},
    {"Material", "matte", "Kd", "reflectance"},
    {"Material", "matte", "sigma", "", "the surface is Lambertian"},
    {"Material", "mirror", "Kr", "reflectance"},
    {"Material", "glass", "index", "eta"},
    {"Material", "glass", "Kr", "", kGlassIsClear},
    {"Material", "glass", "Kt", "", kGlassIsClear},
    {"Material", "plastic", "Kd", "reflectance"},
    {"Material", "plastic", "Ks", "", kCoatReflects},
    {"Material", "substrate", "Kd", "reflectance"},
    {"Material", "substrate", "Ks", "", kCoatReflects},
    {"Material", "uber", "Kd", "reflectance"},
    {"Material", "uber", "index", "eta"},
    {"Material", "uber", "Ks", "", kCoatReflects},
    {"Material", "uber", "Kr", "", kCoatReflects},
    {"Material", "uber", "Kt", "", "the surface is opaque"},
    {"Material", "uber", "opacity", "", "the surface is opaque"},
    {"Material", "translucent", "reflect", "reflectance"},
    {"Material", "translucent", "transmit", "transmittance"},
    {"Material", "translucent", "Ks", "", "it scatters diffusely alone"},
    {"Material", "translucent", "Kd", "", "it multiplies numbers, or as a texture equal gray ones"},
    {"Material", "translucent", "roughness", "", "it scatters diffusely alone"},
    {"Material", "translucent", "remaproughness", "", "it scatters diffusely alone"},
};

/// What v3 takes where a parameter is missing, and v4 does not.
struct DefaultWord {
  std::string_view type, name, value_type;
  float value;
};
constexpr DefaultWord kDefaults[] = {
    {"metal", "roughness", "float", 0.01f},    {"mirror", "reflectance", "rgb", 0.9f},
    {"plastic", "reflectance", "rgb", 0.25f},  {"plastic", "roughness", "float", 0.1f},
    {"substrate", "reflectance", "rgb", 0.5f}, {"substrate", "roughness", "float", 0.1f},
    {"uber", "reflectance", "rgb", 0.25f},     {"uber", "roughness", "float", 0.1f},
};

/// One directive on its way from v3 to v4.
class Translation {
 public:
  Translation(std::string_view directive, const SourceLocation& where, std::string* type,
              std::vector<Parameter>* parameters, WarningList* warnings)
      : directive_(directive),
        where_(where),
        type_(*type),
        from_(*type),
        parameters_(*parameters),
        warnings_(*warnings) {}

  absl::Status Run() {
    TranslateColors();
    if (directive_ == "Material") {
      TakeMatte();
      TakeTranslucence();
    }
    STRATA_RETURN_IF_ERROR(TranslateType());
    for (const ParameterWord& word : kParameterWords) TranslateParameter(word);
    if (directive_ == "Material") {
      AddDefaults();
      RemapRoughness();
      STRATA_RETURN_IF_ERROR(TranslateMix());
    }
    if (directive_ == "PixelFilter") TranslateAlpha();
    if (directive_ == "Texture") TranslateGamma();
    if (directive_ == "Camera") TranslateCamera();
    if (directive_ == "Shape") PairTextureCoordinates();
    if (directive_ == "AreaLightSource") STRATA_RETURN_IF_ERROR(TakeScales());
    return directive_ == "LightSource" ? TranslateLight() : absl::OkStatus();
  }

 private:
  Parameter* Find(std::string_view name) {
    const auto it = std::find_if(parameters_.begin(), parameters_.end(),
                                 [&](const Parameter& p) { return p.name == name; });
    return it == parameters_.end() ? nullptr : &*it;
  }
  void Remove(std::string_view name) {
    std::erase_if(parameters_, [&](const Parameter& p) { return p.name == name; });
  }
  Parameter& Add(std::string_view name, std::string_view value_type) {
    Parameter& parameter = parameters_.emplace_back();
    parameter.name = name;
    parameter.type = value_type;
    parameter.where = where_;
    return parameter;
  }
  void Note(const SourceLocation& where, std::string_view from, std::string_view to) {
    const bool several = from.find(" and ") != std::string_view::npos;
    warnings_.Add(where, StrCat("pbrt-v3's ", from, several ? " are" : " is", " read as ", to));
  }

  void TranslateColors() {
    for (Parameter& parameter : parameters_) {
      if (parameter.type != "color") continue;
      Note(parameter.where, "parameter type \"color\"", "\"rgb\"");
      parameter.type = "rgb";
    }
  }

  /// Plastic and uber materials without a specular part, as `pbrt --upgrade` has them.
  void TakeMatte() {
    if (from_ != "plastic" && from_ != "uber") return;
    const auto black = [&](std::string_view name, bool otherwise) {
      const Parameter* p = Find(name);
      return p ? p->type == "rgb" && p->numbers == std::vector<double>(3, 0.0) : otherwise;
    };
    if (!black("Ks", false) || (from_ == "uber" && !black("Kr", true))) return;
    Note(where_, StrCat("Material \"", from_, "\" without \"Ks\""), "\"matte\"");
    for (const std::string_view name :
         {"Ks", "Kr", "roughness", "uroughness", "vroughness", "remaproughness", "index", "eta"})
      Remove(name);
    if (!Find("Kd") && !Find("reflectance")) Add("Kd", "rgb").numbers.assign(3, 0.25);
    type_ = from_ = "matte";
  }

  /// v3's translucent materials multiply both parts by "Kd".
  void TakeTranslucence() {
    if (from_ != "translucent") return;
    for (const std::string_view name : {"reflect", "transmit"}) {
      if (!Find(name)) Add(name, "rgb").numbers.assign(3, 0.5);
    }
    if (!Find("Kd")) Add("Kd", "rgb").numbers.assign(3, 0.25);
    const Parameter kd = *Find("Kd");
    Parameter *reflect = Find("reflect"), *transmit = Find("transmit");
    const auto is_color = [](const Parameter& p) {
      return p.type == "rgb" && p.numbers.size() == 3;
    };
    if (!is_color(*reflect) || !is_color(*transmit)) return;
    const std::vector<double> gray(3, reflect->numbers[0]);
    if (is_color(kd)) {
      for (size_t i = 0; i < 3; ++i) {
        reflect->numbers[i] *= kd.numbers[i];
        transmit->numbers[i] *= kd.numbers[i];
      }
    } else if (kd.type == "texture" && reflect->numbers == gray && transmit->numbers == gray) {
      for (Parameter* part : {reflect, transmit}) {
        part->type = "texture";
        part->numbers.clear();
        part->strings = kd.strings;
      }
      Add("scale", "float").numbers = {gray[0]};
    } else {
      return;
    }
    Remove("Kd");
  }

  absl::Status TranslateType() {
    for (const TypeWord& word : kTypeWords) {
      if (word.directive != directive_ || word.from != from_) continue;
      const std::string name = StrCat(directive_, " \"", from_, "\"");
      if (word.to.empty())
        return ErrorAt(where_, StrCat(name, " of pbrt-v3 is not supported; use ", word.instead));
      Note(where_, name, StrCat("\"", word.to, "\""));
      type_ = word.to;
    }
    return absl::OkStatus();
  }

  void TranslateParameter(const ParameterWord& word) {
    if (word.directive != directive_ || (!word.type.empty() && word.type != from_)) return;
    Parameter* parameter = Find(word.from);
    if (!parameter) return;
    const std::string name = StrCat("\"", word.from, "\" of ", directive_);
    if (word.to.empty()) {
      warnings_.Add(parameter->where, StrCat("pbrt-v3's ", name, " is ignored; ", word.why));
      Remove(word.from);
      return;
    }
    // A word of v4 that is given, too, has the last word: it was given on purpose.
    if (Find(word.to)) return;
    Note(parameter->where, name, StrCat("\"", word.to, "\""));
    parameter->name = word.to;
  }

  void AddDefaults() {
    for (const DefaultWord& word : kDefaults) {
      if (word.type != from_ || Find(word.name)) continue;
      if (word.name == "roughness" && (Find("uroughness") || Find("vroughness"))) continue;
      Add(word.name, word.value_type).numbers.assign(word.value_type == "rgb" ? 3 : 1, word.value);
    }
  }

  /// v3 makes another alpha of a roughness than v4 does (Roughness::remap): what is a number
  /// becomes the alpha itself.
  void RemapRoughness() {
    constexpr std::string_view kRough[] = {"metal", "glass", "plastic", "substrate", "uber"};
    if (std::find(std::begin(kRough), std::end(kRough), from_) == std::end(kRough)) return;
    if (const Parameter* remap = Find("remaproughness")) {
      if (!remap->bools.empty() && !remap->bools[0]) return;
    }
    const std::string_view names[] = {"roughness", "uroughness", "vroughness"};
    for (const std::string_view name : names) {
      const Parameter* parameter = Find(name);
      if (parameter && parameter->type != "float") {
        warnings_.Add(parameter->where,
                      StrCat("pbrt-v3's remapping of a texture \"", name, "\" is read as v4's"));
        return;
      }
    }
    for (const std::string_view name : names) {
      Parameter* parameter = Find(name);
      if (!parameter || parameter->numbers.size() != 1) continue;
      double& value = parameter->numbers[0];
      // v3's fit of alpha over the logarithm of roughness; its 0 is a perfect mirror.
      const double x = Log(std::max(value, 1e-3));
      const double alpha =
          1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
      value = value == 0 ? 0 : alpha;
    }
    Remove("remaproughness");
    Add("remaproughness", "bool").bools = {false};
  }

  /// v3 names two materials apart and weighs the first by "amount", v4 the second.
  absl::Status TranslateMix() {
    if (from_ != "mix") return absl::OkStatus();
    const Parameter *first = Find("namedmaterial1"), *second = Find("namedmaterial2");
    if (!first && !second) return absl::OkStatus();
    if (!first || !second || first->strings.size() != 1 || second->strings.size() != 1)
      return ErrorAt(where_,
                     "pbrt-v3's Material \"mix\" wants \"string namedmaterial1\" and "
                     "\"string namedmaterial2\"");
    const std::vector<std::string> names = {second->strings[0], first->strings[0]};
    Note(first->where, "\"namedmaterial1\" and \"namedmaterial2\"", "\"materials\"");
    Remove("namedmaterial1");
    Remove("namedmaterial2");
    Add("materials", "string").strings = names;
    Parameter* amount = Find("amount");
    if (!amount || amount->type != "rgb") return absl::OkStatus();
    const std::vector<double>& c = amount->numbers;
    if (c.size() != 3 || c[0] != c[1] || c[1] != c[2])
      return ErrorAt(amount->where,
                     "pbrt-v3's coloured \"amount\" of a mix is not supported; use a \"float\"");
    amount->type = "float";
    amount->numbers.resize(1);
    return absl::OkStatus();
  }

  /// v3's Gaussian is exp(-alpha x^2).
  void TranslateAlpha() {
    Parameter* alpha = Find("alpha");
    if (type_ != "gaussian" || !alpha || alpha->numbers.size() != 1 || !(alpha->numbers[0] > 0))
      return;
    Note(alpha->where, "\"alpha\" of PixelFilter", "\"sigma\"");
    alpha->name = "sigma";
    alpha->numbers[0] = std::sqrt(0.5 / alpha->numbers[0]);
  }

  void TranslateCamera() {
    if (from_ == "environment") Add("mapping", "string").strings = {"equirectangular"};
    Parameter* half = Find("halffov");
    if (!half || half->numbers.size() != 1 || Find("fov")) return;
    Note(half->where, "\"halffov\" of Camera", "half of \"fov\"");
    half->name = "fov";
    half->numbers[0] *= 2;
  }

  void TranslateGamma() {
    const Parameter* gamma = Find("gamma");
    if (type_ != "imagemap" || !gamma) return;
    std::string encoding;
    if (gamma->type == "bool" && gamma->bools.size() == 1) {
      encoding = gamma->bools[0] ? "sRGB" : "linear";
    } else if (gamma->type == "float" && gamma->numbers.size() == 1) {
      encoding = StrCat("gamma ", gamma->numbers[0]);
    } else {
      return;
    }
    Note(gamma->where, "\"gamma\" of Texture", "\"encoding\"");
    Remove("gamma");
    Add("encoding", "string").strings = {encoding};
  }

  /// v3 takes "float uv" and "float st" as pairs.
  void PairTextureCoordinates() {
    Parameter* uv = Find("uv");
    if (!uv || uv->type != "float" || uv->numbers.size() % 2 != 0) return;
    Note(uv->where, "\"float uv\"", "\"point2 uv\"");
    uv->type = "point2";
  }

  /// v3's "scale" is a colour. Its images of all directions lie by latitude and longitude and are
  /// multiplied by "L", too.
  absl::Status TranslateLight() {
    STRATA_RETURN_IF_ERROR(TakeScales());
    Parameter* map = Find("mapname");
    if (!map) return absl::OkStatus();
    Note(map->where, "\"mapname\" of LightSource", "\"filename\"");
    map->name = "filename";
    if (type_ == "infinite") STRATA_RETURN_IF_ERROR(TakeGray("L"));
    if (type_ == "infinite" || type_ == "goniometric")
      Add("mapping", "string").strings = {"equirectangular"};
    if (type_ == "projection") STRATA_RETURN_IF_ERROR(TakeGray("I"));
    if (type_ == "projection" && !Find("fov")) Add("fov", "float").numbers = {45};
    return absl::OkStatus();
  }

  /// What multiplies a light in v3: a colour, and the second numbers of blackbodies.
  absl::Status TakeScales() {
    const Parameter* scale = Find("scale");
    Parameter* emitted = Find(directive_ == "AreaLightSource" || Find("L") ? "L" : "I");
    if (scale && emitted && scale->type == "rgb" && emitted->type == "rgb" &&
        scale->numbers.size() == 3 && emitted->numbers.size() == 3) {
      Note(scale->where, "colour \"scale\" of a light",
           StrCat("a part of \"", emitted->name, "\""));
      for (size_t i = 0; i < 3; ++i) emitted->numbers[i] *= scale->numbers[i];
      Remove("scale");
    }
    STRATA_RETURN_IF_ERROR(TakeGray("scale"));
    TakeBlackbodyScales();
    return absl::OkStatus();
  }

  /// Makes a colour a part of the number "scale".
  absl::Status TakeGray(std::string_view name) {
    const Parameter* color = Find(name);
    if (!color || (color->type != "rgb" && color->type != "spectrum" && color->type != "blackbody"))
      return absl::OkStatus();
    const std::vector<double> c = color->numbers;
    if (color->type != "rgb" || c.size() != 3 || c[0] != c[1] || c[1] != c[2])
      return ErrorAt(color->where, StrCat("pbrt-v3's coloured \"", name,
                                          "\" of a light is not supported here; use a gray one"));
    Note(color->where, StrCat("\"", name, "\" of ", directive_), "a part of \"float scale\"");
    Remove(name);
    MultiplyScale(c[0]);
    return absl::OkStatus();
  }

  /// The second number of a "blackbody" of v3 is a factor.
  void TakeBlackbodyScales() {
    double factor = 1;
    for (Parameter& parameter : parameters_) {
      if (parameter.type != "blackbody" || parameter.numbers.size() != 2) continue;
      Note(parameter.where, "second number of a \"blackbody\"", "a part of \"float scale\"");
      factor *= parameter.numbers[1];
      parameter.numbers.pop_back();
    }
    if (factor != 1) MultiplyScale(factor);
  }

  void MultiplyScale(double factor) {
    if (!Find("scale")) Add("scale", "float").numbers = {1};
    Parameter* scale = Find("scale");
    if (scale->numbers.size() == 1) scale->numbers[0] *= factor;
  }

  const std::string_view directive_;
  const SourceLocation& where_;
  std::string& type_;
  std::string from_;  ///< The type in v3's words.
  std::vector<Parameter>& parameters_;
  WarningList& warnings_;
};

}  // namespace

absl::Status TranslateVersion3(std::string_view directive, const SourceLocation& where,
                               std::string* type, std::vector<Parameter>* parameters,
                               WarningList* warnings) {
  return Translation(directive, where, type, parameters, warnings).Run();
}

void TranslateTextureType(const SourceLocation& where, std::string* value_type,
                          WarningList* warnings) {
  if (*value_type != "color") return;
  warnings->Add(where, "pbrt-v3's texture type \"color\" is read as \"spectrum\"");
  *value_type = "spectrum";
}

std::string_view DirectiveOfVersion3(std::string_view name, const SourceLocation& where,
                                     WarningList* warnings) {
  if (name != "SurfaceIntegrator") return name;
  warnings->Add(where, "pbrt-v3's SurfaceIntegrator is read as Integrator");
  return "Integrator";
}

}  // namespace strata
