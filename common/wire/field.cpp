#include "common/wire/field.h"

#include <algorithm>

namespace strata::wire {

absl::Status FieldError(std::string_view field, std::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat(absl::string_view(field.data(), field.size()),
                                                 ": ", absl::string_view(why.data(), why.size())));
}

absl::StatusOr<Digest> ReadDigest(const std::string& bytes, std::string_view field) {
  Digest digest;
  if (bytes.size() != digest.bytes.size()) {
    return FieldError(field, absl::StrCat("a digest has 32 bytes, not ", bytes.size()));
  }
  std::copy(bytes.begin(), bytes.end(), digest.bytes.begin());
  return digest;
}

std::string DigestBytes(const Digest& digest) {
  return std::string(digest.bytes.begin(), digest.bytes.end());
}

absl::Status CheckText(const std::string& text, size_t limit, bool required,
                       std::string_view field) {
  if (required && text.empty()) return FieldError(field, "must not be empty");
  if (text.size() > limit) {
    return FieldError(field,
                      absl::StrCat("has ", text.size(), " bytes, at most ", limit, " are allowed"));
  }
  return absl::OkStatus();
}

absl::Status CheckJobId(const std::string& id, std::string_view field) {
  STRATA_RETURN_IF_ERROR(CheckText(id, 64, true, field));
  if (!std::all_of(id.begin(), id.end(), [](char c) { return c > ' ' && c < 0x7f; })) {
    return FieldError(field, "a job id has printable characters alone, such as \"j-1\"");
  }
  return absl::OkStatus();
}

}  // namespace strata::wire
