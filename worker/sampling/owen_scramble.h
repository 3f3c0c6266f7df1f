#pragma once

#include <immintrin.h>

#include <cstdint>

// Pieces of scrambled Sobol' points (PBRT 8.7). Fractions are 32-bit integers times 2^-32;
// "reversed" words have their bits in the opposite order: bit 0 is the first binary digit. There a
// scramble in which each digit depends on those before it is made of additions and multiplications.
//
// Word is uint32_t or a vector of them.

namespace strata {

using Words4 __attribute__((vector_size(16))) = uint32_t;
using Words8 __attribute__((vector_size(32))) = uint32_t;

inline constexpr uint32_t ReverseBytes(uint32_t v) { return __builtin_bswap32(v); }
inline Words4 ReverseBytes(Words4 v) {
  using Bytes __attribute__((vector_size(16))) = uint8_t;
  const Bytes b = reinterpret_cast<Bytes>(v);
  return reinterpret_cast<Words4>(
      __builtin_shufflevector(b, b, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
}
inline Words8 ReverseBytes(Words8 v) {
  using Bytes __attribute__((vector_size(32))) = uint8_t;
  const Bytes b = reinterpret_cast<Bytes>(v);
  return reinterpret_cast<Words8>(__builtin_shufflevector(b, b, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9,
                                                          8, 15, 14, 13, 12, 19, 18, 17, 16, 23, 22,
                                                          21, 20, 27, 26, 25, 24, 31, 30, 29, 28));
}

template <typename Word>
constexpr Word ReverseBits(Word v) {
  v = ReverseBytes(v);
  v = ((v & 0x0f0f0f0fu) << 4) | ((v >> 4) & 0x0f0f0f0fu);
  v = ((v & 0x33333333u) << 2) | ((v >> 2) & 0x33333333u);
  return ((v & 0x55555555u) << 1) | ((v >> 1) & 0x55555555u);
}

/// By two tables of half bytes in the place of six shifts.
inline Words8 ReverseBits(Words8 v) {
  const __m256i bytes = reinterpret_cast<__m256i>(ReverseBytes(v));
  const __m256i half = _mm256_set1_epi8(0x0f);
  const __m256i reversed = _mm256_broadcastsi128_si256(_mm_setr_epi8(
      0x0, 0x8, 0x4, 0xc, 0x2, 0xa, 0x6, 0xe, 0x1, 0x9, 0x5, 0xd, 0x3, 0xb, 0x7, 0xf));
  const __m256i low = _mm256_shuffle_epi8(_mm256_slli_epi16(reversed, 4), bytes & half);
  const __m256i high = _mm256_shuffle_epi8(reversed, _mm256_srli_epi16(bytes, 4) & half);
  return reinterpret_cast<Words8>(low | high);
}

/// Nested uniform scramble of a reversed fraction: a bijection whose bit k depends on the bits up
/// to k alone (PBRT 8.7.2). The hash of N. Vegdahl, "Building a Better LK Hash" (2021).
template <typename Word>
constexpr Word OwenScrambleReversed(Word v, Word seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  return v ^ (v * 0x53a22864u);
}

/// The second Sobol' coordinate of an index, reversed. Its matrix is Pascal's triangle mod 2, where
/// binomial(i, j) is odd when the bits of j are among those of i (Lucas): a product of five steps,
/// one for each bit of i.
template <typename Word>
constexpr Word SobolSecondReversed(Word index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  return index ^ (index >> 16);
}

/// A bijection of 32-bit words with little bias ("lowbias32", C. Wellons 2018).
template <typename Word>
constexpr Word MixWord(Word v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

/// The seed of one scramble of a pair of dimensions, from a 64-bit key. `use` is 0 or 1 for the two
/// coordinates, 2 for the order of the points.
template <typename Key, typename Word>
constexpr Word ScrambleSeed(Key key_low, Key key_high, Word pair, Word use) {
  return MixWord(MixWord(pair * 4 + use + key_low) ^ key_high);
}
template <typename Word>
constexpr Word ScrambleSeed(uint64_t key, Word pair, Word use) {
  return ScrambleSeed(static_cast<uint32_t>(key), static_cast<uint32_t>(key >> 32), pair, use);
}

}  // namespace strata
