#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "worker/light/light_group.h"

namespace strata {

/// A hierarchy of bounded lights, from which one is chosen for a point in O(log n) steps: at the
/// root one of up to sixteen groups, then one of four at each node, by their importance (Conty
/// Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018,
/// without the splitting). Immutable.
class LightTree {
 public:
  static constexpr int kRootPlaces = 16;

  /// Index i of the tree is bounds[i], whose intensity is positive.
  static LightTree Build(const std::vector<LightBounds>& bounds);

  struct Choice {
    uint32_t index;
    float probability;  ///< 0: no light was found that can reach the point.
    double u;           ///< What is left of the random number.
  };
  /// `u` in [0, 1). The tree must not be empty.
  Choice Select(const LightReceiver& receiver, double u) const;
  struct ChoiceLanes {
    IntLanes index = {};
    FloatLanes probability = {}, u = {};
    FloatLanes root_sum = {};  ///< For LightReceiver; 0 outside the mask.
  };
  /// Select for each lane in `mask`.
  ChoiceLanes Select(const LightReceiverLanes& receivers, const DoubleLanes& u,
                     MaskLanes mask) const;
  /// With which Select finds `index`.
  float Probability(uint32_t index, const LightReceiver& receiver) const;

 private:
  struct Node {
    LightGroup group;
    uint32_t child[4] = {};  ///< A node, or, where there is one light below, that light.
  };

  /// A walk from the root to a light.
  struct Walk {
    uint32_t node;
    float probability;
    double u;
    Choice choice;
  };
  /// Where a random number chooses one of the lights by no more than their number; none, and what
  /// is left of the number, if it does not.
  std::optional<Choice> ChooseEvenly(const LightReceiver& receiver, double* u) const;
  using RootWeights = std::array<float, kRootPlaces>;
  RootWeights WeighRoot(const LightReceiver& receiver) const;
  /// One step, by the weights of so many places of nodes from the walk's on; false at the end,
  /// where there is a choice.
  bool Descend(const float* weights, int places, Walk* walk) const;
  /// The probability of a choice that the tree alone finds with `tree`.
  template <typename Real>
  Real WithEvenChoices(Real tree) const;
  float TreeProbability(uint32_t index, const LightReceiver& receiver) const;

  size_t lights_ = 0;
  int root_places_ = 0;  ///< Of the first nodes.
  std::vector<Node> nodes_;
  /// Below each of the root's places: a light, or ~node.
  std::array<int32_t, kRootPlaces> root_children_ = {};
  /// For each light its way from the root, four bits of the root's place and two of each later
  /// step.
  std::vector<uint64_t> trails_;
};

}  // namespace strata
