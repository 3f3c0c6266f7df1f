#pragma once

#include <string>
#include <string_view>

#include "common/digest.h"
#include "common/status.h"

// What the conversions of this folder share. `field` is the path of a field as its .proto names it,
// such as "spec.bundle.files[3].digest"; errors are INVALID_ARGUMENT "field: why".

namespace strata::wire {

absl::Status FieldError(std::string_view field, std::string_view why);

/// A digest is 32 bytes.
absl::StatusOr<Digest> ReadDigest(const std::string& bytes, std::string_view field);
std::string DigestBytes(const Digest& digest);

/// `text` has at most `limit` bytes, and at least one if `required`.
absl::Status CheckText(const std::string& text, size_t limit, bool required,
                       std::string_view field);

/// A job id: 1 to 64 printable ASCII characters without spaces.
absl::Status CheckJobId(const std::string& id, std::string_view field);

}  // namespace strata::wire
