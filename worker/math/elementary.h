#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "worker/math/lanes.h"

// Elementary functions whose bits depend on IEEE arithmetic alone, never on a libm version.
//
// The float ones serve the kernel: inline, no tables, almost no branches. The double ones serve
// scene loading, where accuracy matters more than time. Both propagate NaN. Errors are the largest
// seen against long double libm by tests/sampling/elementary_test.cpp; 1 ulp is the spacing of
// floats at the exact result.
//
// Method: reduction of the argument, then a polynomial; those in float are minimax, those in double
// are truncated series (Muller, Elementary Functions, chapters 3 and 11).

namespace strata {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

inline double Fma(double a, double b, double c) { return std::fma(a, b, c); }
/// Rounded twice: the 80-bit format has no such instruction.
inline long double Fma(long double a, long double b, long double c) { return a * b + c; }

template <typename T>
struct SinCosResult {
  T sin, cos;
};

namespace elementary_detail {

/// c[0] + c[1] x + ... by Horner's rule, unrolled by the compiler; for one x or for eight.
template <typename T, typename Coefficient, int N>
T Horner(T x, const Coefficient (&c)[N]) {
  T sum = T{} + c[N - 1];
  for (int i = N - 2; i >= 0; --i) sum = Fma(sum, x, T{} + c[i]);
  return sum;
}

// Coefficients of the float functions, lowest power first.
inline constexpr float kSin2Pi[] = {6.2831855f, -41.34185028f, 81.63905334f, -79.56571198f,
                                    122.551964f};
inline constexpr float kCos2Pi[] = {1.0f, -19.73920822f, 64.93917847f, -85.4295044f, 58.81533051f};
inline constexpr float kSin[] = {1.0f, -0.1666665375f, 8.332119323e-3f, -1.951062586e-4f};
inline constexpr float kCos[] = {1.0f, -0.5f, 4.166664556e-2f, -1.388730947e-3f, 2.443232916e-5f};
inline constexpr float kExpSlope[] = {0.9999999999f,   0.4999999702f,   0.166665405f,
                                      4.166750237e-2f, 8.366866969e-3f, 1.38648018e-3f};
inline constexpr float kAsin[] = {0.1666667312f, 7.498791814e-2f, 4.50130291e-2f, 2.64825039e-2f,
                                  3.82265188e-2f};
inline constexpr float kAtan[] = {-0.3333333135f, 0.1999951154f, -0.14263390f, 0.1073954329f,
                                  -6.441430002e-2f};

/// Turns sine and cosine of the reduced angle by `quadrant` right angles.
template <typename T>
SinCosResult<T> TurnQuadrant(T sin, T cos, int64_t quadrant) {
  const bool swap = quadrant & 1;
  const T s = swap ? cos : sin;
  const T c = swap ? sin : cos;
  return {(quadrant & 2) ? -s : s, ((quadrant + 1) & 2) ? -c : c};
}

}  // namespace elementary_detail

// ---- float, for the kernel ----

/// sin and cos of 2 pi u for |u| <= 1/8, one or eight: absolute error below 1e-7.
template <typename T>
SinCosResult<T> SinCosWithinEighth(T u) {
  const T u2 = u * u;
  return {u * elementary_detail::Horner(u2, elementary_detail::kSin2Pi),
          elementary_detail::Horner(u2, elementary_detail::kCos2Pi)};
}
/// sin and cos of 2 pi u: absolute error below 1e-7. The reduction is exact, so any finite
/// |u| < 2^22 keeps that error.
inline SinCosResult<float> SinCos2Pi(float u) {
  const float quadrant = std::floor(Fma(4, u, 0.5f));
  const SinCosResult<float> reduced = SinCosWithinEighth(Fma(-0.25f, quadrant, u));
  return elementary_detail::TurnQuadrant(reduced.sin, reduced.cos, static_cast<int64_t>(quadrant));
}

/// sin and cos of x in radians: absolute error below 1e-7 for |x| <= 1e6.
inline SinCosResult<float> SinCos(float x) {
  const double quadrant = std::floor(x * (2 * std::numbers::inv_pi) + 0.5);
  const float r = static_cast<float>(x - quadrant * (std::numbers::pi / 2));
  const float r2 = r * r;
  const float sin = r * elementary_detail::Horner(r2, elementary_detail::kSin);
  const float cos = elementary_detail::Horner(r2, elementary_detail::kCos);
  return elementary_detail::TurnQuadrant(sin, cos, static_cast<int64_t>(quadrant));
}
inline float Sin(float x) { return SinCos(x).sin; }
inline float Cos(float x) { return SinCos(x).cos; }
inline float Tan(float x) {
  const SinCosResult<float> sc = SinCos(x);
  return sc.sin / sc.cos;
}

namespace elementary_detail {
/// (e^r - 1) / r for |r| <= ln(2) / 2.
inline float ExpSlope(float r) { return Horner(r, kExpSlope); }
/// log(1 + f) for 1 + f in [sqrt(1/2), sqrt(2)).
inline float LogOnePlus(float f) {
  const float s = f / (2 + f);
  const float s2 = s * s;
  const float series = s2 * Horner(s2, {0.6666668653f, 0.3998854756f, 0.2958699465f});
  // log(1 + f) = 2 atanh(s) = f - s (f - series): f itself is exact.
  return f - s * (f - series);
}
}  // namespace elementary_detail

/// e^x within 2 ulp. Results below the smallest normal float become 0, above the largest infinity.
inline float Exp(float x) {
  const float n = std::floor(x * std::numbers::log2e_v<float> + 0.5f);
  // ln 2 in two parts: the first has few enough bits that its product with n is exact.
  const float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
  const float series = elementary_detail::ExpSlope(r);
  if (!(x > -87.33654f)) return x <= -87.33654f ? 0 : x;  // The latter is NaN.
  if (x > 88.72283f) return std::numeric_limits<float>::infinity();
  // 2^n in two factors, since n = 128 has no float of its own.
  const int32_t half = static_cast<int32_t>(n) >> 1;
  const float scale0 = std::bit_cast<float>((half + 127) << 23);
  const float scale1 = std::bit_cast<float>((static_cast<int32_t>(n) - half + 127) << 23);
  return (1 + r * series) * scale0 * scale1;
}

/// Natural logarithm within 2 ulp; -infinity at 0, NaN below.
inline float Log(float x) {
  if (!(x > 0))
    return x == 0 ? -std::numeric_limits<float>::infinity()
                  : std::numeric_limits<float>::quiet_NaN();
  if (x == std::numeric_limits<float>::infinity()) return x;
  const bool subnormal = x < std::numeric_limits<float>::min();
  const int32_t bits = std::bit_cast<int32_t>(subnormal ? x * 0x1p23f : x);
  // The mantissa in [sqrt(1/2), sqrt(2)), so that results near 0 do not cancel.
  const int32_t exponent = (bits - 0x3f3504f3) >> 23;
  const float mantissa = std::bit_cast<float>(bits - (exponent << 23));
  const float n = static_cast<float>(exponent - (subnormal ? 23 : 0));
  const float log_mantissa = elementary_detail::LogOnePlus(mantissa - 1);
  return n * 0.693359375f + (log_mantissa - n * 2.12194440e-4f);
}

/// e^x - 1 within 3 ulp for |x| < 1/3, within 8 beyond.
inline float Expm1(float x) {
  return std::fabs(x) < 1 / 3.0f ? x * elementary_detail::ExpSlope(x) : Exp(x) - 1;
}

/// log(1 + x) within 4 ulp, also for the smallest x; -infinity at -1, NaN below.
inline float Log1p(float x) {
  return x > -0.29f && x < 0.41f ? elementary_detail::LogOnePlus(x) : Log(1 + x);
}

namespace elementary_detail {
/// asin(x) for |x| <= 1/2.
inline float AsinSmall(float x) {
  const float x2 = x * x;
  return Fma(x * x2, Horner(x2, kAsin), x);
}
}  // namespace elementary_detail

/// Within 3 ulp. Arguments beyond [-1, 1] are taken as the nearer bound.
inline float Asin(float x) {
  const float a = std::fabs(x);
  if (a <= 0.5f) return elementary_detail::AsinSmall(x);
  const float half = elementary_detail::AsinSmall(std::sqrt(0.5f * (a < 1 ? 1 - a : a - a)));
  return std::copysign(kPi / 2 - 2 * half, x);
}
/// Within 3 ulp. Arguments beyond [-1, 1] are taken as the nearer bound.
inline float Acos(float x) {
  const float a = std::fabs(x);
  if (a <= 0.5f) return kPi / 2 - elementary_detail::AsinSmall(x);
  const float twice = 2 * elementary_detail::AsinSmall(std::sqrt(0.5f * (a < 1 ? 1 - a : a - a)));
  return x > 0 ? twice : kPi - twice;
}

/// Angle of (x, y) in [-pi, pi] within 3 ulp; 0 or +-pi at the origin by the signs of zero.
inline float Atan2(float y, float x) {
  const float ax = std::fabs(x), ay = std::fabs(y);
  const float high = ax > ay ? ax : ay;
  const float low = ax > ay ? ay : ax;
  // tan(pi/8) parts the octant: above it atan(t) = pi/4 + atan((t - 1) / (t + 1)).
  const bool upper = low > 0.41421356f * high;
  const float denominator = upper ? low + high : high;
  const float t = denominator > 0 ? (upper ? low - high : low) / denominator : denominator;
  const float t2 = t * t;
  float angle = Fma(t * t2, elementary_detail::Horner(t2, elementary_detail::kAtan), t);
  if (upper) angle += kPi / 4;
  if (ay >= ax && high > 0) angle = kPi / 2 - angle;
  if (std::signbit(x)) angle = kPi - angle;
  return std::copysign(angle, y);
}

// ---- double, for loading ----

inline constexpr double Radians(double degrees) { return degrees * (std::numbers::pi / 180); }
inline constexpr double Degrees(double radians) { return radians * (180 / std::numbers::pi); }

/// Absolute error below 3e-16 for |x| <= 1e6.
inline SinCosResult<double> SinCos(double x) {
  const double quadrant = std::floor(x * (2 * std::numbers::inv_pi) + 0.5);
  // pi/2 in three parts of 33 bits, so that the first two products are exact for |x| <= 1e6.
  const double r = ((x - quadrant * 0x1.921fb544p+0) - quadrant * 0x1.0b4611a6p-34) -
                   quadrant * 0x1.3198a2e037073p-69;
  const double r2 = r * r;
  const double sin =
      r + r * r2 *
              elementary_detail::Horner(
                  r2, {-1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800,
                       1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000});
  const double cos = 1 + r2 * elementary_detail::Horner(
                                  r2, {-1.0 / 2, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800,
                                       1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000});
  return elementary_detail::TurnQuadrant(sin, cos, static_cast<int64_t>(quadrant));
}
inline double Sin(double x) { return SinCos(x).sin; }
inline double Cos(double x) { return SinCos(x).cos; }
inline double Tan(double x) {
  const SinCosResult<double> sc = SinCos(x);
  return sc.sin / sc.cos;
}

namespace elementary_detail {

template <typename T>
T ExpSeries(T r) {
  constexpr T kCoefficients[] = {T(1),
                                 T(1) / 2,
                                 T(1) / 6,
                                 T(1) / 24,
                                 T(1) / 120,
                                 T(1) / 720,
                                 T(1) / 5040,
                                 T(1) / 40320,
                                 T(1) / 362880,
                                 T(1) / 3628800,
                                 T(1) / 39916800,
                                 T(1) / 479001600,
                                 T(1) / 6227020800,
                                 T(1) / 87178291200,
                                 T(1) / 1307674368000};
  return 1 + r * Horner(r, kCoefficients);
}

/// x = mantissa 2^exponent with the mantissa in [sqrt(1/2), sqrt(2)); x positive and finite.
struct BinaryParts {
  double mantissa;
  int64_t exponent;
};
inline BinaryParts SplitBinary(double x) {
  const bool subnormal = x < std::numeric_limits<double>::min();
  const int64_t bits = std::bit_cast<int64_t>(subnormal ? x * 0x1p52 : x);
  const int64_t exponent = (bits - 0x3fe6a09e667f3bcd) >> 52;
  return {std::bit_cast<double>(bits - (exponent << 52)), exponent - (subnormal ? 52 : 0)};
}

/// log of a mantissa in [sqrt(1/2), sqrt(2)).
template <typename T>
T LogSeries(T mantissa) {
  constexpr T kCoefficients[] = {T(2) / 3,  T(2) / 5,  T(2) / 7,  T(2) / 9,  T(2) / 11, T(2) / 13,
                                 T(2) / 15, T(2) / 17, T(2) / 19, T(2) / 21, T(2) / 23, T(2) / 25};
  const T f = mantissa - 1;
  const T s = f / (2 + f);
  const T s2 = s * s;
  return f - s * (f - s2 * Horner(s2, kCoefficients));
}

/// x 2^n, rounded once even when the result is subnormal.
inline double ScaleBinary(double x, int64_t n) {
  const auto power = [](int64_t e) { return std::bit_cast<double>((e + 1023) << 52); };
  if (n < -1000) return x * power(n + 500) * power(-500);
  if (n > 1000) return x * power(n - 500) * power(500);
  return x * power(n);
}

}  // namespace elementary_detail

/// e^x within 2 ulp.
inline double Exp(double x) {
  if (!(x > -746)) return x <= -746 ? 0 : x;  // The latter is NaN.
  if (x > 710) return std::numeric_limits<double>::infinity();
  const double n = std::floor(x * std::numbers::log2e + 0.5);
  const double r = (x - n * 0x1.62e42feep-1) - n * 0x1.a39ef35793c76p-33;
  return elementary_detail::ScaleBinary(elementary_detail::ExpSeries(r), static_cast<int64_t>(n));
}

/// Natural logarithm within 2 ulp; -infinity at 0, NaN below.
inline double Log(double x) {
  if (!(x > 0))
    return x == 0 ? -std::numeric_limits<double>::infinity()
                  : std::numeric_limits<double>::quiet_NaN();
  if (x == std::numeric_limits<double>::infinity()) return x;
  const auto [mantissa, exponent] = elementary_detail::SplitBinary(x);
  const double n = static_cast<double>(exponent);
  return n * 0x1.62e42feep-1 + (elementary_detail::LogSeries(mantissa) + n * 0x1.a39ef35793c76p-33);
}

/// x^y within 1.5 ulp for x >= 0; NaN for negative x. 0^0 = 1. Works in the 80-bit format, whose
/// arithmetic is as exactly rounded as that of double, since y log x needs eleven more bits.
inline double Pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y) || x < 0) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0 || std::isinf(x) || std::isinf(y)) {
    const bool grows = (x > 1) == (y > 0);
    return grows ? std::numeric_limits<double>::infinity() : 0;
  }
  const auto [mantissa, exponent] = elementary_detail::SplitBinary(x);
  const long double logarithm = exponent * std::numbers::ln2_v<long double> +
                                elementary_detail::LogSeries(static_cast<long double>(mantissa));
  const long double power = y * logarithm;
  if (power < -746) return 0;
  if (power > 710) return std::numeric_limits<double>::infinity();
  const double n = std::floor(static_cast<double>(power) * std::numbers::log2e + 0.5);
  const long double r = power - n * std::numbers::ln2_v<long double>;
  return elementary_detail::ScaleBinary(static_cast<double>(elementary_detail::ExpSeries(r)),
                                        static_cast<int64_t>(n));
}

