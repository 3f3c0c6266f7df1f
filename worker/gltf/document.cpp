#include "worker/gltf/document.h"

#include <absl/strings/match.h>
#include <absl/strings/str_replace.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <limits>
#include <utility>

#include "common/bundle.h"
#include "common/text.h"
#include "worker/gltf/plain_json.h"

namespace strata {
namespace {

constexpr uint64_t kMaxFileBytes = std::numeric_limits<uint32_t>::max();

/// What is done with an extension that a file uses. Those not listed are not known.
struct Extension {
  std::string_view name;
  bool supported;
  std::string_view remedy;  ///< For those that are not, if they are required.
};
constexpr std::string_view kUncompressed =
    "its meshes are compressed; write them uncompressed, for example by 'gltf-transform copy'";
constexpr std::string_view kPlainImages =
    "its images are of another format; convert them to PNG or JPEG";
constexpr std::array kExtensions = {
    Extension{"EXT_mesh_gpu_instancing", true, ""},
    Extension{"KHR_lights_punctual", true, ""},
    Extension{"KHR_materials_clearcoat", true, ""},
    Extension{"KHR_materials_emissive_strength", true, ""},
    Extension{"KHR_materials_ior", true, ""},
    Extension{"KHR_materials_specular", true, ""},
    Extension{"KHR_materials_transmission", true, ""},
    Extension{"KHR_materials_unlit", true, ""},
    Extension{"KHR_materials_volume", true, ""},
    Extension{"KHR_mesh_quantization", true, ""},
    Extension{"KHR_texture_transform", true, ""},
    Extension{"EXT_meshopt_compression", false, kUncompressed},
    Extension{"EXT_texture_avif", false, kPlainImages},
    Extension{"EXT_texture_webp", false, kPlainImages},
    Extension{"KHR_draco_mesh_compression", false, kUncompressed},
    Extension{"KHR_texture_basisu", false, kPlainImages},
    Extension{"MSFT_texture_dds", false, kPlainImages},
};

const Extension* FindExtension(std::string_view name) {
  const auto found = std::find_if(kExtensions.begin(), kExtensions.end(),
                                  [&](const Extension& e) { return e.name == name; });
  return found == kExtensions.end() ? nullptr : &*found;
}

/// Files of compressed data may be unsound for one that does not know of them.
std::string RemedyOf(const std::vector<std::string>& extensions) {
  for (const std::string& name : extensions) {
    const Extension* extension = FindExtension(name);
    if (extension && !extension->supported)
      return StrCat("; ", name, " is not supported: ", extension->remedy);
  }
  return "";
}

/// tinygltf's words, of which there may be several lines, in one.
std::string OneSentence(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  absl::StrReplaceAll({{"[json.exception.", ""}, {"parse_error.101] ", ""}}, &text);
  while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
  return text.empty() ? "the file cannot be understood" : text;
}

/// Brackets open at once. Values are copied by recursion, so there must be an end to it.
bool NestsTooDeeply(std::string_view json) {
  constexpr int kMaxDepth = 200;
  int depth = 0;
  bool quoted = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxDepth) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

/// Keeps the bytes of an embedded image; those in buffers are looked up when they are needed.
bool KeepImageBytes(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                    const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

/// Lets tinygltf read files of a document. Its own words do not say why a file is out of reach, so
/// the status is kept.
struct FileAccess {
  GltfDocument* document;
  const FileSource* source;
  std::vector<uint64_t> lengths;  ///< Of the buffers, in the order in which they are asked for.
  absl::Status status;
  size_t next = 0;
};

bool NameIsFile(const std::string& name, void*) { return !name.empty(); }
std::string SameName(const std::string& name, void*) { return name; }

bool ReadBuffer(std::vector<unsigned char>* bytes, std::string*, const std::string& name,
                void* access_pointer) {
  auto& access = *static_cast<FileAccess*>(access_pointer);
  const auto read = [&]() -> absl::Status {
    STRATA_ASSIGN_OR_RETURN(const std::string path, access.document->AddFile(name, "buffers"));
    STRATA_ASSIGN_OR_RETURN(const std::filesystem::path local, access.source->Locate(path));
    const absl::StatusOr<std::string> text = ReadWholeFile(local, kMaxFileBytes);
    if (!text.ok()) return Annotate(text.status(), StrCat("\"", path, "\""));
    // A buffer is the file's beginning, as much as it says (glTF 2.0, 3.6.1.1).
    const size_t next = access.next++;
    const uint64_t length = next < access.lengths.size() ? access.lengths[next] : text->size();
    bytes->assign(text->begin(), text->begin() + std::min<uint64_t>(length, text->size()));
    return absl::OkStatus();
  };
  access.status = read();
  return access.status.ok();
}

}  // namespace

std::string ElementName(std::string_view array, int index) {
  return StrCat(array, "[", index, "]");
}

GltfDocument::GltfDocument(const FileSource& source, const std::string& scene_path)
    : source_(source),
      file_(scene_path),
      directory_(std::filesystem::path(scene_path).parent_path().generic_string()) {}

absl::StatusOr<GltfDocument> GltfDocument::Load(const FileSource& source,
                                                const std::string& scene_path) {
  if (!IsBundlePath(scene_path)) {
    return absl::InvalidArgumentError(
        StrCat("the scene \"", scene_path, "\" must be a path relative to its root"));
  }
  GltfDocument document(source, scene_path);
  document.files.insert(scene_path);
  STRATA_RETURN_IF_ERROR(document.Parse());
  document.WarnOfExtensions();
  return document;
}

absl::Status GltfDocument::Parse() {
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path path, source_.Locate(file_));
  absl::StatusOr<std::string> file = ReadWholeFile(path, kMaxFileBytes);
  if (!file.ok()) return Annotate(file.status(), file_);
  const bool binary = absl::StartsWith(*file, "glTF");
  if (NestsTooDeeply(JsonPart(*file, binary)))
    return Error("", "the JSON is nested more than 200 deep");
  STRATA_ASSIGN_OR_RETURN(PlainGltf plain, MakePlain(*this, *std::move(file), binary));

