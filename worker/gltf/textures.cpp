#include "worker/gltf/textures.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "common/text.h"
#include "worker/gltf/accessors.h"
#include "worker/math/elementary.h"

namespace strata {
namespace {

absl::Status ApplyTransform(const GltfExtension& transform, TextureReference* reference) {
  if (!transform.present()) return absl::OkStatus();
  STRATA_ASSIGN_OR_RETURN(const std::vector<double> offset, transform.Numbers("offset", {0, 0}));
  STRATA_ASSIGN_OR_RETURN(const double rotation, transform.Number("rotation", 0));
  STRATA_ASSIGN_OR_RETURN(const std::vector<double> scale, transform.Numbers("scale", {1, 1}));
  STRATA_ASSIGN_OR_RETURN(const int set, transform.Index("texCoord"));
  reference->mapping = TextureTransform(offset[0], offset[1], rotation, scale[0], scale[1]);
  if (set >= 0) reference->tex_coord = set;
  return absl::OkStatus();
}

template <typename Info>
double ScaleOf(const Info&) {
  return 1;
}
double ScaleOf(const tinygltf::NormalTextureInfo& info) { return info.scale; }

ImageWrap WrapOf(int wrap) {
  if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return ImageWrap::kClamp;
  return wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? ImageWrap::kMirror : ImageWrap::kRepeat;
}

/// "%20" and the like as the bytes they stand for.
std::string DecodeUri(const std::string& uri) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string decoded;
  for (size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? digit(uri[i + 2]) : -1;
    if (low < 0) {
      decoded += uri[i];
      continue;
    }
    decoded += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return decoded;
}

}  // namespace

UvMapping TextureTransform(double offset_u, double offset_v, double rotation, double scale_u,
                           double scale_v) {
  // With v downwards, u' = c su u + s sv v + ou and v' = -s su u + c sv v + ov, which is how the
  // extension's sample model turns. Here v and v' are 1 minus theirs.
  const double s = Sin(rotation), c = Cos(rotation);
  UvMapping mapping;
  mapping.su = static_cast<float>(c * scale_u);
  mapping.s_v = static_cast<float>(-s * scale_v);
  mapping.du = static_cast<float>(offset_u + s * scale_v);
  mapping.t_u = static_cast<float>(s * scale_u);
  mapping.sv = static_cast<float>(c * scale_v);
  mapping.dv = static_cast<float>(1 - c * scale_v - offset_v);
  return mapping;
}

template <typename Info>
absl::StatusOr<TextureReference> ReferTo(const GltfDocument& document, const Info& info,
                                         const std::string& element) {
  TextureReference reference;
  reference.index = info.index;
  reference.tex_coord = info.texCoord;
  reference.scale = ScaleOf(info);
  reference.element = element;
  STRATA_RETURN_IF_ERROR(ApplyTransform(
      GltfExtension(document, info.extensions, "KHR_texture_transform", element), &reference));
  return reference;
}
template absl::StatusOr<TextureReference> ReferTo(const GltfDocument&, const tinygltf::TextureInfo&,
                                                  const std::string&);
template absl::StatusOr<TextureReference> ReferTo(const GltfDocument&,
                                                  const tinygltf::NormalTextureInfo&,
                                                  const std::string&);

absl::StatusOr<TextureReference> ReferTo(const GltfDocument& document,
                                         const GltfExtension& extension, const std::string& name) {
  TextureReference reference;
  reference.element = extension.element() + "." + name;
  if (!extension.Has(name)) return reference;
  const GltfExtension info(document, extension.Get(name), reference.element);
  if (!info.Has("index")) return document.Error(reference.element, "it names no texture");
  STRATA_ASSIGN_OR_RETURN(reference.index, info.Index("index"));
  STRATA_ASSIGN_OR_RETURN(const int set, info.Index("texCoord"));
  reference.tex_coord = std::max(set, 0);
  if (info.Has("extensions") && info.Get("extensions").Has("KHR_texture_transform")) {
    STRATA_RETURN_IF_ERROR(
        ApplyTransform(GltfExtension(document, info.Get("extensions").Get("KHR_texture_transform"),
                                     reference.element + ".extensions.KHR_texture_transform"),
                       &reference));
  }
  return reference;
}

TextureId TextureMaker::Add(TextureDescription texture) {
  document_.scene.textures.push_back(std::move(texture));
  return static_cast<TextureId>(document_.scene.textures.size()) - 1;
}

TextureId TextureMaker::Constant(Rgb value) { return Add(ConstantTexture{value}); }

TextureId TextureMaker::Product(TextureId a, TextureId b) {
  if (a == kNoTexture) return b;
  if (b == kNoTexture) return a;
  return Add(ScaleTexture{a, b});
}

absl::StatusOr<TextureId> TextureMaker::Color(const TextureReference& reference, bool linear) {
  STRATA_ASSIGN_OR_RETURN(ImageTexture image, Image(reference));
  image.encoding = linear ? ImageEncoding::kLinear : ImageEncoding::kSrgb;
  return Add(std::move(image));
}

absl::StatusOr<TextureId> TextureMaker::Alpha(const TextureReference& reference) {
  STRATA_ASSIGN_OR_RETURN(ImageTexture image, Image(reference));
  image.alpha = true;
  return Add(std::move(image));
}

absl::StatusOr<TextureId> TextureMaker::Channel(const TextureReference& reference, int channel,
                                                double factor) {
  STRATA_ASSIGN_OR_RETURN(ImageTexture image, Image(reference));
  image.encoding = ImageEncoding::kLinear;
  image.channel = channel;
  image.scale = static_cast<float>(factor);
  return Add(std::move(image));
}

absl::StatusOr<ImageTexture> TextureMaker::Image(const TextureReference& reference) {
  const tinygltf::Model& model = document_.model();
  STRATA_ASSIGN_OR_RETURN(
      const tinygltf::Texture* texture,
      document_.Find(model.textures, reference.index, "texture", reference.element));
  const std::string name = ElementName("textures", reference.index);
  ImageTexture image;
  image.mapping = reference.mapping;
  image.second_uv = second_set_ >= 0 && reference.tex_coord == second_set_;
  image.where = document_.At(name);
  if (texture->sampler >= 0) {
    STRATA_ASSIGN_OR_RETURN(
        const tinygltf::Sampler* sampler,
        document_.Find(model.samplers, texture->sampler, "sampler", name + ".sampler"));
    image.wrap = WrapOf(sampler->wrapS);
    if (WrapOf(sampler->wrapT) != image.wrap) image.wrap_t = WrapOf(sampler->wrapT);
    // A picture is the mean over each pixel already, so minification needs no filter of its own.
    image.nearest = sampler->magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  }
  if (texture->source < 0)
    return document_.Error(name, "it has no image that can be read; give it a PNG or a JPEG");
  STRATA_RETURN_IF_ERROR(SetImage(texture->source, name + ".source", &image));
  return image;
}

absl::Status TextureMaker::SetImage(int index, const std::string& element, ImageTexture* texture) {
  STRATA_ASSIGN_OR_RETURN(const tinygltf::Image* image,
                          document_.Find(document_.model().images, index, "image", element));
  const std::string name = ElementName("images", index);
  if (image->bufferView < 0 && image->image.empty()) {
    STRATA_ASSIGN_OR_RETURN(texture->path, document_.AddFile(DecodeUri(image->uri), name));
    return absl::OkStatus();
  }
  texture->path = document_.At(name).ToString();
  auto& embedded = embedded_[index];
  if (!embedded) {
    std::string bytes(image->image.begin(), image->image.end());
    if (image->bufferView >= 0) {
      STRATA_ASSIGN_OR_RETURN(bytes, ReadBufferView(document_, image->bufferView, name));
    }
    embedded = std::make_shared<const EmbeddedImage>(std::move(bytes));
  }
  texture->embedded = embedded;
  return absl::OkStatus();
}

}  // namespace strata
