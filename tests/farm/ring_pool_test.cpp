// Sums over neighbours and over all others against the long way, and what may not enter them.

#include "coordinator/ring_pool.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace strata {
namespace {

std::vector<double> RandomPlane(PlaneSize size) {
  std::mt19937_64 random(11);
  std::vector<double> plane(size.Pixels());
  for (double& value : plane) value = 1 + static_cast<double>(random() >> 40) * 0x1p-20;
  return plane;
}

std::vector<double> AllMeansOutside(PlaneSize size, const std::vector<double>& plane) {
  std::vector<double> all;
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

class AnySize : public ::testing::TestWithParam<PlaneSize> {};
INSTANTIATE_TEST_SUITE_P(Sizes, AnySize,
                         ::testing::Values(PlaneSize{23, 17}, PlaneSize{6, 1}, PlaneSize{1, 9},
                                           PlaneSize{2, 8}, PlaneSize{6, 5}, PlaneSize{40, 3}));

TEST_P(AnySize, MeansFollowTheirDefinitions) {
  const PlaneSize size = GetParam();
  const std::vector<double> plane = RandomPlane(size);
  const std::vector<double> ring = RingMeans(size, plane), outside = AllMeansOutside(size, plane);
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

TEST_P(AnySize, WhatIsLeftOutHasNoInfluenceOnAnyBit) {
  const PlaneSize size = GetParam();
  const std::vector<double> plane = RandomPlane(size);
  const std::vector<double> ring = RingMeans(size, plane), outside = AllMeansOutside(size, plane);
  for (size_t i = 0; i < size.Pixels(); ++i) {
    std::vector<double> damaged = plane;
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
  const std::vector<double> plane = RandomPlane(size);
  std::vector<double> padded((size.width + 4) * (size.height + 4));
  for (size_t i = 0; i < plane.size(); ++i) {
    padded[(i / size.width + 2) * (size.width + 4) + i % size.width + 2] = plane[i];
  }
  const std::vector<double> sums = Neighbourhoods(size).Ring(padded);
  const std::vector<double> means = RingMeans(size, plane);
  const size_t centre = 6 * size.width + 9, corner = 0;
  EXPECT_EQ(means[centre], sums[centre] / 24);
  EXPECT_EQ(means[corner], sums[corner] / 8);
}

}  // namespace
}  // namespace strata
