#include "coordinator/ring_pool.h"

#include <algorithm>
#include <array>

namespace strata {
namespace {

constexpr size_t kReach = Neighbourhoods::kReach;
constexpr size_t kRingEdge = 2 * kReach + 1;

/// The rows of a plane that has its margin.
class PaddedRows {
 public:
  PaddedRows(PlaneSize size, const std::vector<double>& padded)
      : stride_(size.width + 2 * kReach), plane_(padded.data()) {}
  /// Row 0 is the margin's first.
  const double* Row(size_t row) { return plane_ + row * stride_; }

 private:
  size_t stride_;
  const double* plane_;
};

/// The same for a plane without one, by copies of the rows that are in use: a row lives until
/// kRingEdge further ones were asked for. Rows are asked for in order, or again. A row of the plane
/// may be overwritten once the one kReach further was asked for.
class CopiedRows {
 public:
  CopiedRows(PlaneSize size, const Plane& plane)
      : size_(size), plane_(plane.data()), copies_(kRingEdge * Stride()) {}

  const double* Row(size_t row) {
    double* copy = &copies_[row % kRingEdge * Stride()];
    if (row < copied_) return copy;
    copied_ = row + 1;
    double* const inside = copy + kReach;
    if (row < kReach || row >= kReach + size_.height) {
      std::fill_n(inside, size_.width, 0.0);
    } else {
      std::copy_n(plane_ + (row - kReach) * size_.width, size_.width, inside);
    }
    return copy;
  }

 private:
  size_t Stride() const { return size_.width + 2 * kReach; }

