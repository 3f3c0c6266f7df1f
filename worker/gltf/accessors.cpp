#include "worker/gltf/accessors.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

namespace strata {
namespace {

static_assert(std::endian::native == std::endian::little, "as glTF's buffers are");

/// What an accessor without a buffer may claim.
constexpr uint64_t kMaxZeros = uint64_t{1} << 22;

/// Elements in a buffer, every one within it.
struct Elements {
  const char* first = nullptr;  ///< Null: all are 0.
  uint64_t count = 0, stride = 0;
  int component_type = 0, components = 0;
  bool normalized = false;
};

uint64_t ComponentBytes(int type) {
  const int32_t bytes = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type));
  return bytes > 0 && type != TINYGLTF_COMPONENT_TYPE_DOUBLE ? static_cast<uint64_t>(bytes) : 0;
}

absl::StatusOr<Elements> Locate(const GltfDocument& document, int view, uint64_t offset,
                                Elements elements, const std::string& element) {
  const uint64_t component = ComponentBytes(elements.component_type);
  if (component == 0)
    return document.Error(element, absl::StrCat("the component type ", elements.component_type,
                                                " is none of glTF's"));
  const uint64_t size = component * static_cast<uint64_t>(elements.components);
  STRATA_ASSIGN_OR_RETURN(const std::string_view bytes, ReadBufferView(document, view, element));
  const uint64_t stride = document.model().bufferViews[view].byteStride;
  elements.stride = stride == 0 ? size : stride;
  constexpr uint64_t kMaxStride = 1 << 16;
  if (elements.stride < size || elements.stride > kMaxStride)
    return document.Error(element, absl::StrCat("a stride of ", stride, " bytes does not suit the ",
                                                size, " of an element"));
  const bool fits = elements.count <= bytes.size() && offset <= bytes.size() &&
                    (elements.count == 0 ||
                     (elements.count - 1) * elements.stride + size <= bytes.size() - offset);
  if (!fits)
    return document.Error(element, absl::StrCat("its ", elements.count, " elements of ", size,
                                                " bytes reach beyond the ", bytes.size(),
                                                " bytes of bufferViews[", view, "]"));
  elements.first = bytes.data() + offset;
  return elements;
}

template <typename T>
float ToNumber(T value, bool normalized) {
  if (std::is_floating_point_v<T> || !normalized) return static_cast<float>(value);
  const double most = static_cast<double>(std::numeric_limits<T>::max());
  return static_cast<float>(std::max(static_cast<double>(value) / most, -1.0));
}

/// Calls f with a value of the type; one of glTF's.
template <typename F>
void WithType(int component_type, F f) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return f(int8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return f(uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return f(int16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return f(uint16_t{});
    case TINYGLTF_COMPONENT_TYPE_INT:
      return f(int32_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return f(uint32_t{});
    default:
      return f(float{});
  }
}

/// Element i goes to `to(i)`, a place for its components.
template <typename Target, typename To>
void Copy(const Elements& elements, To to) {
  WithType(elements.component_type, [&](auto zero) {
    using T = decltype(zero);
    for (uint64_t i = 0; i < elements.count; ++i) {
      Target* target = to(i);
      for (int c = 0; c < elements.components; ++c) {
        T value = 0;
        if (elements.first)
          std::memcpy(&value, elements.first + i * elements.stride + c * sizeof(T), sizeof(T));
        if constexpr (std::is_same_v<Target, float>) {
          target[c] = ToNumber(value, elements.normalized);
        } else {
          target[c] = static_cast<Target>(value);
        }
      }
    }
  });
}

absl::StatusOr<Elements> FindElements(const GltfDocument& document, int index, int min_components,
                                      int max_components, const std::string& element) {
  STRATA_ASSIGN_OR_RETURN(const tinygltf::Accessor* accessor,
                          document.Find(document.model().accessors, index, "accessor", element));
  const std::string name = ElementName("accessors", index);
  Elements elements;
  elements.count = accessor->count;
  elements.component_type = accessor->componentType;
  elements.normalized = accessor->normalized;
  elements.components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor->type));
  if (elements.components < min_components || elements.components > max_components)
    return document.Error(
        name,
        absl::StrCat("it has ", elements.components, " components, but ", element, " takes ",
                     min_components,
                     max_components > min_components ? absl::StrCat(" to ", max_components) : ""));
  if (accessor->bufferView >= 0)
    return Locate(document, accessor->bufferView, accessor->byteOffset, elements, name);
  if (ComponentBytes(elements.component_type) == 0 || elements.count > kMaxZeros)
    return document.Error(name, "it has no buffer view and no sound type and count");
  return elements;
}

