#pragma once

#include <absl/container/flat_hash_map.h>

#include <string>
#include <string_view>
#include <vector>

#include "worker/scene/description.h"

namespace strata {

/// Gathers what a person should know of a scene, each text once with the place it is first seen.
class WarningList {
 public:
  void Add(const SourceLocation& where, std::string_view text);
  /// In the order of their first appearance; those seen more often say how often.
  std::vector<SceneWarning> Take();

 private:
  struct Entry {
    SceneWarning warning;
    int count = 0;
  };
  std::vector<Entry> entries_;
  absl::flat_hash_map<std::string, size_t> index_;
};

}  // namespace strata
