#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "worker/pbrt/tokenizer.h"
#include "worker/scene/description.h"

namespace strata {

/// What a file calls by a name, which may be used before its definition.
struct NamedPart {
  int32_t id = -1;
  SourceLocation first_use;
  bool defined = false;
};
using NamedParts = std::map<std::string, NamedPart>;

/// An error at the earliest use of a name that was never defined, if there is one. `what(name)`
/// says so.
template <typename What>
absl::Status CheckAllDefined(const NamedParts& parts, What what) {
  const NamedParts::value_type* first = nullptr;
  for (const auto& part : parts) {
    if (part.second.defined) continue;
    if (!first || part.second.first_use.line < first->second.first_use.line) first = &part;
  }
  return first ? ErrorAt(first->second.first_use, what(first->first)) : absl::OkStatus();
}

}  // namespace strata
