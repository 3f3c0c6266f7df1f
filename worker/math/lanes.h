#pragma once

#include <immintrin.h>

#include <cstdint>

#include "worker/math/vec.h"

// Eight values side by side, one in each lane of a vector. Formulas are those of the scalar code in
// the same order, so that they round alike. Comparisons give masks, whose lanes are all ones (-1)
// or zeros; `mask ? a : b` chooses by them. Lanes outside the mask of a function hold anything.

namespace strata {

inline constexpr int kLanes = 8;
using FloatLanes __attribute__((vector_size(32))) = float;
using IntLanes __attribute__((vector_size(32))) = int32_t;
using MaskLanes = IntLanes;
using Floats4 __attribute__((vector_size(16))) = float;
using Doubles4 __attribute__((vector_size(32))) = double;

inline FloatLanes SameFloat(float v) { return FloatLanes{v, v, v, v, v, v, v, v}; }
inline IntLanes SameInt(int32_t v) { return IntLanes{v, v, v, v, v, v, v, v}; }

/// One bit for each lane that is set.
inline unsigned Bits(MaskLanes m) {
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(m)));
}
inline bool Any(MaskLanes m) { return Bits(m) != 0; }

/// Calls f(lane) for each lane that is set, in their order.
template <typename F>
void ForEachLane(MaskLanes mask, F f) {
  for (unsigned bits = Bits(mask); bits != 0; bits &= bits - 1) f(__builtin_ctz(bits));
}

/// The first lanes.
inline MaskLanes FirstLanes(int count) { return IntLanes{0, 1, 2, 3, 4, 5, 6, 7} < count; }
/// The lanes that are set, in their order, a byte for each, the first the lowest; 0 after the last.
inline uint64_t PackedLanes(MaskLanes mask) {
  const uint64_t bytes = _pdep_u64(Bits(mask), 0x0101010101010101) * 0xff;
  return _pext_u64(0x0706050403020100, bytes);
}
/// A lane for each byte.
inline IntLanes LanesOfBytes(uint64_t bytes) {
  return reinterpret_cast<IntLanes>(
      _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<int64_t>(bytes))));
}
/// In each lane what `v` has in lane `from`.
inline FloatLanes Permute(FloatLanes v, IntLanes from) {
  return _mm256_permutevar8x32_ps(v, reinterpret_cast<__m256i>(from));
}
inline IntLanes Permute(IntLanes v, IntLanes from) {
  return reinterpret_cast<IntLanes>(
      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(v), reinterpret_cast<__m256i>(from)));
}

inline FloatLanes Sqrt(FloatLanes v) { return _mm256_sqrt_ps(v); }
inline FloatLanes Fma(FloatLanes a, FloatLanes b, FloatLanes c) { return _mm256_fmadd_ps(a, b, c); }
inline Floats4 Fma(Floats4 a, Floats4 b, Floats4 c) { return _mm_fmadd_ps(a, b, c); }
inline FloatLanes Floor(FloatLanes v) { return _mm256_floor_ps(v); }
// As std::max and std::min: the first where one is NaN.
inline FloatLanes Max(FloatLanes a, FloatLanes b) { return _mm256_max_ps(b, a); }
inline FloatLanes Min(FloatLanes a, FloatLanes b) { return _mm256_min_ps(b, a); }
inline FloatLanes Abs(FloatLanes v) {
  return reinterpret_cast<FloatLanes>(reinterpret_cast<IntLanes>(v) & 0x7fffffff);
}
inline FloatLanes CopySign(FloatLanes magnitude, FloatLanes sign) {
  const IntLanes sign_bit = reinterpret_cast<IntLanes>(sign) & static_cast<int32_t>(0x80000000);
  return reinterpret_cast<FloatLanes>(reinterpret_cast<IntLanes>(Abs(magnitude)) | sign_bit);
}
inline IntLanes ToInt(FloatLanes v) { return reinterpret_cast<IntLanes>(_mm256_cvttps_epi32(v)); }
inline FloatLanes ToFloat(IntLanes v) { return __builtin_convertvector(v, FloatLanes); }

/// Eight doubles: those of the first four lanes, and of the others.
struct DoubleLanes {
  Doubles4 half[2] = {};