  const std::string& bytes = plain.bytes;
  FileAccess access{this, &source_, std::move(plain.file_lengths), absl::OkStatus()};
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(KeepImageBytes, nullptr);
  parser.SetFsCallbacks({NameIsFile, SameName, ReadBuffer, nullptr, &access});
  std::string error, warning;
  bool understood = false;
  // nlohmann's JSON and what tinygltf does with it throw on some malformed files.
  try {
    const auto size = static_cast<unsigned int>(bytes.size());
    understood =
        binary ? parser.LoadBinaryFromMemory(&model_, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(bytes.data()),
                                             size, "")
               : parser.LoadASCIIFromString(&model_, &error, &warning, bytes.data(), size, "");
  } catch (const std::exception& e) {
    error = e.what();
  }
  // Files that require an extension may be unsound without it, as those of compressed buffers.
  STRATA_RETURN_IF_ERROR(CheckRequiredExtensions());
  if (!access.status.ok()) return access.status;
  if (!understood) return Error("", StrCat(OneSentence(error), RemedyOf(model_.extensionsUsed)));
  if (!absl::StartsWith(model_.asset.version, "2."))
    return Error("asset.version", StrCat("glTF ", model_.asset.version,
                                         " is not supported; convert the file to glTF 2.0"));
  if (!error.empty()) Warn("asset", OneSentence(error));
  return absl::OkStatus();
}

absl::Status GltfDocument::CheckRequiredExtensions() const {
  for (const std::string& name : model_.extensionsRequired) {
    const Extension* extension = FindExtension(name);
    if (extension && extension->supported) continue;
    return Error("extensionsRequired",
                 StrCat(name, " is not supported, and the file requires it",
                        extension ? StrCat(": ", extension->remedy) : "; write it without"));
  }
  return absl::OkStatus();
}

void GltfDocument::WarnOfExtensions() {
  for (const std::string& name : model_.extensionsUsed) {
    const Extension* extension = FindExtension(name);
    if (!extension || !extension->supported)
      Warn("extensionsUsed", StrCat(name, " is not supported and left out"));
  }
}

absl::Status GltfDocument::Error(const std::string& element, std::string_view text) const {
  return absl::InvalidArgumentError(element.empty() ? StrCat(file_, ": ", text)
                                                    : StrCat(file_, ":", element, ": ", text));
}

absl::StatusOr<std::string> GltfDocument::AddFile(const std::string& uri,
                                                  const std::string& element) {
  const std::string where = At(element).ToString();
  if (absl::StartsWithIgnoreCase(uri, "file:"))
    return Error(element, StrCat("\"", uri,
                                 "\" is a place on one machine; name the file by a path "
                                 "beside the scene"));
  if (uri.find("://") != std::string::npos)
    return Error(element, StrCat("\"", uri, "\" is on a network; put the file beside the scene"));
  absl::StatusOr<std::string> path = ResolveBundlePath(directory_, uri);
  if (!path.ok()) return Annotate(path.status(), where);
  const absl::Status there = source_.Locate(*path).status();
  if (!there.ok()) return Annotate(there, where);
  files.insert(*path);
  return path;
}

}  // namespace strata
