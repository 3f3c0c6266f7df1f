#include "worker/sampling/alias_table.h"

#include <algorithm>
#include <cmath>

namespace strata {

AliasTable::AliasTable(std::span<const double> weights) : bins_(weights.size()) {
  const size_t n = weights.size();
  std::vector<double> heights;  // In units of a bin: 1 on average.
  double total = 0;
  for (const double weight : weights) {
    heights.push_back(weight > 0 && std::isfinite(weight) ? weight : 0);
    total += heights.back();
  }
  const bool uniform = !(total > 0) || !std::isfinite(total);
  std::vector<int32_t> low, high;
  for (size_t i = 0; i < n; ++i) {
    heights[i] = uniform ? 1 : heights[i] / total * static_cast<double>(n);
    bins_[i].probability = static_cast<float>(heights[i] / static_cast<double>(n));
    bins_[i].other = static_cast<int32_t>(i);
    (heights[i] < 1 ? low : high).push_back(static_cast<int32_t>(i));
  }
  // A high outcome fills up the bin of a low one and thereby gets lower itself.
  while (!low.empty() && !high.empty()) {
    const int32_t l = low.back(), h = high.back();
    low.pop_back();
    bins_[l].own = heights[l];
    bins_[l].other = h;
    heights[h] -= 1 - heights[l];
    if (heights[h] < 1) {
      high.pop_back();
      low.push_back(h);
    }
  }
  // Those left are 1 but for rounding, and keep their bins whole.
}

AliasTable::Choice AliasTable::Choose(double u) const {
  const double place = u * outcomes();
  const int bin = std::min(static_cast<int>(place), outcomes() - 1);
  const double rest = place - bin, own = bins_[bin].own;
  const bool is_own = rest < own;
  const int outcome = is_own ? bin : bins_[bin].other;
  const double fraction = is_own ? rest / own : (rest - own) / (1 - own);
  return {outcome, bins_[outcome].probability, std::min(fraction, 1 - 0x1p-53)};
}

}  // namespace strata
