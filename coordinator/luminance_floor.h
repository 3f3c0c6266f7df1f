#pragma once

#include <vector>

#include "coordinator/pixel_statistics.h"

namespace strata {

/// For each pixel p the luminance from which on errors count relative to it: 5 % of the mean over
/// the image outside of p's 5x5, rounded to five binary digits (by at most 3 %); 0 in an image
/// without light. Figures of other pixels that enter a decision for p are all made with p's floor,
/// since theirs have p in them. Rounded, few floors occur in an image, mostly one or two, so that
/// sums over the image are made for each of these and not for each pixel. Requires HasOutside.
Plane LuminanceFloors(const PixelStatistics& statistics);

/// The distinct values of a plane that has few.
std::vector<double> DistinctValues(const Plane& plane);

}  // namespace strata
