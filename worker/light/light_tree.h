#pragma once

#include <cstdint>
#include <vector>

#include "worker/light/light_bounds.h"
#include "worker/light/light_options.h"

namespace strata {

/// A hierarchy of bounded lights, from which one is chosen for a point in O(log n) steps: at each
/// node one of two groups, by their importance (Conty Estevez and Kulla, "Importance Sampling of
/// Many Lights with Adaptive Tree Splitting", 2018, without the splitting). Immutable.
class LightTree {
 public:
  /// Index i of the tree is bounds[i], whose intensity is positive.
  static LightTree Build(std::vector<LightBounds> bounds, LightSelection selection);

  bool empty() const { return nodes_.empty(); }

  struct Choice {
    uint32_t index = 0;
    float probability = 0;  ///< 0: no light of the tree can reach the point.
    double u = 0;           ///< What is left of the random number.
  };
  /// `u` in [0, 1). The tree must not be empty.
  Choice Select(const LightReceiver& receiver, double u) const;
  /// With which Select finds `index`.
  float Probability(uint32_t index, const LightReceiver& receiver) const;

 private:
  struct Node {
    LightBounds bounds;
    uint32_t lights = 0;  ///< Below.
    /// Of an inner node the second child, the first being the next node; of a leaf the light.
    uint32_t second_or_light = 0;
    bool IsLeaf() const { return lights == 1; }
  };

  uint32_t BuildNode(std::vector<LightBounds>& bounds, std::vector<uint32_t>& order, size_t begin,
                     size_t end, uint64_t trail, int depth);
  /// Of the first of two children; negative where neither can give light.
  float FirstProbability(const Node& first, const Node& second,
                         const LightReceiver& receiver) const;
  float TreeProbability(uint32_t index, const LightReceiver& receiver) const;

  LightSelection selection_ = LightSelection::kTree;
  std::vector<Node> nodes_;       ///< Depth first.
  std::vector<uint64_t> trails_;  ///< For each light the turns from the root, the first in bit 0.
};

}  // namespace strata
