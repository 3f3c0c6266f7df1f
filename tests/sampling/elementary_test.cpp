#include "worker/math/elementary.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "worker/math/elementary_lanes.h"

// Against long double libm on dense grids: the stated bounds of elementary.h hold, with a margin of
// the grid's own making only (no randomness).

namespace strata {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename T>
double UlpsOff(T value, long double exact) {
  const T rounded = static_cast<T>(exact);
  if (value == rounded) return 0;
  const T magnitude = std::max(std::fabs(rounded), std::numeric_limits<T>::min());
  const T spacing = std::nextafter(magnitude, std::numeric_limits<T>::infinity()) - magnitude;
  return static_cast<double>(std::fabs(value - exact) / spacing);
}

/// Evenly spaced points of [low, high] and as many spaced by ratio on both sides of 0.
template <typename T>
std::vector<T> Grid(T low, T high, int count = 200000) {
  std::vector<T> points;
  for (int i = 0; i <= count; ++i) points.push_back(low + (high - low) * (T(i) / count));
  for (int i = 0; i < count; ++i) {
    const T x = std::exp2(-T(60) * i / count);
    if (x <= high) points.push_back(x);
    if (-x >= low) points.push_back(-x);
  }
  return points;
}

template <typename T, typename Function, typename Exact>
double WorstUlps(const std::vector<T>& points, Function function, Exact exact) {
  double worst = 0;
  for (const T x : points) {
    worst = std::max(worst, UlpsOff<T>(function(x), exact(static_cast<long double>(x))));
  }
  return worst;
}

template <typename T, typename Function, typename Exact>
double WorstAbsolute(const std::vector<T>& points, Function function, Exact exact) {
  long double worst = 0;
  for (const T x : points) {
    worst = std::max(worst, std::fabs(function(x) - exact(static_cast<long double>(x))));
  }
  return static_cast<double>(worst);
}

TEST(ElementaryFloat, SineAndCosineOfTurns) {
  const long double turn = 2 * std::acos(-1.0L);
  const auto points = Grid<float>(-4, 4);
  EXPECT_LT(WorstAbsolute(
                points, [](float u) { return SinCos2Pi(u).sin; },
                [&](long double u) { return std::sin(turn * u); }),
            1e-7);
  EXPECT_LT(WorstAbsolute(
                points, [](float u) { return SinCos2Pi(u).cos; },
                [&](long double u) { return std::cos(turn * u); }),
            1e-7);
}

TEST(ElementaryFloat, SineCosineTangent) {
  for (const float range : {4.0f, 1000.0f, 1e6f}) {
    const auto points = Grid<float>(-range, range);
    EXPECT_LT(
        WorstAbsolute(
            points, [](float x) { return Sin(x); }, [](long double x) { return std::sin(x); }),
        1e-7);
    EXPECT_LT(
        WorstAbsolute(
            points, [](float x) { return Cos(x); }, [](long double x) { return std::cos(x); }),
        1e-7);
  }
  EXPECT_LE(WorstUlps(
                Grid<float>(-1.55f, 1.55f), [](float x) { return Tan(x); },
                [](long double x) { return std::tan(x); }),
            4);
}

TEST(ElementaryFloat, ExponentialAndLogarithm) {
  EXPECT_LE(WorstUlps(
                Grid<float>(-87.3f, 88.72f), [](float x) { return Exp(x); },
                [](long double x) { return std::exp(x); }),
            2);
  for (const auto& points : {Grid<float>(0.01f, 3), Grid<float>(1e-30f, 1e30f)}) {
    std::vector<float> positive;
    for (const float x : points)
      if (x > 0) positive.push_back(x);
    EXPECT_LE(
        WorstUlps(
            positive, [](float x) { return Log(x); }, [](long double x) { return std::log(x); }),
        2);
  }
  EXPECT_LE(UlpsOff<float>(Log(1e-42f), std::log(static_cast<long double>(1e-42f))), 2);
}

TEST(ElementaryFloat, ExponentialAndLogarithmAroundOne) {
  double near = 0, far = 0, logarithm = 0;
  for (int i = -4000; i <= 4000; ++i) {
    const float x =
        std::copysign(std::exp2(-std::fabs(static_cast<float>(i)) / 40.0f), static_cast<float>(i));
    for (const float scale : {1.0f, 0.77f}) {
      const float at = x * scale * 0.999f;
      const long double exact = std::expm1(static_cast<long double>(at));
      double& worst = std::fabs(at) < 1 / 3.0f ? near : far;
      worst = std::max(worst, static_cast<double>(UlpsOff<float>(Expm1(at), exact)));
      const long double log = std::log1p(static_cast<long double>(at));
      logarithm = std::max(logarithm, static_cast<double>(UlpsOff<float>(Log1p(at), log)));
    }
  }
  EXPECT_LE(near, 3);
  EXPECT_LE(far, 8);
  EXPECT_LE(logarithm, 4);
  EXPECT_EQ(Expm1(0.0f), 0);
  EXPECT_EQ(Expm1(-200.0f), -1);
  EXPECT_EQ(Log1p(0.0f), 0);
  EXPECT_EQ(Log1p(-1.0f), -kInfinity);
  EXPECT_TRUE(std::isnan(Log1p(-1.5f)));
  EXPECT_TRUE(std::isnan(Log1p(std::nanf(""))) && std::isnan(Expm1(std::nanf(""))));
}

TEST(ElementaryFloat, InverseFunctions) {
  const auto points = Grid<float>(-1, 1);
  EXPECT_LE(
      WorstUlps(
          points, [](float x) { return Asin(x); }, [](long double x) { return std::asin(x); }),
      3);
  EXPECT_LE(
      WorstUlps(
          points, [](float x) { return Acos(x); }, [](long double x) { return std::acos(x); }),
      3);
  double worst = 0;
  for (const float y : Grid<float>(-3, 3, 400)) {
    for (const float x : Grid<float>(-3, 3, 400)) {
      worst = std::max(worst, UlpsOff<float>(Atan2(y, x), std::atan2(static_cast<long double>(y),
                                                                     static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, 3);
}

TEST(ElementaryFloat, Edges) {
  EXPECT_EQ(Exp(-200.0f), 0);
  EXPECT_EQ(Exp(200.0f), kInfinity);
  EXPECT_EQ(Exp(0.0f), 1);
  EXPECT_TRUE(std::isnan(Exp(std::nanf(""))));
  EXPECT_EQ(Log(0.0f), -kInfinity);
  EXPECT_EQ(Log(1.0f), 0);
  EXPECT_TRUE(std::isnan(Log(-1.0f)));
  EXPECT_TRUE(std::isnan(Log(std::nanf(""))));
  EXPECT_EQ(Log(std::numeric_limits<float>::infinity()), kInfinity);
  EXPECT_EQ(SinCos2Pi(0.25f).cos, 0);
  EXPECT_EQ(SinCos2Pi(0.5f).sin, 0);
  EXPECT_EQ(SinCos2Pi(1.0f).cos, 1);
  EXPECT_EQ(Acos(1.0f), 0);
  EXPECT_EQ(Acos(1.5f), 0);
  EXPECT_FLOAT_EQ(Acos(-1.5f), kPi);
  EXPECT_TRUE(std::isnan(Acos(std::nanf(""))));
  EXPECT_EQ(Atan2(0.0f, 1.0f), 0);
  EXPECT_EQ(Atan2(0.0f, 0.0f), 0);
  EXPECT_FLOAT_EQ(Atan2(0.0f, -1.0f), kPi);
  EXPECT_FLOAT_EQ(Atan2(-0.0f, -1.0f), -kPi);
  EXPECT_TRUE(std::isnan(Atan2(std::nanf(""), 1.0f)));
  EXPECT_TRUE(std::isnan(Atan2(1.0f, std::nanf(""))));
  EXPECT_FLOAT_EQ(Pow(2.0f, 10.0f), 1024);
}

TEST(ElementaryLanes, HaveTheBitsOfEach) {
  std::vector<float> points = Grid(-4.0f, 4.0f);
  for (const float x : Grid(-200.0f, 200.0f)) points.push_back(x);
  for (const float x : {0.0f, -0.0f, 1.5f, -1.5f, 1e-40f, static_cast<float>(kInfinity)})
    points.push_back(x);
  do points.push_back(std::numeric_limits<float>::quiet_NaN());
  while (points.size() % kLanes != 0);
  const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
  for (size_t i = 0; i + kLanes <= points.size(); i += kLanes) {
    FloatLanes x;
    for (int lane = 0; lane < kLanes; ++lane) x[lane] = points[i + lane];
    // Angles of points on all sides, on the axes and the diagonals among them.
    const FloatLanes y = Permute(x, IntLanes{3, 1, 7, 5, 4, 0, 6, 2});
    const FloatLanes exp = Exp(x), angle = Atan2(y, x);
    const SinCosResult<FloatLanes> radians = SinCos(x), turns = SinCos2Pi(x);
    for (int lane = 0; lane < kLanes; ++lane) {
      const float p = points[i + lane];
      if (std::isnan(p)) {
        EXPECT_TRUE(std::isnan(exp[lane]));
        continue;
      }
      EXPECT_EQ(bits(exp[lane]), bits(Exp(p))) << p;
      if (!std::isnan(y[lane])) EXPECT_EQ(bits(angle[lane]), bits(Atan2(y[lane], p))) << p;
      if (std::isinf(p)) continue;
      EXPECT_EQ(bits(radians.sin[lane]), bits(SinCos(p).sin)) << p;
      EXPECT_EQ(bits(radians.cos[lane]), bits(SinCos(p).cos)) << p;
      EXPECT_EQ(bits(turns.sin[lane]), bits(SinCos2Pi(p).sin)) << p;
      EXPECT_EQ(bits(turns.cos[lane]), bits(SinCos2Pi(p).cos)) << p;
    }
  }
}

TEST(ElementaryDouble, SineCosineTangent) {
  for (const double range : {4.0, 1000.0, 1e6}) {
    const auto points = Grid<double>(-range, range);
    EXPECT_LT(
        WorstAbsolute(
            points, [](double x) { return Sin(x); }, [](long double x) { return std::sin(x); }),
        3e-16);
    EXPECT_LT(
        WorstAbsolute(
            points, [](double x) { return Cos(x); }, [](long double x) { return std::cos(x); }),
        3e-16);
  }
  EXPECT_LE(WorstUlps(
                Grid<double>(-1.55, 1.55), [](double x) { return Tan(x); },
                [](long double x) { return std::tan(x); }),
            4);
  EXPECT_NEAR(Sin(Radians(30)), 0.5, 1e-16);
}

TEST(ElementaryDouble, ExponentialAndLogarithm) {
  EXPECT_LE(WorstUlps(
                Grid<double>(-708, 709.7), [](double x) { return Exp(x); },
                [](long double x) { return std::exp(x); }),
            2);
  for (const auto& points : {Grid<double>(0.01, 3), Grid<double>(1e-300, 1e300)}) {
    std::vector<double> positive;
    for (const double x : points)
      if (x > 0) positive.push_back(x);
    EXPECT_LE(
        WorstUlps(
            positive, [](double x) { return Log(x); }, [](long double x) { return std::log(x); }),
        2);
  }
  EXPECT_EQ(Exp(-800.0), 0);
  EXPECT_EQ(Exp(800.0), kInfinity);
  EXPECT_GT(Exp(-740.0), 0);
  EXPECT_EQ(Log(0.0), -kInfinity);
  EXPECT_TRUE(std::isnan(Log(-1.0)));
}

TEST(ElementaryDouble, Power) {
  for (const double y : {-7.5, -1.0, -1 / 2.2, 1e-3, 0.5, 1 / 2.4, 1.0, 2.0, 2.4, 5.0, 40.0}) {
    std::vector<double> positive;
    for (const double x : Grid<double>(0, 100, 20000))
      if (x > 0) positive.push_back(x);
    EXPECT_LE(WorstUlps(
                  positive, [&](double x) { return Pow(x, y); },
                  [&](long double x) { return std::pow(x, static_cast<long double>(y)); }),
              1.5)
        << y;
  }
  EXPECT_EQ(Pow(0.0, 0.0), 1);
  EXPECT_EQ(Pow(0.0, 2.0), 0);
  EXPECT_EQ(Pow(0.0, -2.0), kInfinity);
  EXPECT_EQ(Pow(2.0, 5000.0), kInfinity);
  EXPECT_EQ(Pow(2.0, -5000.0), 0);
  EXPECT_EQ(Pow(0.5, kInfinity), 0);
  EXPECT_TRUE(std::isnan(Pow(-2.0, 2.0)));
}

TEST(ElementaryDouble, InverseFunctions) {
  const auto points = Grid<double>(-1, 1);
  EXPECT_LE(
      WorstUlps(
          points, [](double x) { return Asin(x); }, [](long double x) { return std::asin(x); }),
      4);
  EXPECT_LE(
      WorstUlps(
          points, [](double x) { return Acos(x); }, [](long double x) { return std::acos(x); }),
      4);
  double worst = 0;
  for (const double y : Grid<double>(-3, 3, 400)) {
    for (const double x : Grid<double>(-3, 3, 400)) {
      worst =
          std::max(worst, UlpsOff<double>(Atan2(y, x), std::atan2(static_cast<long double>(y),
                                                                  static_cast<long double>(x))));
    }
  }
  EXPECT_LE(worst, 3);
}

// The ulp measure itself must see an error of the size the bounds exclude.
TEST(ElementaryControl, ATruncatedSeriesIsCaught) {
  EXPECT_GT(WorstUlps(
                Grid<float>(-1, 1), [](float x) { return x - x * x * x / 6; },
                [](long double x) { return std::sin(x); }),
            100);
}

}  // namespace
}  // namespace strata
