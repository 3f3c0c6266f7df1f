#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "coordinator/plane.h"

// Sums and means over the neighbours of each pixel of a plane, and over all the rest of it.
//
// What is said of "without the pixel" and "outside" holds to the last bit: the values left out
// enter no sum that is used, not even to be subtracted again. All sums run in a fixed order.

namespace strata {

/// Sums over square neighbourhoods. The order of additions is the same for every pixel of an image,
/// wherever it lies in its plane.
class Neighbourhoods {
 public:
  static constexpr size_t kReach = 2;  ///< Of the largest neighbourhood, the 5x5 ring.

  explicit Neighbourhoods(PlaneSize size) : size_(size) {}

  /// Over the 8 pixels around the pixel, itself left out. `padded` has a margin of kReach pixels on
  /// each side, which counts as it is: zeros where the image ends.
  std::vector<double> Beside(const std::vector<double>& padded) const;
  /// Over the 5x5 ring, the pixel itself left out. The same `padded`.
  std::vector<double> Ring(const std::vector<double>& padded) const;

 private:
  PlaneSize size_;
};

/// In the place of each value the mean over the pixel's 5x5 ring without the pixel, the ring
/// clipped at the border of the plane. Requires at least 2 pixels in each direction.
Plane RingMeans(PlaneSize size, Plane plane);

/// The same with the greatest of four means over the ring's halves: the 14 pixels above the pixel
/// and in its row, below and in its row, left and in its column, right and in its column. Beside an
/// edge one half at least lies wholly on the pixel's side.
Plane HighestHalfMeans(PlaneSize size, Plane plane);

/// Whether there are pixels outside of the 5x5 around each one.
inline bool HasOutside(PlaneSize size) {
  constexpr size_t kEdge = 2 * Neighbourhoods::kReach + 1;
  return size.width > kEdge || size.height > kEdge;
}

/// How many pixels the 5x5 around a pixel has, clipped at the border of the plane.
size_t PixelsInside(PlaneSize size, size_t x, size_t y);

/// Calls visit(y, means of the row) for each row, from the first to the last: for each pixel the
/// mean over all pixels outside of the 5x5 around it. No cancellation, since nothing is subtracted:
/// whatever lies inside, NaN included, has no influence. Requires more than 5 pixels in one
/// direction at least. Time is linear in the pixels.
void VisitMeansOutside(PlaneSize size, const Plane& plane,
                       const std::function<void(size_t y, const double* means)>& visit);

}  // namespace strata
