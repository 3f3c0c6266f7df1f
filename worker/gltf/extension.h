#pragma once

#include <string>
#include <vector>

#include "worker/gltf/document.h"

namespace strata {

/// An extension of an element, and its properties with their types checked; what is not given has
/// the specification's default.
class GltfExtension {
 public:
  /// The extension `name` of the element whose extensions are `all`; may be absent.
  GltfExtension(const GltfDocument& document, const tinygltf::ExtensionMap& all,
                const std::string& name, const std::string& element)
      : document_(document), element_(element + ".extensions." + name) {
    const auto found = all.find(name);
    if (found != all.end() && found->second.IsObject()) value_ = &found->second;
  }
  /// An object with the properties.
  GltfExtension(const GltfDocument& document, const tinygltf::Value& object,
                const std::string& element)
      : document_(document), value_(object.IsObject() ? &object : nullptr), element_(element) {}

  bool present() const { return value_ != nullptr; }
  const std::string& element() const { return element_; }
  bool Has(const std::string& name) const { return value_ && value_->Has(name); }
  const tinygltf::Value& Get(const std::string& name) const { return value_->Get(name); }

  /// INVALID_ARGUMENT when the property is no finite number.
  absl::StatusOr<double> Number(const std::string& name, double otherwise) const;
  /// Exactly as many numbers as `otherwise` has.
  absl::StatusOr<std::vector<double>> Numbers(const std::string& name,
                                              std::vector<double> otherwise) const;
  /// -1 when it is not given.
  absl::StatusOr<int> Index(const std::string& name) const;

 private:
  const GltfDocument& document_;
  const tinygltf::Value* value_ = nullptr;
  std::string element_;
};

}  // namespace strata
