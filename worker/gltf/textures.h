#pragma once

#include <map>
#include <memory>
#include <string>

#include "worker/gltf/document.h"
#include "worker/gltf/extension.h"

namespace strata {

/// How a material names a texture.
struct TextureReference {
  int index = -1;  ///< Into the file's textures; -1: none.
  int tex_coord = 0;
  UvMapping mapping;  ///< KHR_texture_transform, for texture coordinates with v upwards.
  double scale = 1;   ///< Of a normal map.
  std::string element;
};

/// From a texture info of any kind. INVALID_ARGUMENT for a transform that is none.
template <typename Info>
absl::StatusOr<TextureReference> ReferTo(const GltfDocument& document, const Info& info,
                                         const std::string& element);
/// From the property of an extension.
absl::StatusOr<TextureReference> ReferTo(const GltfDocument& document,
                                         const GltfExtension& extension, const std::string& name);

/// The mapping of KHR_texture_transform. glTF's v points down in the image, that of a mapping up.
UvMapping TextureTransform(double offset_u, double offset_v, double rotation, double scale_u,
                           double scale_v);

/// Makes the textures of a scene.
class TextureMaker {
 public:
  explicit TextureMaker(GltfDocument& document) : document_(document) {}

  /// The set of texture coordinates that is the second of the meshes whose textures come next, -1
  /// if they have no second.
  void SetSecondCoordinates(int set) { second_set_ = set; }

  TextureId Constant(Rgb value);
  /// An image of colours, sRGB unless `linear`.
  absl::StatusOr<TextureId> Color(const TextureReference& reference, bool linear = false);
  /// The alpha channel of an image; 1 if it has none.
  absl::StatusOr<TextureId> Alpha(const TextureReference& reference);
  /// One channel of an image, linear, times `factor`.
  absl::StatusOr<TextureId> Channel(const TextureReference& reference, int channel, double factor);
  /// a b, where kNoTexture is 1.
  TextureId Product(TextureId a, TextureId b);
  TextureId Add(TextureDescription texture);

 private:
  absl::StatusOr<ImageTexture> Image(const TextureReference& reference);
  absl::Status SetImage(int image, const std::string& element, ImageTexture* texture);

  GltfDocument& document_;
  int second_set_ = -1;
  std::map<int, std::shared_ptr<const EmbeddedImage>> embedded_;  ///< By image.
};

}  // namespace strata