std::vector<uint32_t> ReadIntegers(const Elements& elements) {
  std::vector<uint32_t> values(elements.count);
  Copy<uint32_t>(elements, [&](uint64_t i) { return &values[i]; });
  return values;
}

/// Puts the sparse accessor's replacements (glTF 2.0, 3.6.2.3) into `values`.
template <typename Target>
absl::Status ApplySparse(const GltfDocument& document, int index, const Elements& base,
                         std::vector<Target>* values) {
  const auto& sparse = document.model().accessors[index].sparse;
  if (!sparse.isSparse) return absl::OkStatus();
  const std::string name = ElementName("accessors", index) + ".sparse";
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    return document.Error(name, "a count or an offset is negative");
  if (sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
    return document.Error(name, "indices must be integers");
  Elements indices{nullptr, static_cast<uint64_t>(sparse.count), 0, sparse.indices.componentType,
                   1};
  STRATA_ASSIGN_OR_RETURN(indices,
                          Locate(document, sparse.indices.bufferView,
                                 static_cast<uint64_t>(sparse.indices.byteOffset), indices, name));
  Elements replacements = base;
  replacements.count = indices.count;
  STRATA_ASSIGN_OR_RETURN(
      replacements, Locate(document, sparse.values.bufferView,
                           static_cast<uint64_t>(sparse.values.byteOffset), replacements, name));
  const std::vector<uint32_t> places = ReadIntegers(indices);
  for (const uint32_t place : places) {
    if (place >= base.count)
      return document.Error(name, absl::StrCat("it replaces element ", place, " of ", base.count));
  }
  Copy<Target>(replacements, [&](uint64_t i) {
    return &(*values)[uint64_t{places[i]} * static_cast<uint64_t>(base.components)];
  });
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string_view> ReadBufferView(const GltfDocument& document, int view,
                                                const std::string& element) {
  const tinygltf::Model& model = document.model();
  STRATA_ASSIGN_OR_RETURN(const tinygltf::BufferView* found,
                          document.Find(model.bufferViews, view, "buffer view", element));
  const std::string name = ElementName("bufferViews", view);
  STRATA_ASSIGN_OR_RETURN(const tinygltf::Buffer* buffer,
                          document.Find(model.buffers, found->buffer, "buffer", name));
  if (found->byteOffset > buffer->data.size() ||
      found->byteLength > buffer->data.size() - found->byteOffset)
    return document.Error(name, absl::StrCat("it reaches beyond the ", buffer->data.size(),
                                             " bytes of buffers[", found->buffer, "]"));
  return std::string_view(reinterpret_cast<const char*>(buffer->data.data()) + found->byteOffset,
                          found->byteLength);
}

absl::StatusOr<FloatAttribute> ReadFloats(const GltfDocument& document, int accessor,
                                          int min_components, int max_components,
                                          const std::string& element) {
  STRATA_ASSIGN_OR_RETURN(const Elements elements, FindElements(document, accessor, min_components,
                                                                max_components, element));
  FloatAttribute attribute;
  attribute.components = elements.components;
  attribute.values.resize(elements.count * static_cast<uint64_t>(elements.components));
  Copy<float>(elements, [&](uint64_t i) { return &attribute.values[i * attribute.components]; });
  STRATA_RETURN_IF_ERROR(ApplySparse(document, accessor, elements, &attribute.values));
  return attribute;
}

absl::StatusOr<std::vector<Vec3f>> ReadVectors(const GltfDocument& document, int accessor,
                                               const std::string& element) {
  STRATA_ASSIGN_OR_RETURN(const FloatAttribute read, ReadFloats(document, accessor, 3, 3, element));
  std::vector<Vec3f> vectors(read.Count());
  for (size_t i = 0; i < vectors.size(); ++i) {
    vectors[i] = {read.values[3 * i], read.values[3 * i + 1], read.values[3 * i + 2]};
    if (!IsFinite(vectors[i]))
      return document.Error(element, absl::StrCat("element ", i, " is not finite"));
  }
  return vectors;
}

absl::StatusOr<std::vector<uint32_t>> ReadIndices(const GltfDocument& document, int accessor,
                                                  const std::string& element) {
  STRATA_ASSIGN_OR_RETURN(const Elements elements, FindElements(document, accessor, 1, 1, element));
  if (elements.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT)
    return document.Error(ElementName("accessors", accessor), "indices must be integers");
  std::vector<uint32_t> values = ReadIntegers(elements);
  STRATA_RETURN_IF_ERROR(ApplySparse(document, accessor, elements, &values));
  return values;
}

}  // namespace strata