  double Get(int lane) const { return half[lane / 4][lane % 4]; }
  void Set(int lane, double v) { half[lane / 4][lane % 4] = v; }
};
inline Floats4 HalfOf(FloatLanes v, int half) {
  return half == 0 ? _mm256_castps256_ps128(v) : _mm256_extractf128_ps(v, 1);
}
inline FloatLanes ToFloatLanes(const DoubleLanes& v) {
  return _mm256_set_m128(_mm256_cvtpd_ps(v.half[1]), _mm256_cvtpd_ps(v.half[0]));
}
inline DoubleLanes ToDoubleLanes(FloatLanes v) {
  return {{__builtin_convertvector(HalfOf(v, 0), Doubles4),
           __builtin_convertvector(HalfOf(v, 1), Doubles4)}};
}

inline IntLanes AsInts(FloatLanes v) { return reinterpret_cast<IntLanes>(v); }
inline FloatLanes AsFloats(IntLanes v) { return reinterpret_cast<FloatLanes>(v); }

/// Four floats of each lane's own.
struct RowLanes {
  FloatLanes v[4];
};
/// Indices of each lane's own, in memory, where loads and stores take them one by one.
struct alignas(32) LanePlaces {
  int32_t at[kLanes];
};
/// base[at] to base[at + 3] of each lane. Eight loads and a transposition: many processors gather
/// element by element, which four gathers would do four times.
inline RowLanes LoadRows(const float* base, const LanePlaces& places) {
  const auto pair = [&](int lane) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(base + places.at[lane])),
                                _mm_loadu_ps(base + places.at[lane + 4]), 1);
  };
  const __m256 a = pair(0), b = pair(1), c = pair(2), d = pair(3);
  const __m256 ab_low = _mm256_unpacklo_ps(a, b), ab_high = _mm256_unpackhi_ps(a, b);
  const __m256 cd_low = _mm256_unpacklo_ps(c, d), cd_high = _mm256_unpackhi_ps(c, d);
  return {{_mm256_shuffle_ps(ab_low, cd_low, 0x44), _mm256_shuffle_ps(ab_low, cd_low, 0xee),
           _mm256_shuffle_ps(ab_high, cd_high, 0x44), _mm256_shuffle_ps(ab_high, cd_high, 0xee)}};
}
/// The way back.
inline void StoreRows(float* base, const LanePlaces& places, const RowLanes& rows) {
  const __m256 xy_low = _mm256_unpacklo_ps(rows.v[0], rows.v[1]),
               xy_high = _mm256_unpackhi_ps(rows.v[0], rows.v[1]);
  const __m256 zw_low = _mm256_unpacklo_ps(rows.v[2], rows.v[3]),
               zw_high = _mm256_unpackhi_ps(rows.v[2], rows.v[3]);
  const auto store = [&](int lane, __m256 pair) {
    _mm_storeu_ps(base + places.at[lane], _mm256_castps256_ps128(pair));
    _mm_storeu_ps(base + places.at[lane + 4], _mm256_extractf128_ps(pair, 1));
  };
  store(0, _mm256_shuffle_ps(xy_low, zw_low, 0x44));
  store(1, _mm256_shuffle_ps(xy_low, zw_low, 0xee));
  store(2, _mm256_shuffle_ps(xy_high, zw_high, 0x44));
  store(3, _mm256_shuffle_ps(xy_high, zw_high, 0xee));
}
inline LanePlaces PlacesOf(IntLanes index) {
  LanePlaces places;
  _mm256_store_si256(reinterpret_cast<__m256i*>(places.at), reinterpret_cast<__m256i>(index));
  // From memory: left to itself gcc 12 takes the vector apart in registers, which is slower.
  asm("" : "+m"(places.at));
  return places;
}
/// LoadRows at `index` for each lane in `mask`; the others read from `base` itself.
inline RowLanes GatherRows(const float* base, IntLanes index, MaskLanes mask) {
  return LoadRows(base, PlacesOf(index & mask));
}

struct Vec2Lanes {
  FloatLanes x = {}, y = {};
};

struct Vec3Lanes {
  FloatLanes x = {}, y = {}, z = {};