  PlaneSize size_;
  const double* plane_;
  std::vector<double> copies_;
  size_t copied_ = 0;
};

template <size_t kRadius, bool kWithCentre>
void AddRow(const double* row, size_t width, double* sums) {
  for (size_t x = 0; x < width; ++x) {
    double sum = 0;
    for (size_t k = kReach - kRadius; k <= kReach + kRadius; ++k) {
      if (kWithCentre || k != kReach) sum += row[x + k];
    }
    sums[x] += sum;
  }
}

/// Sums of rows first, then of columns of these sums; the pixel's own row comes last, so that
/// leaving the pixel out needs no subtraction.
template <size_t kRadius, typename Rows>
void Sum(PlaneSize size, Rows rows, double* sums) {
  constexpr size_t kEdge = 2 * kRadius + 1;
  const size_t width = size.width;
  std::vector<double> row_sums(kEdge * width);
  for (size_t j = 0; j < size.height + 2 * kRadius; ++j) {
    double* row_sum = &row_sums[j % kEdge * width];
    std::fill_n(row_sum, width, 0.0);
    AddRow<kRadius, true>(rows.Row(j + kReach - kRadius), width, row_sum);
    if (j < 2 * kRadius) continue;
    const size_t y = j - 2 * kRadius;
    double* sum = sums + y * width;
    std::fill_n(sum, width, 0.0);
    for (size_t k = 0; k < kEdge; ++k) {
      if (k == kRadius) continue;
      const double* other = &row_sums[(y + k) % kEdge * width];
      for (size_t x = 0; x < width; ++x) sum[x] += other[x];
    }
    AddRow<kRadius, false>(rows.Row(y + kReach), width, sum);
  }
}

template <size_t kRadius>
std::vector<double> Sums(PlaneSize size, const std::vector<double>& padded) {
  std::vector<double> sums(size.Pixels());
  Sum<kRadius>(size, PaddedRows(size, padded), sums.data());
  return sums;
}

/// How many places of a line of `length` are within reach of the i-th.
size_t PlacesWithinReach(size_t length, size_t i) {
  return std::min(i + kReach + 1, length) - (i - std::min(i, kReach));
}

/// The same of each.
std::vector<double> WithinReach(size_t length) {
  std::vector<double> counts(length);
  for (size_t i = 0; i < length; ++i) counts[i] = static_cast<double>(PlacesWithinReach(length, i));
  return counts;
}

/// Sum of a row, in eight lanes: fixed order, no waiting for one addition after the other.
double RowSum(const double* row, size_t width) {
  std::array<double, 8> lanes = {};
  size_t x = 0;
  for (; x + lanes.size() <= width; x += lanes.size()) {
    for (size_t k = 0; k < lanes.size(); ++k) lanes[k] += row[x + k];
  }
  for (size_t k = 0; x < width; ++x, ++k) lanes[k] += row[x];
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

}  // namespace

std::vector<double> Neighbourhoods::Beside(const std::vector<double>& padded) const {
  return Sums<1>(size_, padded);
}

std::vector<double> Neighbourhoods::Ring(const std::vector<double>& padded) const {
  return Sums<kReach>(size_, padded);
}

Plane RingMeans(PlaneSize size, Plane plane) {
  const std::vector<double> rows = WithinReach(size.height), columns = WithinReach(size.width);
  Sum<kReach>(size, CopiedRows(size, plane), plane.data());
  for (size_t y = 0; y < size.height; ++y) {
    double* mean = &plane[y * size.width];
    for (size_t x = 0; x < size.width; ++x) mean[x] /= rows[y] * columns[x] - 1;
  }
  return plane;
}

Plane HighestHalfMeans(PlaneSize size, Plane plane) {
  const size_t width = size.width;
  const std::vector<double> rows_inside = WithinReach(size.height),
                            columns_inside = WithinReach(width);
  // A half has so many lines, the pixel's own included, when `before` others come before it.
  const auto lines = [](size_t before) {
    return static_cast<double>(std::min(before, kReach) + 1);
  };
  std::vector<double> lines_left(width);
  for (size_t x = 0; x < width; ++x) lines_left[x] = lines(x);
  CopiedRows rows(size, plane);
  std::vector<double> above(width), below(width), own(width), column(width);
  std::vector<double> columns(width + 2 * kReach);
  for (size_t y = 0; y < size.height; ++y) {
    const double* row[kRingEdge];
    for (size_t k = 0; k < kRingEdge; ++k) row[k] = rows.Row(y + k);
    for (std::vector<double>* sums : {&above, &below, &own})
      std::fill(sums->begin(), sums->end(), 0.0);
    AddRow<kReach, true>(row[0], width, above.data());
    AddRow<kReach, true>(row[1], width, above.data());
    AddRow<kReach, true>(row[3], width, below.data());
    AddRow<kReach, true>(row[4], width, below.data());
    AddRow<kReach, false>(row[kReach], width, own.data());
    for (size_t x = 0; x < columns.size(); ++x) {
      columns[x] = row[0][x] + row[1][x] + row[2][x] + row[3][x] + row[4][x];
    }
    for (size_t x = 0; x < width; ++x) {
      const size_t k = x + kReach;
      column[x] = row[0][k] + row[1][k] + row[3][k] + row[4][k];
    }
    const double lines_above = lines(y), lines_below = lines(size.height - 1 - y);
    double* out = &plane[y * width];
    for (size_t x = 0; x < width; ++x) {
      const double left = columns[x] + columns[x + 1], right = columns[x + 3] + columns[x + 4];
      const double of_rows = std::max((above[x] + own[x]) / (lines_above * columns_inside[x] - 1),
                                      (below[x] + own[x]) / (lines_below * columns_inside[x] - 1));
      const double of_columns =
          std::max((left + column[x]) / (lines_left[x] * rows_inside[y] - 1),
                   (right + column[x]) / (lines_left[width - 1 - x] * rows_inside[y] - 1));
      out[x] = std::max(of_rows, of_columns);
    }
  }
  return plane;
}

size_t PixelsInside(PlaneSize size, size_t x, size_t y) {
  return PlacesWithinReach(size.width, x) * PlacesWithinReach(size.height, y);
}

void VisitMeansOutside(PlaneSize size, const Plane& plane,
                       const std::function<void(size_t y, const double* means)>& visit) {
  const size_t width = size.width, height = size.height;
  // above[y]: rows before y; below[y]: rows from y on.
  std::vector<double> above(height + 1), below(height + 1);
  for (size_t y = 0; y < height; ++y) above[y + 1] = RowSum(&plane[y * width], width);
  for (size_t y = height; y-- > 0;) below[y] = above[y + 1] + below[y + 1];
  for (size_t y = 0; y < height; ++y) above[y + 1] += above[y];

  const double pixels = static_cast<double>(size.Pixels());
  const std::vector<double> rows_inside = WithinReach(height), columns_inside = WithinReach(width);
  // Of the rows within reach: each column; left[x]: columns before x - kReach; right[x]: from
  // x + kReach + 1 on. Zero where there are none.
  std::vector<double> columns(width), left(width + kReach + 1), right(width + kReach + 1);
  std::vector<double> means(width);
  for (size_t y = 0; y < height; ++y) {
    const size_t begin = y - std::min(y, kReach), end = std::min(y + kReach + 1, height);
    std::fill(columns.begin(), columns.end(), 0.0);
    for (size_t j = begin; j < end; ++j) {
      const double* row = &plane[j * width];
      for (size_t x = 0; x < width; ++x) columns[x] += row[x];
    }
    double from_left = 0, from_right = 0;
    for (size_t x = 0, back = width - 1; x < width; ++x, --back) {
      left[x + kReach + 1] = from_left += columns[x];
      if (back > kReach) right[back - kReach - 1] = from_right += columns[back];
    }
    const double other_rows = above[begin] + below[end];
    for (size_t x = 0; x < width; ++x) {
      means[x] = (other_rows + left[x] + right[x]) / (pixels - rows_inside[y] * columns_inside[x]);
    }
    visit(y, means.data());
  }
}

}  // namespace strata
