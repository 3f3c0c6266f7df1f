#include "worker/gltf/plain_json.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/text.h"

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kLengthBegin = 12, kJsonBegin = 20;

/// Numbers without a fraction become integers, and with that indices. Returns whether any did.
bool MakeIntegers(Json& json) {
  bool changed = false;
  if (json.is_structured()) {
    for (Json& value : json) changed |= MakeIntegers(value);
  } else if (json.is_number_float()) {
    const double value = json.get<double>();
    if (value == std::floor(value) && std::fabs(value) < 0x1p53) {
      json = static_cast<int64_t>(value);
      changed = true;
    }
  }
  return changed;
}

int HexDigit(char c) {
  return absl::ascii_isxdigit(c) ? (c <= '9' ? c - '0' : absl::ascii_tolower(c) - 'a' + 10) : -1;
}
/// Whether an escape of two digits stands at `i`.
bool IsEscape(std::string_view uri, size_t i) {
  return uri[i] == '%' && i + 2 < uri.size() && HexDigit(uri[i + 1]) >= 0 &&
         HexDigit(uri[i + 2]) >= 0;
}

/// A path with '+', and '%' that is no escape, escaped.
std::string EscapePath(std::string_view uri) {
  std::string escaped;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '+')
      escaped += "%2B";
    else if (uri[i] == '%' && !IsEscape(uri, i))
      escaped += "%25";
    else
      escaped += uri[i];
  }
  return escaped;
}

/// Base64 without escapes.
std::string Unescape(std::string_view payload) {
  std::string plain;
  plain.reserve(payload.size());
  for (size_t i = 0; i < payload.size(); ++i) {
    if (IsEscape(payload, i)) {
      plain += static_cast<char>(16 * HexDigit(payload[i + 1]) + HexDigit(payload[i + 2]));
      i += 2;
    } else {
      plain += payload[i];
    }
  }
  return plain;
}

/// What the elements of `array` name by a URI; a data URI becomes one of `media_type`.
absl::Status MakeUrisPlain(const GltfDocument& document, Json& json, const char* array,
                           std::string_view media_type, bool escape_paths, bool* changed) {
  if (!json.contains(array) || !json[array].is_array()) return absl::OkStatus();
  int index = -1;
  for (Json& element : json[array]) {
    ++index;
    if (!element.is_object() || !element.contains("uri") || !element["uri"].is_string()) continue;
    const std::string& uri = element["uri"].get_ref<const std::string&>();
    std::string plain = uri;
    if (absl::StartsWithIgnoreCase(uri, "data:")) {
      constexpr std::string_view kMark = ";base64,";
      const size_t mark = std::string_view(uri).substr(0, uri.find(',') + 1).find(kMark);
      if (mark == std::string::npos)
        return document.Error(ElementName(array, index) + ".uri",
                              "its data URI is not in base64; write it as data:...;base64,...");
      plain = StrCat("data:", media_type, kMark, Unescape(uri.substr(mark + kMark.size())));
    } else if (escape_paths) {
      plain = EscapePath(uri);
    }
    if (plain == uri) continue;
    element["uri"] = std::move(plain);
    *changed = true;
  }
  return absl::OkStatus();
}

std::vector<uint64_t> FileLengths(const Json& json) {
  std::vector<uint64_t> lengths;
  if (!json.contains("buffers") || !json["buffers"].is_array()) return lengths;
  for (const Json& buffer : json["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string() ||
        absl::StartsWith(buffer["uri"].get_ref<const std::string&>(), "data:"))
      continue;
    const bool known = buffer.contains("byteLength") && buffer["byteLength"].is_number_unsigned();
    lengths.push_back(known ? buffer["byteLength"].get<uint64_t>() : 0);
  }
  return lengths;
}

/// A skin without inverseBindMatrices, which tinygltf misses, has those of index -1: none.
bool NameMissingMatrices(Json& json) {
  bool changed = false;
  if (!json.contains("skins") || !json["skins"].is_array()) return changed;
  for (Json& skin : json["skins"]) {
    if (!skin.is_object() || skin.contains("inverseBindMatrices")) continue;
    skin["inverseBindMatrices"] = -1;
    changed = true;
  }
  return changed;
}

/// asset.minVersion above 2.0: the file cannot be understood without what came after.
absl::Status CheckMinVersion(const GltfDocument& document, const Json& json) {
  if (!json.contains("asset") || !json["asset"].is_object()) return absl::OkStatus();
  const Json& asset = json["asset"];
  if (!asset.contains("minVersion") || !asset["minVersion"].is_string()) return absl::OkStatus();
  const std::string text = asset["minVersion"].get<std::string>();
  double version = 0;
  if (absl::SimpleAtod(text, &version) && version <= 2) return absl::OkStatus();
  return document.Error("asset.minVersion", StrCat("the file needs glTF ", text,
                                                   ", which is not supported; write it as 2.0"));
}

