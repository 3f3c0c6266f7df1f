#include "worker/gltf/vertex_colors.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace strata {
namespace {

/// Component `c` of vertex `v`; alpha is 1 where there is none.
float At(const FloatAttribute& colors, size_t v, int c) {
  return c < colors.components ? colors.values[v * static_cast<size_t>(colors.components) + c] : 1;
}

}  // namespace

std::optional<VertexColor> ConstantColor(const FloatAttribute& colors) {
  for (size_t v = 1; v < colors.Count(); ++v) {
    for (int c = 0; c < 4; ++c) {
      if (At(colors, v, c) != At(colors, 0, c)) return std::nullopt;
    }
  }
  VertexColor color;
  if (colors.Count() == 0) return color;
  color.constant = {At(colors, 0, 0), At(colors, 0, 1), At(colors, 0, 2)};
  color.constant_alpha = At(colors, 0, 3);
  return color;
}

VertexColor PaintTriangles(const FloatAttribute& colors, const SourceLocation& where,
                           TriangleMeshShape* mesh, TextureMaker& textures) {
  constexpr int kChannels = 4;
  const size_t count = mesh->triangles.size();
  const size_t columns = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const size_t rows = (count + columns - 1) / columns;
  ImageFile image;
  image.width = static_cast<int>(2 * columns);
  image.height = static_cast<int>(2 * rows);
  image.channels = kChannels;
  image.values.resize(size_t{4} * columns * rows * kChannels);

  const bool second = !mesh->uvs.empty();
  TriangleMeshShape apart;
  std::vector<Vec2f>& image_uvs = second ? apart.second_uvs : apart.uvs;
  bool opaque = true;
  for (size_t t = 0; t < count; ++t) {
    const size_t x = 2 * (t % columns), y = 2 * (t / columns);
    // Texels in the order of the corners: upper left, upper right, lower left.
    constexpr size_t kTexelX[3] = {0, 1, 0}, kTexelY[3] = {0, 0, 1};
    const auto texel = [&](size_t dx, size_t dy) {
      return &image.values[((y + dy) * 2 * columns + x + dx) * kChannels];
    };
    for (size_t corner = 0; corner < 3; ++corner) {
      const uint32_t vertex = mesh->triangles[t][corner];
      for (int c = 0; c < kChannels; ++c)
        texel(kTexelX[corner], kTexelY[corner])[c] = At(colors, vertex, c);
      opaque &= At(colors, vertex, 3) == 1;
      apart.positions.push_back(mesh->positions[vertex]);
      if (!mesh->normals.empty()) apart.normals.push_back(mesh->normals[vertex]);
      if (second) apart.uvs.push_back(mesh->uvs[vertex]);
      const double s = (static_cast<double>(x + kTexelX[corner]) + 0.5) / image.width;
      const double t_down = (static_cast<double>(y + kTexelY[corner]) + 0.5) / image.height;
      image_uvs.push_back({static_cast<float>(s), static_cast<float>(1 - t_down)});
    }
    for (int c = 0; c < kChannels; ++c)
      texel(1, 1)[c] = texel(1, 0)[c] + texel(0, 1)[c] - texel(0, 0)[c];
    const uint32_t first = static_cast<uint32_t>(3 * t);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  *mesh = std::move(apart);

  ImageTexture texture;
  texture.path = where.ToString();
  texture.where = where;
  texture.wrap = ImageWrap::kClamp;
  texture.encoding = ImageEncoding::kLinear;
  texture.second_uv = second;
  texture.embedded = std::make_shared<const EmbeddedImage>(std::move(image));
  VertexColor color;
  color.color = textures.Add(texture);
  if (opaque) return color;
  texture.alpha = true;
  color.alpha = textures.Add(std::move(texture));
  return color;
}

}  // namespace strata
