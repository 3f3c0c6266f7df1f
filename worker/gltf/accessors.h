#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "worker/gltf/document.h"

// Numbers out of buffers (glTF 2.0, 3.6). All ranges are checked against the buffers: counts and
// offsets are claims of the file.

namespace strata {

/// Elements of 1 to 4 numbers, or the 16 of a matrix column by column, one after the other.
struct FloatAttribute {
  int components = 0;
  std::vector<float> values;
  size_t Count() const { return components == 0 ? 0 : values.size() / components; }
};

/// The accessor that `element` names, of min to max components. Integers become numbers: of
/// normalized ones the range becomes [0, 1] or [-1, 1].
absl::StatusOr<FloatAttribute> ReadFloats(const GltfDocument& document, int accessor,
                                          int min_components, int max_components,
                                          const std::string& element);

/// An accessor of three numbers; INVALID_ARGUMENT where one is not finite.
absl::StatusOr<std::vector<Vec3f>> ReadVectors(const GltfDocument& document, int accessor,
                                               const std::string& element);

/// An accessor of single unsigned integers.
absl::StatusOr<std::vector<uint32_t>> ReadIndices(const GltfDocument& document, int accessor,
                                                  const std::string& element);

/// The bytes of a buffer view.
absl::StatusOr<std::string_view> ReadBufferView(const GltfDocument& document, int view,
                                                const std::string& element);

}  // namespace strata
