#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace strata {

/// Insertions, deletions, substitutions and swaps of neighbours that lead from `a` to `b` (optimal
/// string alignment; Damerau 1964).
int EditDistance(std::string_view a, std::string_view b);

/// The known word nearest to `word`, or empty when none is near enough to be meant.
std::string NearestWord(std::string_view word, const std::vector<std::string>& known);

}  // namespace strata
