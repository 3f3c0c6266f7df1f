// Sums over neighbours and over all others against the long way, and what may not enter them.

#include "coordinator/ring_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace strata {
namespace {

Plane RandomPlane(PlaneSize size) {
  std::mt19937_64 random(11);
  Plane plane(size.Pixels());
  for (double& value : plane) value = 1 + static_cast<double>(random() >> 40) * 0x1p-20;
  return plane;
}

Plane AllMeansOutside(PlaneSize size, const Plane& plane) {
  Plane all;
  VisitMeansOutside(size, plane, [&](size_t y, const double* means) {
    EXPECT_EQ(all.size(), y * size.width);
    all.insert(all.end(), means, means + size.width);
  });
  return all;
}

bool Inside(PlaneSize size, size_t i, size_t j) {
  const auto distance = [](size_t a, size_t b) { return a > b ? a - b : b - a; };
  return distance(i % size.width, j % size.width) <= 2 &&
         distance(i / size.width, j / size.width) <= 2;
}

/// The mean over the ring's pixels for which `belongs(dx, dy)`.
template <typename Belongs>
double MeanWhere(PlaneSize size, const Plane& plane, size_t i, Belongs belongs) {
  double sum = 0, count = 0;
  for (size_t j = 0; j < size.Pixels(); ++j) {
    const auto offset = [](size_t a, size_t b) {
      return static_cast<int>(b) - static_cast<int>(a);
    };
    const int dx = offset(i % size.width, j % size.width);
    const int dy = offset(i / size.width, j / size.width);
    if (j == i || !Inside(size, i, j) || !belongs(dx, dy)) continue;
    sum += plane[j];
    ++count;
  }
  return sum / count;
}

class AnySize : public ::testing::TestWithParam<PlaneSize> {};
INSTANTIATE_TEST_SUITE_P(Sizes, AnySize,
                         ::testing::Values(PlaneSize{23, 17}, PlaneSize{6, 1}, PlaneSize{1, 9},
                                           PlaneSize{2, 8}, PlaneSize{6, 5}, PlaneSize{40, 3}));

TEST_P(AnySize, MeansFollowTheirDefinitions) {
  const PlaneSize size = GetParam();
  const Plane plane = RandomPlane(size);
  const Plane ring = RingMeans(size, plane), outside = AllMeansOutside(size, plane);
  for (size_t i = 0; i < size.Pixels(); ++i) {
    double near = 0, far = 0;
    int near_count = 0, far_count = 0;
    for (size_t j = 0; j < size.Pixels(); ++j) {
      if (j == i) continue;
      const bool inside = Inside(size, i, j);
      (inside ? near : far) += plane[j];
      ++(inside ? near_count : far_count);
    }
    EXPECT_NEAR(ring[i], near / near_count, 1e-12 * ring[i]);
    EXPECT_NEAR(outside[i], far / far_count, 1e-12 * outside[i]);
  }
}

TEST(RingPoolTest, TheHighestHalfIsOneOfFour) {
  for (const PlaneSize size : {PlaneSize{23, 17}, PlaneSize{2, 8}, PlaneSize{40, 3}}) {
    const Plane plane = RandomPlane(size), highest = HighestHalfMeans(size, plane);
    for (size_t i = 0; i < size.Pixels(); ++i) {
      const double expected =
          std::max({MeanWhere(size, plane, i, [](int, int dy) { return dy <= 0; }),
                    MeanWhere(size, plane, i, [](int, int dy) { return dy >= 0; }),
                    MeanWhere(size, plane, i, [](int dx, int) { return dx <= 0; }),
                    MeanWhere(size, plane, i, [](int dx, int) { return dx >= 0; })});
      EXPECT_NEAR(highest[i], expected, 1e-12 * expected);
      Plane damaged = plane;
      damaged[i] = std::numeric_limits<double>::quiet_NaN();
      EXPECT_EQ(HighestHalfMeans(size, damaged)[i], highest[i]) << "the pixel has no part in it";
    }
  }
}

TEST_P(AnySize, WhatIsLeftOutHasNoInfluenceOnAnyBit) {
  const PlaneSize size = GetParam();
  const Plane plane = RandomPlane(size);
  const Plane ring = RingMeans(size, plane), outside = AllMeansOutside(size, plane);
  for (size_t i = 0; i < size.Pixels(); ++i) {
    Plane damaged = plane;
    damaged[i] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(RingMeans(size, damaged)[i], ring[i]);
    for (size_t j = 0; j < size.Pixels(); ++j) {
      if (Inside(size, i, j)) damaged[j] = 1e300;
    }
    EXPECT_EQ(AllMeansOutside(size, damaged)[i], outside[i]);
  }
}

TEST(RingPoolTest, APlaneWithItsMarginGivesTheSameSums) {
  const PlaneSize size{19, 12};
  const Plane plane = RandomPlane(size);
  std::vector<double> padded((size.width + 4) * (size.height + 4));
  for (size_t i = 0; i < plane.size(); ++i) {
    padded[(i / size.width + 2) * (size.width + 4) + i % size.width + 2] = plane[i];
  }
  const std::vector<double> sums = Neighbourhoods(size).Ring(padded);
  const Plane means = RingMeans(size, plane);
  const size_t centre = 6 * size.width + 9, corner = 0;
  EXPECT_EQ(means[centre], sums[centre] / 24);
  EXPECT_EQ(means[corner], sums[corner] / 8);
}

}  // namespace
}  // namespace strata
