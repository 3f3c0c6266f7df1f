#include "worker/gltf/extension.h"

#include <cmath>

namespace strata {

absl::StatusOr<double> GltfExtension::Number(const std::string& name, double otherwise) const {
  if (!Has(name)) return otherwise;
  const tinygltf::Value& value = Get(name);
  if (!value.IsNumber() || !std::isfinite(value.GetNumberAsDouble()))
    return document_.Error(element_ + "." + name, "it must be a finite number");
  return value.GetNumberAsDouble();
}

absl::StatusOr<std::vector<double>> GltfExtension::Numbers(const std::string& name,
                                                           std::vector<double> otherwise) const {
  if (!Has(name)) return otherwise;
  const tinygltf::Value& value = Get(name);
  const absl::Status wrong = document_.Error(
      element_ + "." + name, absl::StrCat("it must be an array of ", otherwise.size(), " numbers"));
  if (!value.IsArray() || value.ArrayLen() != otherwise.size()) return wrong;
  for (size_t i = 0; i < otherwise.size(); ++i) {
    const tinygltf::Value& number = value.Get(static_cast<int>(i));
    if (!number.IsNumber() || !std::isfinite(number.GetNumberAsDouble())) return wrong;
    otherwise[i] = number.GetNumberAsDouble();
  }
  return otherwise;
}

absl::StatusOr<int> GltfExtension::Index(const std::string& name) const {
  if (!Has(name)) return -1;
  const tinygltf::Value& value = Get(name);
  if (!value.IsInt() || value.GetNumberAsInt() < 0)
    return document_.Error(element_ + "." + name, "it must be an index");
  return value.GetNumberAsInt();
}

}  // namespace strata
