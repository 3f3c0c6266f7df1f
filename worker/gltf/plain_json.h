#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/status.h"
#include "worker/gltf/document.h"

namespace strata {

/// A glTF file in words that tinygltf understands. It takes an index written as 1.0 for none at all
/// (glTF 2.0, 2.7 allows it), knows few media types of data URIs, takes '+' for a space, and misses
/// what skins may leave out.
struct PlainGltf {
  std::string bytes;  ///< Of a .gltf or .glb.
  /// byteLength of the buffers that are files of their own, in their order; these may be longer.
  std::vector<uint64_t> file_lengths;
};

/// Of the bytes of a .gltf, or of a .glb if `binary`; those of which the JSON cannot be read stay
/// as they are. INVALID_ARGUMENT where a data URI is not in base64, a factor of a material is not
/// what it must be, or the file asks for a later glTF.
absl::StatusOr<PlainGltf> MakePlain(const GltfDocument& document, std::string bytes, bool binary);

/// The JSON of a .glb, as long as its header says (glTF 2.0, 4.4); all of a .gltf.
std::string_view JsonPart(std::string_view bytes, bool binary);

}  // namespace strata
