#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>

#include <algorithm>

#include "worker/pbrt/entities.h"

namespace strata {
namespace {

/// Textures are evaluated by recursion; no real scene nests them nearly as deep.
constexpr int kMaxTextureDepth = 32;
/// The last of so many is of a billionth of the size of the first.
constexpr int kMaxOctaves = 32;

UvMapping ReadUvMapping(ParameterReader& parameters, ReadContext& context) {
  UvMapping mapping;
  const std::string kind = parameters.String("mapping", "uv");
  mapping.su = static_cast<float>(parameters.Float("uscale", 1));
  mapping.sv = static_cast<float>(parameters.Float("vscale", 1));
  mapping.du = static_cast<float>(parameters.Float("udelta", 0));
  mapping.dv = static_cast<float>(parameters.Float("vdelta", 0));
  if (kind != "uv") {
    context.Warn(parameters.where(),
                 StrCat("texture mapping \"", kind, "\" is not supported; uv is used"));
    parameters.Ignore("v1");
    parameters.Ignore("v2");
  }
  return mapping;
}

void ReadEncoding(ParameterReader& parameters, ImageTexture& image) {
  const std::string encoding = parameters.String("encoding", "sRGB");
  const std::vector<std::string> words = absl::StrSplit(encoding, ' ', absl::SkipWhitespace());
  if (encoding == "sRGB") {
    image.encoding = ImageEncoding::kSrgb;
  } else if (encoding == "linear") {
    image.encoding = ImageEncoding::kLinear;
  } else if (words.size() == 2 && words[0] == "gamma" && absl::SimpleAtof(words[1], &image.gamma) &&
             image.gamma > 0 && image.gamma < 100) {
    image.encoding = ImageEncoding::kGamma;
  } else {
    parameters.Fail(parameters.where(),
                    "\"string encoding\" must be \"sRGB\", \"linear\" or \"gamma\" and a number");
  }
}

void ReadWrap(ParameterReader& parameters, ReadContext& context, ImageTexture& image) {
  const std::string wrap = parameters.String("wrap", "repeat");
  if (wrap == "black") {
    image.wrap = ImageWrap::kBlack;
  } else if (wrap == "clamp") {
    image.wrap = ImageWrap::kClamp;
  } else if (wrap == "octahedralsphere") {
    context.Warn(parameters.where(),
                 "wrap mode \"octahedralsphere\" is not supported; repeat is "
                 "used");
  } else if (wrap != "repeat") {
    parameters.Fail(parameters.where(),
                    StrCat("unknown wrap mode \"", wrap, "\"; use repeat, black or clamp"));
  }
}

/// Rays are many and samples are jittered, so that filtering beyond bilinear changes little.
void ReadImageFilter(ParameterReader& parameters, ReadContext& context, ImageTexture& image) {
  const std::string filter = parameters.String("filter", "bilinear");
  image.nearest = filter == "point";
  if (filter == "trilinear" || filter == "EWA" || filter == "ewa") {
    context.Warn(parameters.where(),
                 StrCat("image filter \"", filter, "\" is not supported; bilinear is used"));
  } else if (filter != "point" && filter != "bilinear") {
    parameters.Fail(parameters.where(),
                    StrCat("unknown image filter \"", filter, "\"; use point or bilinear"));
  }
  parameters.Float("maxanisotropy", 8);  // of EWA alone
}

std::optional<NoiseTexture::Kind> NoiseKind(std::string_view texture_class) {
  using Kind = NoiseTexture::Kind;
  if (texture_class == "fbm") return Kind::kFbm;
  if (texture_class == "wrinkled") return Kind::kWrinkled;
  if (texture_class == "windy") return Kind::kWindy;
  if (texture_class == "marble") return Kind::kMarble;
  return std::nullopt;
}

NoiseTexture ReadNoise(NoiseTexture::Kind kind, ParameterReader& parameters) {
  NoiseTexture noise;
  noise.kind = kind;
  if (kind == NoiseTexture::Kind::kWindy) return noise;
  noise.octaves = parameters.Integer("octaves", 8);
  if (noise.octaves < 0 || noise.octaves > kMaxOctaves) {
    parameters.Fail(parameters.where(), StrCat("\"integer octaves\" must be 0 to ", kMaxOctaves,
                                               ", not ", noise.octaves));
  }
  noise.roughness = static_cast<float>(parameters.Float("roughness", 0.5));
  if (kind != NoiseTexture::Kind::kMarble) return noise;
  noise.scale = static_cast<float>(parameters.Float("scale", 1));
  noise.variation = static_cast<float>(parameters.Float("variation", 0.2));
  return noise;
}

}  // namespace

TextureId TextureTable::Add(TextureDescription texture, int depth) {
  context_.scene.textures.push_back(std::move(texture));
  depths_.push_back(depth);
  return static_cast<TextureId>(depths_.size() - 1);
}

absl::Status TextureTable::NoSuchTexture(const std::string& name, const Names& names,
                                         const SourceLocation& where) const {
  const std::string_view kind = &names == &floats_ ? "float" : "spectrum";
  const auto other = OtherThan(names).find(name);
  if (other != OtherThan(names).end() && other->second.defined) {
    return ErrorAt(where, StrCat("the texture \"", name, "\" is no ", kind,
                                 " texture; define it as \"", kind, "\""));
  }
  return ErrorAt(where,
                 StrCat("there is no ", kind, " texture \"", name, "\"; define it with Texture",
                        defining_ ? " before it is part of another" : ""));
}

TextureId TextureTable::Find(ParameterReader& parameters, const Parameter& parameter,
                             Names& names) {
  if (parameter.strings.size() != 1) {
    parameters.Fail(parameter.where, "a texture parameter wants one name");
    return kNoTexture;
  }
  const std::string& name = parameter.strings[0];
  const auto it = names.find(name);
  if (it != names.end() && (it->second.defined || !defining_)) return it->second.id;
  const auto other = OtherThan(names).find(name);
  if (defining_ || (other != OtherThan(names).end() && other->second.defined)) {
    parameters.Fail(NoSuchTexture(name, names, parameter.where));
    return kNoTexture;
  }
  const TextureId reserved = Add(MixTexture{}, 1);  // until it is defined
  names[name] = {reserved, parameter.where, false};
  return reserved;
}

absl::Status TextureTable::CheckAllDefined() const {
  absl::Status status;
  int line = 0;
  for (const Names* names : {&floats_, &spectra_}) {
    for (const auto& [name, named] : *names) {
      if (named.defined || (!status.ok() && named.first_use.line >= line)) continue;
      status = NoSuchTexture(name, *names, named.first_use);
      line = named.first_use.line;
    }
  }
  return status;
}

TextureId TextureTable::Float(ParameterReader& parameters, std::string_view name,
                              std::optional<float> fallback) {
  const Parameter* parameter = parameters.Take(name);
  if (parameter && parameter->type == "texture") {
    return Find(parameters, *parameter, floats_);
  }
  if (!parameter && !fallback) return kNoTexture;
  const double value = parameters.Float(name, fallback.value_or(0));
  return Add(ConstantTexture{Rgb::Gray(static_cast<float>(value))}, 1);
}

TextureId TextureTable::Color(ParameterReader& parameters, std::string_view name,
                              std::optional<Rgb> fallback, SpectrumUse use,
                              std::string_view color_space) {
  const Parameter* parameter = parameters.Take(name);
  if (parameter && parameter->type == "texture") {
    return Find(parameters, *parameter, spectra_);
  }
  if (!parameter && !fallback) return kNoTexture;
  const Rgb color =
      ColorParameter(parameters, name, fallback.value_or(Rgb{}), use, color_space, context_);
  return Add(ConstantTexture{color}, 1);
}

TextureId TextureTable::NormalMap(ParameterReader& parameters, std::string_view name) {
  if (!parameters.Has(name)) return kNoTexture;
  ImageTexture image;
  image.encoding = ImageEncoding::kLinear;
  image.where = parameters.where();
  absl::StatusOr<std::string> path = context_.NameFile(parameters.String(name, ""), image.where);
  if (!path.ok()) {
    parameters.Fail(path.status());
    return kNoTexture;
  }
  image.path = *std::move(path);
  return Add(std::move(image), 1);
}

std::optional<Rgb> TextureTable::ConstantValue(TextureId id) const {
  if (id == kNoTexture) return std::nullopt;
  const auto* constant = std::get_if<ConstantTexture>(&context_.scene.textures[id]);
  if (!constant) return std::nullopt;
  return constant->value;
}

int TextureTable::DepthOver(ParameterReader& parameters, std::initializer_list<TextureId> inputs) {
  int depth = 1;
  for (const TextureId input : inputs) {
    if (input != kNoTexture) depth = std::max(depth, depths_[input] + 1);
  }
  if (depth > kMaxTextureDepth) {
    parameters.Fail(parameters.where(), StrCat("textures are nested more than ", kMaxTextureDepth,
                                               " deep; simplify them"));
  }
  return depth;
}

TextureId TextureTable::Factor(ParameterReader& parameters, bool scalar,
                               std::string_view color_space) {
  const Parameter* parameter = parameters.Take("scale");
  bool is_color = parameter && parameter->type != "float";
  if (parameter && parameter->type == "texture")
    is_color = parameter->strings.size() == 1 && !floats_.contains(parameter->strings[0]) &&
               spectra_.contains(parameter->strings[0]);
  if (scalar || !is_color) return Float(parameters, "scale", 1.0f);
  return Color(parameters, "scale", Rgb::Gray(1), SpectrumUse::kUnbounded, color_space);
}

std::optional<ImageTexture> TextureTable::ReadImage(ParameterReader& parameters, bool scalar) {
  ImageTexture image;
  image.scalar = scalar;
  image.mapping = ReadUvMapping(parameters, context_);
  image.scale = static_cast<float>(parameters.Float("scale", 1));
  image.invert = parameters.Bool("invert", false);
  ReadWrap(parameters, context_, image);
  ReadEncoding(parameters, image);
  ReadImageFilter(parameters, context_, image);
  const std::string name = parameters.String("filename", "");
  if (!parameters.Has("filename")) {
    parameters.Fail(parameters.where(), "an imagemap wants a \"string filename\"");
    return std::nullopt;
  }
  image.where = parameters.where();
  absl::StatusOr<std::string> path = context_.NameFile(name, image.where);
  if (!path.ok()) {
    parameters.Fail(path.status());
    return std::nullopt;
  }
  image.path = *std::move(path);
  return image;
}

absl::StatusOr<TextureId> TextureTable::AddOfClass(const std::string& texture_class, bool scalar,
                                                   const Transform& world_from_texture,
                                                   std::string_view color_space,
                                                   ParameterReader& parameters) {
  const SourceLocation where = parameters.where();
  const auto value = [&](std::string_view parameter, float fallback) {
    return scalar ? Float(parameters, parameter, fallback)
                  : Color(parameters, parameter, Rgb::Gray(fallback), SpectrumUse::kUnbounded,
                          color_space);
  };
  const auto world_to_texture = [&]() -> absl::StatusOr<Transform> {
    const std::optional<Transform> inverse = world_from_texture.Inverse();
    if (!inverse) return ErrorAt(where, "the texture's transform cannot be inverted");
    return *inverse;
  };
  if (texture_class == "constant") return value("value", 1);
  if (texture_class == "scale") {
    const TextureId texture = value("tex", 1);
    const ScaleTexture scale{texture, Factor(parameters, scalar, color_space)};
    return Add(scale, DepthOver(parameters, {scale.texture, scale.scale}));
  }
  if (texture_class == "mix") {
    const MixTexture mix{value("tex1", 0), value("tex2", 1), Float(parameters, "amount", 0.5f)};
    return Add(mix, DepthOver(parameters, {mix.a, mix.b, mix.amount}));
  }
  if (texture_class == "checkerboard") {
    CheckerboardTexture checkerboard;
    const int dimension = parameters.Integer("dimension", 2);
    if (dimension != 2 && dimension != 3) {
      parameters.Fail(where, "\"integer dimension\" must be 2 or 3");
    }
    checkerboard.a = value("tex1", 1);
    checkerboard.b = value("tex2", 0);
    checkerboard.solid = dimension == 3;
    if (checkerboard.solid) {
      STRATA_ASSIGN_OR_RETURN(checkerboard.world_to_texture, world_to_texture());
    } else {
      checkerboard.mapping = ReadUvMapping(parameters, context_);
    }
    return Add(checkerboard, DepthOver(parameters, {checkerboard.a, checkerboard.b}));
  }
  if (texture_class == "bilerp") {
    BilinearTexture bilinear;
    bilinear.corners = {value("v00", 0), value("v10", 0), value("v01", 1), value("v11", 1)};
    bilinear.mapping = ReadUvMapping(parameters, context_);
    const auto& [a, b, c, d] = bilinear.corners;
    return Add(bilinear, DepthOver(parameters, {a, b, c, d}));
  }
  if (texture_class == "dots") {
    const DotsTexture dots{value("inside", 1), value("outside", 0),
                           ReadUvMapping(parameters, context_)};
    return Add(dots, DepthOver(parameters, {dots.inside, dots.outside}));
  }
  if (const std::optional<NoiseTexture::Kind> kind = NoiseKind(texture_class)) {
    NoiseTexture noise = ReadNoise(*kind, parameters);
    STRATA_ASSIGN_OR_RETURN(noise.world_to_texture, world_to_texture());
    return Add(noise, 1);
  }
  if (texture_class == "imagemap") {
    std::optional<ImageTexture> image = ReadImage(parameters, scalar);
    return image ? Add(*std::move(image), 1) : kNoTexture;
  }
  return ErrorAt(where, StrCat("Texture class \"", texture_class,
                               "\" is not supported; use constant, imagemap, scale, mix, "
                               "checkerboard, bilerp, dots, fbm, wrinkled, windy or marble"));
}

absl::Status TextureTable::Define(const std::string& name, const std::string& value_type,
                                  const std::string& texture_class,
                                  const Transform& world_from_texture, std::string_view color_space,
                                  ParameterReader& parameters) {
  const SourceLocation where = parameters.where();
  const bool scalar = value_type == "float";
  if (!scalar && value_type != "spectrum") {
    return ErrorAt(where, StrCat("Texture \"", name, "\" has the unknown type \"", value_type,
                                 "\"; use float or spectrum"));
  }
  std::vector<TextureDescription>& textures = context_.scene.textures;
  const size_t before = textures.size();
  defining_ = true;
  const absl::StatusOr<TextureId> id =
      AddOfClass(texture_class, scalar, world_from_texture, color_space, parameters);
  defining_ = false;
  STRATA_RETURN_IF_ERROR(id.status());
  STRATA_RETURN_IF_ERROR(parameters.Finish(context_.warnings));
  Named& named = (scalar ? floats_ : spectra_)[name];
  if (named.defined) {
    context_.Warn(where, StrCat("Texture \"", name,
                                "\" is defined again, as only pbrt-v3 allows; what follows has "
                                "this one"));
  }
  if (named.id == kNoTexture || named.defined) {
    named.id = *id;
  } else {
    // Used before: the slot that was reserved then becomes the definition.
    textures[named.id] = textures[*id];
    depths_[named.id] = depths_[*id];
    if (static_cast<size_t>(*id) >= before) {
      textures.pop_back();
      depths_.pop_back();
    }
  }
  named.defined = true;
  return absl::OkStatus();
}

}  // namespace strata