/// Angle of (x, y) in [-pi, pi] within 3 ulp; 0 or +-pi at the origin by the signs of zero.
inline double Atan2(double y, double x) {
  const double ax = std::fabs(x), ay = std::fabs(y);
  const double high = ax > ay ? ax : ay;
  const double low = ax > ay ? ay : ax;
  const double ratio = high > 0 ? low / high : high;
  // atan(t) = atan(c) + atan((t - c) / (1 + t c)) with c the nearest quarter.
  constexpr double kAtanQuarters[] = {0, 0.24497866312686415417, 0.46364760900080611621,
                                      0.64350110879328438680, 0.78539816339744830962};
  const int quarter = ratio >= 0 ? static_cast<int>(ratio * 4 + 0.5) : 0;
  const double c = 0.25 * quarter;
  const double t = quarter == 0 ? ratio : (low - c * high) / (high + c * low);
  const double t2 = t * t;
  double angle =
      t + t * t2 *
              elementary_detail::Horner(t2, {-1.0 / 3, 1.0 / 5, -1.0 / 7, 1.0 / 9, -1.0 / 11,
                                             1.0 / 13, -1.0 / 15, 1.0 / 17, -1.0 / 19});
  angle += kAtanQuarters[quarter];
  if (ay >= ax && high > 0) angle = std::numbers::pi / 2 - angle;
  if (std::signbit(x)) angle = std::numbers::pi - angle;
  return std::copysign(angle, y);
}
/// Within 4 ulp; NaN beyond [-1, 1].
inline double Acos(double x) { return Atan2(std::sqrt((1 - x) * (1 + x)), x); }
/// Within 4 ulp; NaN beyond [-1, 1].
inline double Asin(double x) { return Atan2(x, std::sqrt((1 - x) * (1 + x))); }

/// x^y for x >= 0, as the double version rounded to float.
inline float Pow(float x, float y) {
  return static_cast<float>(Pow(static_cast<double>(x), static_cast<double>(y)));
}

}  // namespace strata
