#include "worker/light/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>

#include "worker/math/cpu_clones.h"
namespace strata {
namespace {

/// The part of the choices in which all lights are alike. A wall may hide what seems to matter
/// most, and the noise of what faint lights bring then stays bounded (defensive sampling:
/// Hesterberg 1995).
constexpr double kEvenChoices = 0.01;
/// Random numbers of the other choices, over [0, 1).
template <typename Real>
Real Stretch(Real u) {
  return (u - kEvenChoices) * (1 / (1 - kEvenChoices));
}

/// One of four places, by their weights.
template <typename Real>
struct Picked {
  Real place, weight, sum;  ///< The sum of all weights.
  Real u;                   ///< What is left of the random number, in [0, 1].
};
/// By `u` in [0, 1); the weight is 0 where none is positive. Real is one number or some side by
/// side. Without branches, which no one could predict.
template <typename Real>
Picked<Real> Pick(Real u, const Real (&weights)[4]) {
  Picked<Real> picked = {};
  picked.sum = weights[0] + weights[1] + weights[2] + weights[3];
  const Real x = u * picked.sum;
  Real start = {}, next = {};
  for (int i = 0; i < 4; ++i) {
    // The last that starts below x: roundings at the end fall to it.
    const auto reached = (x >= next) & (weights[i] > 0);
    picked.place = reached ? Real{} + i : picked.place;
    picked.weight = reached ? weights[i] : picked.weight;
    start = reached ? next : start;
    next += weights[i];
  }
  const Real rest = (x - start) / picked.weight;
  picked.u = picked.weight > 0 ? (rest < 1 ? rest : Real{} + 1) : u;
  return picked;
}

Picked<double> Pick(double u, Floats4 weights) {
  return Pick<double>(u, {weights[0], weights[1], weights[2], weights[3]});
}

/// The probability of picking a place of that weight.
float Share(double weight, double sum) {
  return weight > 0 ? static_cast<float>(weight) / static_cast<float>(sum) : 0;
}
float Share(Floats4 weights, uint32_t place) {
  return Share(weights[place], double{weights[0]} + weights[1] + weights[2] + weights[3]);
}

struct PickedLanes {
  IntLanes place;
  FloatLanes probability;
  DoubleLanes u;
};
PickedLanes Pick(const DoubleLanes& u, const std::array<FloatLanes, 4>& weights) {
  std::array<Picked<Doubles4>, 2> picked;
  for (int half = 0; half < 2; ++half) {
    const auto of = [&](int i) { return ToDoubleLanes(weights[i]).half[half]; };
    picked[half] = Pick<Doubles4>(u.half[half], {of(0), of(1), of(2), of(3)});
  }
  const auto both = [&](Doubles4 Picked<Doubles4>::*member) {
    return ToFloatLanes({{picked[0].*member, picked[1].*member}});
  };
  const FloatLanes weight = both(&Picked<Doubles4>::weight);
  return {ToInt(both(&Picked<Doubles4>::place)),
          weight > 0 ? weight / both(&Picked<Doubles4>::sum) : FloatLanes{},
          {{picked[0].u, picked[1].u}}};
}

}  // namespace

template <typename Real>
Real LightTree::WithEvenChoices(Real tree) const {
  const double even = kEvenChoices / static_cast<double>(lights_);
  return static_cast<float>(1 - kEvenChoices) * tree + static_cast<float>(even);
}

float LightTree::TreeProbability(uint32_t index, const LightReceiver& receiver) const {
  uint64_t trail = trails_[index];
  Walk walk = {0, 1, 0, {}};
  if (root_nodes_ > 1) {
    walk.node = trail & 3;
    walk.probability = Share(RootWeights(receiver), walk.node);
    trail >>= 2;
  }
  for (;; trail >>= 2) {
    const Node& node = nodes_[walk.node];
    const uint32_t place = trail & 3;
    const Floats4 weights = Importance(node.group, receiver);
    walk.probability *= Share(weights, place);
    if (!(walk.probability > 0) || node.group.lights[place] == 1) return walk.probability;
    walk.node = node.child[place];
  }
}

float LightTree::Probability(uint32_t index, const LightReceiver& receiver) const {
  return lights_ == 1 ? 1 : WithEvenChoices(TreeProbability(index, receiver));
}

std::optional<LightTree::Choice> LightTree::ChooseEvenly(const LightReceiver& receiver,
                                                         double* u) const {
  if (*u >= kEvenChoices) {
    *u = Stretch(*u);
    return std::nullopt;
  }
  const double n = static_cast<double>(lights_);
  const double at = *u / kEvenChoices * n;
  const uint32_t index = static_cast<uint32_t>(std::min(at, n - 1));
  return Choice{index, Probability(index, receiver), at - index};
}

Floats4 LightTree::RootWeights(const LightReceiver& receiver) const {
  Floats4 weights = {};
  for (uint32_t i = 0; i < root_nodes_; ++i) {
    const Floats4 w = Importance(nodes_[i].group, receiver);
    weights[i] = w[0] + w[1] + w[2] + w[3];
  }
  return weights;
}

LightTree::Walk LightTree::Start(const LightReceiver& receiver, double u) const {
  if (root_nodes_ == 1) return {0, 1, u, {}};
  const auto picked = Pick(u, RootWeights(receiver));
  return {static_cast<uint32_t>(picked.place), Share(picked.weight, picked.sum), picked.u, {}};
}

bool LightTree::Descend(Floats4 weights, Walk* walk) const {
  const auto picked = Pick(walk->u, weights);
  const int place = static_cast<int>(picked.place);
  const Node& node = nodes_[walk->node];
  *walk = {node.child[place], walk->probability * Share(picked.weight, picked.sum), picked.u, {}};
  const bool found = walk->probability > 0;
  if (found && node.group.lights[place] != 1) return true;
  walk->choice = found ? Choice{walk->node, WithEvenChoices(walk->probability), walk->u}
                       : Choice{0, 0, walk->u};
  return false;
}

LightTree::Choice LightTree::Select(const LightReceiver& receiver, double u) const {
  if (lights_ == 1) return {0, 1, u};
  if (const auto choice = ChooseEvenly(receiver, &u)) return *choice;
  Walk walk = Start(receiver, u);
  while (Descend(Importance(nodes_[walk.node].group, receiver), &walk)) {
  }
  return walk.choice;
}

STRATA_CPU_CLONES LightTree::WalkLanes LightTree::Start(const PointLanes& points,
                                                        const DoubleLanes& u) const {
  std::array<FloatLanes, 4> weights[4];
  std::array<FloatLanes, 4> sums = {};
  for (uint32_t i = 0; i < root_nodes_; ++i) {
    const LightGroup& group = nodes_[i].group;
    for (int place = 0; place < 4; ++place)
      weights[i][place] = group.lights[place] > 0 ? Importance(group, place, points) : FloatLanes{};
    sums[i] = weights[i][0] + weights[i][1] + weights[i][2] + weights[i][3];
  }
  PickedLanes node = {{}, SameFloat(1), u};
  if (root_nodes_ > 1) node = Pick(u, sums);
  std::array<FloatLanes, 4> here = weights[0];
  for (int i = 1; i < static_cast<int>(root_nodes_); ++i) {
    for (int place = 0; place < 4; ++place)
      here[place] = node.place == i ? weights[i][place] : here[place];
  }
  const PickedLanes place = Pick(node.u, here);
  return {node.place, place.place, node.probability * place.probability, place.u};
}

STRATA_CPU_CLONES LightTree::ChoiceLanes LightTree::Select(const LightReceiverLanes& receivers,
                                                           const DoubleLanes& u,
                                                           MaskLanes mask) const {
  ChoiceLanes choices;
  const auto choose = [&](int lane, const Choice& choice) {
    choices.index[lane] = static_cast<int32_t>(choice.index);
    choices.probability[lane] = choice.probability;
    choices.u[lane] = static_cast<float>(choice.u);
  };
  if (lights_ == 1) {
    ForEachLane(mask, [&](int lane) { choose(lane, Select(receivers.Get(lane), u.Get(lane))); });
    return choices;
  }
  // The root is the same for all: each of its places is weighed for all points at once.
  const PointLanes points = PointsOf(receivers);
  DoubleLanes stretched;
  for (int half = 0; half < 2; ++half) stretched.half[half] = Stretch(u.half[half]);
  const WalkLanes start = Start(points, stretched);
  choices.u = ToFloatLanes(start.u);
  choices.probability = start.probability > 0 ? WithEvenChoices(start.probability) : FloatLanes{};
  std::array<Walk, kLanes> walks;
  unsigned walking = 0;
  ForEachLane(mask & (start.probability > 0), [&](int lane) {
    const Node& node = nodes_[start.node[lane]];
    const int place = start.place[lane];
    choices.index[lane] = static_cast<int32_t>(node.child[place]);
    if (node.group.lights[place] == 1) return;
    walks[lane] = {node.child[place], start.probability[lane], start.u.Get(lane), {}};
    walking |= 1u << lane;
  });
  // Those whose number chooses among all alike; rounding may add some to them.
  ForEachLane(mask & (ToFloatLanes(u) <= static_cast<float>(kEvenChoices)), [&](int lane) {
    double number = u.Get(lane);
    const std::optional<Choice> choice = ChooseEvenly(receivers.Get(lane), &number);
    if (!choice) return;
    choose(lane, *choice);
    walking &= ~(1u << lane);
  });
  while (walking != 0) {
    // Weighed two by two, then all go on.
    std::array<Floats4, kLanes> weights;
    for (unsigned rest = walking; rest != 0;) {
      const int first = std::countr_zero(rest);
      rest &= rest - 1;
      const int second = rest != 0 ? std::countr_zero(rest) : first;
      rest &= rest - 1;
      const __m256 both = Importance(nodes_[walks[first].node].group,
                                     nodes_[walks[second].node].group, points, first, second);
      weights[second] = _mm256_extractf128_ps(both, 1);
      weights[first] = _mm256_castps256_ps128(both);
    }
    for (unsigned rest = walking; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (Descend(weights[lane], &walks[lane])) continue;
      walking &= ~(1u << lane);
      choose(lane, walks[lane].choice);
    }
  }
  return choices;
}

}  // namespace strata