/// What a property of a material must be.
struct Property {
  const char* name;
  size_t numbers = 1;    ///< An array of so many, if more than one.
  bool fraction = true;  ///< Each within 0 and 1.
};

absl::Status CheckNumbers(const GltfDocument& document, const Json& object,
                          const Property& property, const std::string& element) {
  if (!object.is_object() || !object.contains(property.name)) return absl::OkStatus();
  const Json& value = object[property.name];
  const auto sound = [&](const Json& number) {
    if (!number.is_number()) return false;
    const double x = number.get<double>();
    return x >= 0 && (x <= 1 || !property.fraction);
  };
  const bool all = property.numbers == 1 ? sound(value)
                                         : value.is_array() && value.size() == property.numbers &&
                                               std::all_of(value.begin(), value.end(), sound);
  if (all) return absl::OkStatus();
  return document.Error(
      StrCat(element, ".", property.name),
      StrCat("it must be ",
             property.numbers == 1 ? "a number" : StrCat(property.numbers, " numbers"),
             property.fraction ? " within 0 and 1" : " not below 0"));
}

/// tinygltf takes what has a wrong type for what is not there.
absl::Status CheckMaterials(const GltfDocument& document, const Json& json) {
  if (!json.contains("materials") || !json["materials"].is_array()) return absl::OkStatus();
  int index = -1;
  for (const Json& material : json["materials"]) {
    const std::string name = ElementName("materials", ++index), pbr = "pbrMetallicRoughness";
    if (!material.is_object()) return document.Error(name, "it must be an object");
    for (const Property& property :
         {Property{"emissiveFactor", 3, false}, Property{"alphaCutoff", 1, false}})
      STRATA_RETURN_IF_ERROR(CheckNumbers(document, material, property, name));
    for (const Property& property : {Property{"baseColorFactor", 4}, Property{"metallicFactor"},
                                     Property{"roughnessFactor"}}) {
      if (material.contains(pbr))
        STRATA_RETURN_IF_ERROR(
            CheckNumbers(document, material[pbr], property, StrCat(name, ".", pbr)));
    }
    if (material.contains("doubleSided") && !material["doubleSided"].is_boolean())
      return document.Error(name + ".doubleSided", "it must be true or false");
    if (!material.contains("alphaMode")) continue;
    const Json& mode = material["alphaMode"];
    if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
      return document.Error(name + ".alphaMode", "it must be OPAQUE, MASK or BLEND");
  }
  return absl::OkStatus();
}

/// The .glb with other JSON.
std::string WithJson(std::string_view glb, std::string json, size_t old_json_size) {
  while (json.size() % 4 != 0) json += ' ';
  const std::string_view rest =
      glb.substr(std::min(glb.size(), kJsonBegin + (old_json_size + 3) / 4 * 4));
  std::string bytes(glb.substr(0, kJsonBegin));
  bytes += json;
  bytes += rest;
  constexpr size_t kTotalBegin = 8;
  const auto total = static_cast<uint32_t>(bytes.size()),
             length = static_cast<uint32_t>(json.size());
  std::memcpy(bytes.data() + kTotalBegin, &total, sizeof total);
  std::memcpy(bytes.data() + kLengthBegin, &length, sizeof length);
  return bytes;
}

}  // namespace

std::string_view JsonPart(std::string_view bytes, bool binary) {
  if (!binary || bytes.size() < kJsonBegin) return bytes;
  uint32_t length = 0;
  std::memcpy(&length, bytes.data() + kLengthBegin, sizeof length);
  return bytes.substr(kJsonBegin, length);
}

absl::StatusOr<PlainGltf> MakePlain(const GltfDocument& document, std::string bytes, bool binary) {
  const std::string_view text = JsonPart(bytes, binary);
  const size_t text_size = text.size();
  Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return PlainGltf{std::move(bytes), {}};
  STRATA_RETURN_IF_ERROR(CheckMinVersion(document, json));
  STRATA_RETURN_IF_ERROR(CheckMaterials(document, json));
  bool changed = MakeIntegers(json);
  changed |= NameMissingMatrices(json);
  STRATA_RETURN_IF_ERROR(MakeUrisPlain(document, json, "buffers", "application/octet-stream",
                                       /*escape_paths=*/true, &changed));
  STRATA_RETURN_IF_ERROR(MakeUrisPlain(document, json, "images", "image/png",
                                       /*escape_paths=*/false, &changed));
  PlainGltf plain = {{}, FileLengths(json)};
  if (!changed)
    plain.bytes = std::move(bytes);
  else if (binary)
    plain.bytes = WithJson(bytes, json.dump(), text_size);
  else
    plain.bytes = json.dump();
  return plain;
}

}  // namespace strata
