#pragma once

#include <cstdint>

namespace strata {

/// Grows with every change that may alter the bits of a sample.
inline constexpr uint32_t kKernelRevision = 17;

}  // namespace strata
