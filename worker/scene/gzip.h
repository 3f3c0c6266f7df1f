#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/status.h"

namespace strata {

/// Whether bytes begin as those of a gzip file (RFC 1952).
bool IsGzip(std::string_view bytes);

/// What a gzip file holds, all its members in a row. INVALID_ARGUMENT when it is damaged or cut
/// short, or holds more than `limit` bytes.
absl::StatusOr<std::string> Gunzip(std::string_view bytes, uint64_t limit);

}  // namespace strata
