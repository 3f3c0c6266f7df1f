#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/status.h"
#include "worker/gltf/tinygltf.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"
#include "worker/scene/warning_list.h"

namespace strata {

/// A glTF file as it is read: its JSON and buffers, and what is made of them so far. Shared by all
/// parts of the reader.
class GltfDocument {
 public:
  /// Reads the file `scene_path` (a bundle path) and its buffers. INVALID_ARGUMENT when it is no
  /// glTF 2.0, is cut short, or requires an extension that is not supported.
  static absl::StatusOr<GltfDocument> Load(const FileSource& source, const std::string& scene_path);

  const tinygltf::Model& model() const { return model_; }

  /// The place of an element, which is named as in "nodes[3].mesh".
  SourceLocation At(std::string element) const { return {file_, 0, std::move(element)}; }
  /// INVALID_ARGUMENT "file:element: text".
  absl::Status Error(const std::string& element, std::string_view text) const;
  void Warn(const std::string& element, std::string_view text) { warnings.Add(At(element), text); }

  /// The bundle path of a file that the element names by a URI; it becomes one of `files`.
  absl::StatusOr<std::string> AddFile(const std::string& uri, const std::string& element);

  /// The item an index names, or an error that says where the index is.
  template <typename Item>
  absl::StatusOr<const Item*> Find(const std::vector<Item>& items, int index, const char* what,
                                   const std::string& element) const {
    if (index >= 0 && static_cast<size_t>(index) < items.size()) return &items[index];
    return Error(element, absl::StrCat("there is no ", what, " ", index, ", only ", items.size()));
  }

  SceneDescription scene;
  WarningList warnings;
  std::set<std::string> files;  ///< Bundle paths.

 private:
  GltfDocument(const FileSource& source, const std::string& scene_path);
  absl::Status Parse();
  absl::Status CheckRequiredExtensions() const;
  void WarnOfExtensions();

  const FileSource& source_;
  const std::string file_;
  const std::string directory_;
  tinygltf::Model model_;
};

/// "meshes[2]"
std::string ElementName(std::string_view array, int index);

}  // namespace strata
