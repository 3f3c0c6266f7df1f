#include "coordinator/partial_check.h"

#include <cmath>

namespace strata {

absl::Status CheckPartial(const Partial& partial, const WorkUnit& unit, const PixelLayout& layout) {
  const auto refuse = [](const char* reason) { return absl::InvalidArgumentError(reason); };
  if (partial.unit != unit.id) return refuse("it is another unit's");
  if (partial.pixels != unit.pixels) return refuse("its pixels are not the unit's");
  if (partial.layout != layout) return refuse("its channels are not the job's");
  const size_t pixels = static_cast<size_t>(unit.pixels.Pixels());
  const size_t doubles = static_cast<size_t>(layout.Doubles());
  if (partial.samples.size() != pixels || partial.values.size() != pixels * doubles ||
      partial.rays.size() != pixels || partial.nonfinite.size() != pixels) {
    return refuse("its vectors do not have one entry for each pixel");
  }
  for (size_t i = 0; i < pixels; ++i) {
    const uint32_t count = unit.RangeOf(static_cast<int64_t>(i)).Count();
    if (partial.samples[i] != count) return refuse("its sample counts are not the unit's");
    if (partial.nonfinite[i] > uint64_t{kReplicates} * count) {
      return refuse("it has more non-finite samples than samples");
    }
    const double* values = &partial.values[i * doubles];
    bool finite = true;
    for (size_t k = 0; k < doubles; ++k) finite &= std::isfinite(values[k]);
    if (!finite) return refuse("it holds a mean or moment that is not finite");
    for (int c = 0; c < layout.estimated; ++c) {
      if (values[layout.M2(c)] < 0) return refuse("it holds a negative second moment");
    }
  }
  return absl::OkStatus();
}

}  // namespace strata
