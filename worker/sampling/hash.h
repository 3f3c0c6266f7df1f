#pragma once

#include <cstdint>

namespace strata {

/// A bijection of 64-bit words in which every input bit moves every output bit (the finalizer of
/// splitmix64, variant 13 of D. Stafford).
inline constexpr uint64_t MixBits(uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

/// Adds one more word to a hash; order matters.
inline constexpr uint64_t HashCombine(uint64_t hash, uint64_t word) {
  return MixBits((hash ^ MixBits(word + 0x9e3779b97f4a7c15u)) * 0xd6e8feb86659fd93u);
}

}  // namespace strata