  friend Vec3Lanes operator+(Vec3Lanes a, Vec3Lanes b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3Lanes operator-(Vec3Lanes a, Vec3Lanes b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3Lanes operator-(Vec3Lanes a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3Lanes operator*(Vec3Lanes a, FloatLanes s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3Lanes operator*(FloatLanes s, Vec3Lanes a) { return a * s; }

  Vec3f Get(int lane) const { return {x[lane], y[lane], z[lane]}; }
  void Set(int lane, Vec3f v) {
    x[lane] = v.x;
    y[lane] = v.y;
    z[lane] = v.z;
  }
};

template <>
struct VectorsOf<FloatLanes> {
  using Vec2 = Vec2Lanes;
  using Vec3 = Vec3Lanes;
};

inline Vec3Lanes SameVector(Vec3f v) { return {SameFloat(v.x), SameFloat(v.y), SameFloat(v.z)}; }
inline Vec3Lanes Fma(Vec3Lanes a, FloatLanes s, Vec3Lanes b) {
  return {Fma(a.x, s, b.x), Fma(a.y, s, b.y), Fma(a.z, s, b.z)};
}
inline FloatLanes Dot(Vec3Lanes a, Vec3Lanes b) { return Fma(a.x, b.x, Fma(a.y, b.y, a.z * b.z)); }
inline FloatLanes AbsDot(Vec3Lanes a, Vec3Lanes b) { return Abs(Dot(a, b)); }
inline FloatLanes LengthSquared(Vec3Lanes a) { return Dot(a, a); }
inline Vec3Lanes Normalize(Vec3Lanes a) { return a * (1 / Sqrt(LengthSquared(a))); }
inline Vec3Lanes Cross(Vec3Lanes a, Vec3Lanes b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3Lanes Abs(Vec3Lanes a) { return {Abs(a.x), Abs(a.y), Abs(a.z)}; }
inline Vec3Lanes Select(MaskLanes m, Vec3Lanes a, Vec3Lanes b) {
  return {m ? a.x : b.x, m ? a.y : b.y, m ? a.z : b.z};
}

struct RgbLanes {
  FloatLanes r = {}, g = {}, b = {};

  friend RgbLanes operator+(RgbLanes a, RgbLanes b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
  friend RgbLanes operator-(RgbLanes a, RgbLanes b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
  friend RgbLanes operator*(RgbLanes a, RgbLanes b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
  friend RgbLanes operator/(RgbLanes a, RgbLanes b) { return {a.r / b.r, a.g / b.g, a.b / b.b}; }
  friend RgbLanes operator*(RgbLanes a, FloatLanes s) { return {a.r * s, a.g * s, a.b * s}; }

  Rgb Get(int lane) const { return {r[lane], g[lane], b[lane]}; }
  void Set(int lane, Rgb v) {
    r[lane] = v.r;
    g[lane] = v.g;
    b[lane] = v.b;
  }
};
inline RgbLanes SameColor(Rgb c) { return {SameFloat(c.r), SameFloat(c.g), SameFloat(c.b)}; }
inline MaskLanes IsBlack(RgbLanes c) { return (c.r == 0) & (c.g == 0) & (c.b == 0); }
inline FloatLanes MaxComponent(RgbLanes c) { return Max(c.r, Max(c.g, c.b)); }
inline RgbLanes Select(MaskLanes m, RgbLanes a, RgbLanes b) {
  return {m ? a.r : b.r, m ? a.g : b.g, m ? a.b : b.b};
}

struct FrameLanes {
  Vec3Lanes x, y, z;

  Vec3Lanes ToLocal(Vec3Lanes v) const { return {Dot(v, x), Dot(v, y), Dot(v, z)}; }
  Vec3Lanes ToWorld(Vec3Lanes v) const { return Fma(x, v.x, Fma(y, v.y, z * v.z)); }
  Frame Get(int lane) const { return {x.Get(lane), y.Get(lane), z.Get(lane)}; }
  void Set(int lane, const Frame& frame) {
    x.Set(lane, frame.x);
    y.Set(lane, frame.y);
    z.Set(lane, frame.z);
  }
  static FrameLanes FromNormal(Vec3Lanes n) {
    const FloatLanes one = SameFloat(1);
    const IntLanes sign_bit = reinterpret_cast<IntLanes>(n.z) & static_cast<int32_t>(0x80000000);
    const FloatLanes sign =
        reinterpret_cast<FloatLanes>(reinterpret_cast<IntLanes>(one) | sign_bit);
    const FloatLanes a = -1 / (sign + n.z);
    const FloatLanes b = n.x * n.y * a;
    return {{Fma(sign * n.x * n.x, a, one), sign * b, -sign * n.x},
            {b, Fma(n.y * n.y, a, sign), -n.y},
            n};
  }
};

}  // namespace strata
