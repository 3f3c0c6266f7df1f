#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// One of n outcomes by weight, in constant time: n equal bins, each shared by at most two outcomes
/// (Walker 1974; built by Vose's method, 1991; PBRT A.1).
///
/// Neighbouring random numbers go to unrelated outcomes, so stratified ones lose their order:
/// PiecewiseConstant1D keeps it.
class AliasTable {
 public:
  struct Choice {
    int outcome;
    float probability;  ///< Of the outcome.
    double fraction;    ///< The rest of u, still uniform in [0, 1), with log2(n) bits less.
  };

  /// At least one weight, fewer than 2^31; those that are not positive and finite count as 0; all
  /// zero is uniform.
  explicit AliasTable(std::span<const double> weights);

  int outcomes() const { return static_cast<int>(bins_.size()); }
  /// By `u` in [0, 1).
  Choice Choose(double u) const;
  float Probability(int outcome) const { return bins_[outcome].probability; }

 private:
  struct Bin {
    double own = 1;         ///< The part of the bin that is its own outcome's.
    int32_t other = 0;      ///< Whose the rest is.
    float probability = 0;  ///< Of the outcome with the bin's number.
  };
  std::vector<Bin> bins_;
};

}  // namespace strata
