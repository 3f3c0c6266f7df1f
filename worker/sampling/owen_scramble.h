#pragma once

#include <immintrin.h>

#include <cstdint>

#include "worker/math/vec.h"

// Pieces of scrambled Sobol' points. Fractions are 32-bit integers times 2^-32; "reversed" words
// have their bits in the opposite order: bit 0 is the first binary digit. There a scramble in which
// each digit depends on those before it is made of additions and multiplications.

namespace strata {

inline constexpr uint32_t ReverseBits(uint32_t v) {
  v = __builtin_bswap32(v);
  v = ((v & 0x0f0f0f0fu) << 4) | ((v >> 4) & 0x0f0f0f0fu);
  v = ((v & 0x33333333u) << 2) | ((v >> 2) & 0x33333333u);
  return ((v & 0x55555555u) << 1) | ((v >> 1) & 0x55555555u);
}

/// Nested uniform scramble of a reversed fraction: a bijection whose bit k depends on the bits up
/// to k alone. The hash of N. Vegdahl, "Building a Better LK Hash" (2021).
inline constexpr uint32_t OwenScrambleReversed(uint32_t v, uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1;
  v ^= v * 0x05526c56u;
  return v ^ (v * 0x53a22864u);
}

/// The second Sobol' coordinate of an index, reversed. Its matrix is Pascal's triangle mod 2, where
/// binomial(i, j) is odd when the bits of j are among those of i (Lucas): a product of five steps,
/// one for each bit of i.
inline constexpr uint32_t SobolSecondReversed(uint32_t index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  return index ^ (index >> 16);
}

/// The first 24 digits of a fraction, in [0, 1).
inline constexpr float UnitFloat(uint32_t fraction) {
  return static_cast<float>(fraction >> 8) * 0x1p-24f;
}

/// UnitFloat of both reversed fractions. Bytes are reversed by a table of their half bytes.
inline Vec2f UnitSquareFromReversed(uint32_t x, uint32_t y) {
  const __m128i half_byte = _mm_set1_epi8(0x0f);
  const __m128i reversed_low = _mm_setr_epi8(
      0x00, static_cast<char>(0x80), 0x40, static_cast<char>(0xc0), 0x20, static_cast<char>(0xa0),
      0x60, static_cast<char>(0xe0), 0x10, static_cast<char>(0x90), 0x50, static_cast<char>(0xd0),
      0x30, static_cast<char>(0xb0), 0x70, static_cast<char>(0xf0));
  const __m128i reversed_high = _mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15);
  // The last byte of each word falls out: 24 digits fill a float.
  const __m128i first_three_bytes =
      _mm_setr_epi8(2, 1, 0, -1, 6, 5, 4, -1, -1, -1, -1, -1, -1, -1, -1, -1);
  const __m128i words = _mm_cvtsi64_si128(static_cast<int64_t>((uint64_t{y} << 32) | x));
  const __m128i low = _mm_shuffle_epi8(reversed_low, _mm_and_si128(words, half_byte));
  const __m128i high =
      _mm_shuffle_epi8(reversed_high, _mm_and_si128(_mm_srli_epi16(words, 4), half_byte));
  const __m128i digits = _mm_shuffle_epi8(_mm_or_si128(low, high), first_three_bytes);
  const __m128 unit = _mm_mul_ps(_mm_cvtepi32_ps(digits), _mm_set1_ps(0x1p-24f));
  Vec2f result;
  _mm_storel_pi(reinterpret_cast<__m64*>(&result), unit);
  return result;
}

}  // namespace strata
