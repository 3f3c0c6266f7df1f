#pragma once

#include <algorithm>
#include <cmath>

namespace strata {

// Named as those of lanes.h, for formulas that are written once for one value and for eight.
inline float Sqrt(float v) { return std::sqrt(v); }
inline float Abs(float v) { return std::fabs(v); }
inline float Min(float a, float b) { return std::min(a, b); }
inline float Max(float a, float b) { return std::max(a, b); }
/// a b + c, rounded once: one instruction, the same bits everywhere.
inline float Fma(float a, float b, float c) { return std::fma(a, b, c); }
inline float CopySign(float magnitude, float sign) { return std::copysign(magnitude, sign); }

struct Vec2f {
  float x = 0, y = 0;
  bool operator==(const Vec2f&) const = default;
};

struct Vec3f {
  float x = 0, y = 0, z = 0;

  friend Vec3f operator+(Vec3f a, Vec3f b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3f operator-(Vec3f a, Vec3f b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3f operator-(Vec3f a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3f operator*(Vec3f a, float s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3f operator*(float s, Vec3f a) { return a * s; }
  friend Vec3f operator/(Vec3f a, float s) { return a * (1 / s); }
  Vec3f& operator+=(Vec3f b) { return *this = *this + b; }
  float operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  bool operator==(const Vec3f&) const = default;
};

inline Vec3f Fma(Vec3f a, float s, Vec3f b) {
  return {Fma(a.x, s, b.x), Fma(a.y, s, b.y), Fma(a.z, s, b.z)};
}
inline float Dot(Vec3f a, Vec3f b) { return Fma(a.x, b.x, Fma(a.y, b.y, a.z * b.z)); }
inline float AbsDot(Vec3f a, Vec3f b) { return std::abs(Dot(a, b)); }
inline Vec3f Cross(Vec3f a, Vec3f b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float LengthSquared(Vec3f a) { return Dot(a, a); }
inline float Length(Vec3f a) { return std::sqrt(Dot(a, a)); }
inline Vec3f Normalize(Vec3f a) { return a / Length(a); }
inline Vec3f Abs(Vec3f a) { return {std::abs(a.x), std::abs(a.y), std::abs(a.z)}; }
inline Vec3f Min(Vec3f a, Vec3f b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3f Max(Vec3f a, Vec3f b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline float MaxComponent(Vec3f a) { return std::max(a.x, std::max(a.y, a.z)); }
inline bool IsFinite(Vec3f a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// The vectors whose coordinates are T.
template <typename T>
struct VectorsOf;
template <>
struct VectorsOf<float> {
  using Vec2 = Vec2f;
  using Vec3 = Vec3f;
};

/// Linear Rec.709 (sRGB primaries, D65 white) colour or radiance.
struct Rgb {
  float r = 0, g = 0, b = 0;

  static Rgb Gray(float v) { return {v, v, v}; }
  friend Rgb operator+(Rgb a, Rgb b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
  friend Rgb operator-(Rgb a, Rgb b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
  friend Rgb operator*(Rgb a, Rgb b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
  friend Rgb operator/(Rgb a, Rgb b) { return {a.r / b.r, a.g / b.g, a.b / b.b}; }
  friend Rgb operator*(Rgb a, float s) { return {a.r * s, a.g * s, a.b * s}; }
  friend Rgb operator*(float s, Rgb a) { return a * s; }
  friend Rgb operator/(Rgb a, float s) { return a * (1 / s); }
  Rgb& operator+=(Rgb b) { return *this = *this + b; }
  Rgb& operator*=(Rgb b) { return *this = *this * b; }
  Rgb& operator*=(float s) { return *this = *this * s; }
  bool operator==(const Rgb&) const = default;
};

/// Relative luminance, Rec.709 (ITU-R BT.709-6).
inline float Luminance(Rgb c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }
inline float MaxComponent(Rgb c) { return std::max(c.r, std::max(c.g, c.b)); }
inline float Average(Rgb c) { return (c.r + c.g + c.b) * (1.0f / 3.0f); }
inline bool IsBlack(Rgb c) { return c.r == 0 && c.g == 0 && c.b == 0; }
inline bool IsFinite(Rgb c) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

/// An orthonormal basis; local z is the normal. All directions handed to a BSDF are local.
struct Frame {
  Vec3f x, y, z;

  Vec3f ToLocal(Vec3f v) const { return {Dot(v, x), Dot(v, y), Dot(v, z)}; }
  Vec3f ToWorld(Vec3f v) const { return Fma(x, v.x, Fma(y, v.y, z * v.z)); }

  /// Any basis around the unit vector `n` (Duff et al. 2017, JCGT 6(1)).
  static Frame FromNormal(Vec3f n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1 / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{Fma(sign * n.x * n.x, a, 1), sign * b, -sign * n.x},
            {b, Fma(n.y * n.y, a, sign), -n.y},
            n};
  }

  /// The basis around unit `n` with x along the part of `tangent` orthogonal to it; falls back to
  /// FromNormal where that vanishes.
  static Frame FromNormalAndTangent(Vec3f n, Vec3f tangent) {
    const Vec3f t = tangent - n * Dot(n, tangent);
    const float length2 = LengthSquared(t);
    if (!(length2 > 1e-12f * LengthSquared(tangent))) return FromNormal(n);
    const Vec3f x = t / std::sqrt(length2);
    return {x, Cross(n, x), n};
  }
};

}  // namespace strata
