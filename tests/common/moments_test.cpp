// Moments against long double, and merging against adding.

#include "common/moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "common/unit.h"

namespace strata {
namespace {

std::vector<double> Skewed(size_t count, double offset) {
  std::mt19937_64 random(5);
  std::exponential_distribution<double> draw(2);
  std::vector<double> values(count);
  for (double& value : values) value = offset + draw(random);
  return values;
}

void ExpectNearExact(const Moments& moments, const std::vector<double>& values, double tolerance) {
  long double mean = 0, m2 = 0, m3 = 0;
  for (const double x : values) mean += x;
  mean /= static_cast<long double>(values.size());
  for (const double x : values) {
    const long double d = x - mean;
    m2 += d * d;
    m3 += d * d * d;
  }
  EXPECT_EQ(moments.count, values.size());
  EXPECT_NEAR(moments.mean, static_cast<double>(mean), 1e-14 * std::fabs(moments.mean));
  EXPECT_NEAR(moments.m2, static_cast<double>(m2), tolerance * static_cast<double>(m2));
  EXPECT_NEAR(moments.m3, static_cast<double>(m3), 100 * tolerance * std::fabs(moments.m3));
}

TEST(MomentsTest, AddFollowsTheDefinition) {
  for (const double offset : {0.0, 10.0, 500.0}) {
    const std::vector<double> values = Skewed(10000, offset);
    Moments moments;
    for (const double x : values) moments.Add(x);
    ExpectNearExact(moments, values, 1e-12);
  }
}

TEST(MomentsTest, MergeIsAddingAllOfTheOther) {
  const std::vector<double> values = Skewed(10000, 3);
  Moments merged;
  for (size_t begin = 0, length = 1; begin < values.size(); begin += length, length *= 3) {
    Moments block;
    for (size_t i = begin; i < std::min(begin + length, values.size()); ++i) block.Add(values[i]);
    merged.Merge(block);
  }
  ExpectNearExact(merged, values, 1e-12);
}

TEST(MomentsTest, MergingNothingChangesNoBit) {
  Moments moments;
  for (const double x : Skewed(10, 0)) moments.Add(x);
  Moments same = moments;
  same.Merge({});
  Moments from_nothing;
  from_nothing.Merge(moments);
  for (const Moments& other : {same, from_nothing}) {
    EXPECT_EQ(other.mean, moments.mean);
    EXPECT_EQ(other.m3, moments.m3);
  }
}

TEST(CutPiecesTest, GivesElementaryBlocksThatCoverTheRange) {
  for (uint32_t begin = 0; begin < 150; begin += 7) {
    for (uint32_t end = begin; end < begin + 300; end += 11) {
      uint32_t next = begin;
      for (const SampleRange& piece : CutPieces({begin, end})) {
        EXPECT_EQ(piece.begin, next);
        const uint32_t length = piece.Count();
        EXPECT_EQ(length & (length - 1), 0u) << "a power of two";
        EXPECT_EQ(piece.begin % length, 0u) << "aligned to its length";
        EXPECT_LE(length, LongestPiece({begin, end}));
        next = piece.end;
      }
      EXPECT_EQ(next, end);
    }
  }
}

TEST(CutPiecesTest, GivesFewPiecesForLongRanges) {
  EXPECT_EQ(CutPieces({0, 1 << 13}).size(), 256u);
  const std::vector<SampleRange> pieces = CutPieces({1000, 1u << 27});
  EXPECT_LT(pieces.size(), 600u);
  EXPECT_EQ(pieces.front().begin, 1000u);
  EXPECT_EQ(pieces.back().end, 1u << 27);
}

}  // namespace
}  // namespace strata
