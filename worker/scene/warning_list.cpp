#include "worker/scene/warning_list.h"

#include <utility>

#include "common/text.h"

namespace strata {

void WarningList::Add(const SourceLocation& where, std::string_view text) {
  const auto [it, is_new] = index_.try_emplace(std::string(text), entries_.size());
  if (is_new) entries_.push_back({{where, std::string(text)}, 0});
  ++entries_[it->second].count;
}

std::vector<SceneWarning> WarningList::Take() {
  std::vector<SceneWarning> warnings;
  for (Entry& entry : entries_) {
    if (entry.count > 1) absl::StrAppend(&entry.warning.text, " (", entry.count, " times)");
    warnings.push_back(std::move(entry.warning));
  }
  entries_.clear();
  index_.clear();
  return warnings;
}

}  // namespace strata
