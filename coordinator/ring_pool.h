#pragma once

#include <cstddef>
#include <functional>
#include <vector>

// Sums and means over the neighbours of each pixel of a plane, and over all the rest of it.
//
// What is said of "without the pixel" and "outside" holds to the last bit: the values left out
// enter no sum that is used, not even to be subtracted again. All sums run in a fixed order.

namespace strata {

/// A row-major plane of width x height pixels.
struct PlaneSize {
  size_t width = 0, height = 0;
  size_t Pixels() const { return width * height; }
};

/// Sums over square neighbourhoods. The order of additions is the same for every pixel of an image,
/// wherever it lies in its plane.
class Neighbourhoods {
 public:
  static constexpr size_t kReach = 2;  ///< Of the largest neighbourhood, the 5x5 ring.

  explicit Neighbourhoods(PlaneSize size) : size_(size) {}

  /// Over the 3x3 block, the pixel included. `padded` has a margin of kReach pixels on each side,
  /// which counts as it is: zeros where the image ends.
  std::vector<double> Block(const std::vector<double>& padded) const;
  /// Over the 5x5 ring, the pixel itself left out. The same `padded`.
  std::vector<double> Ring(const std::vector<double>& padded) const;

 private:
  PlaneSize size_;
};

/// The mean over the 5x5 ring without the pixel, the ring clipped at the border of the plane.
/// Requires at least 2 pixels in each direction.
std::vector<double> RingMeans(PlaneSize size, const std::vector<double>& plane);

/// Whether there are pixels outside of the 5x5 around each one.
inline bool HasOutside(PlaneSize size) {
  constexpr size_t kEdge = 2 * Neighbourhoods::kReach + 1;
  return size.width > kEdge || size.height > kEdge;
}

/// Calls visit(y, means of the row) for each row, from the first to the last: for each pixel the
/// mean over all pixels outside of the 5x5 around it. No cancellation, since nothing is subtracted:
/// whatever lies inside, NaN included, has no influence. Requires more than 5 pixels in one
/// direction at least. Time is linear in the pixels.
void VisitMeansOutside(PlaneSize size, const std::vector<double>& plane,
                       const std::function<void(size_t y, const double* means)>& visit);

}  // namespace strata
