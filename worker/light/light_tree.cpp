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

/// One of some places, by their weights; Floats is one number or eight side by side.
template <typename Floats>
struct Picked {
  Floats place = {}, weight = {};  ///< The weight is 0 where none is positive.
  Floats start = {}, total = {};   ///< The sum of the weights before it, and of all.
};
/// That in which `at(total)`, in [0, total], falls. Without branches, which no one could predict.
/// Sums round to float: what falls to a place is off by less than 2^-22 of all.
template <typename Floats, typename At>
Picked<Floats> Pick(const Floats* weights, int places, At at) {
  Picked<Floats> picked;
  for (int i = 0; i < places; ++i) picked.total += weights[i];
  const Floats x = at(picked.total);
  Floats start = {};
  for (int i = 0; i < places; ++i) {
    // The last that starts at x or before: roundings at the end fall to it.
    const auto reached = (x >= start) & (weights[i] > 0);
    picked.place = reached ? Floats{} + static_cast<float>(i) : picked.place;
    picked.weight = reached ? weights[i] : picked.weight;
    picked.start = reached ? start : picked.start;
    start += weights[i];
  }
  return picked;
}

/// What is left, in [0, 1], of the random number `u`, of which `x` is its product with the weights'
/// sum; all of it if no weight is positive.
template <typename Doubles>
Doubles Rest(Doubles u, Doubles x, Doubles start, Doubles weight) {
  const Doubles rest = (x - start) / weight;
  const Doubles part = rest > 0 ? (rest < 1 ? rest : Doubles{} + 1) : Doubles{};
  return weight > 0 ? part : u;
}

/// A place, with which probability it is picked, and what is left of the random number.
struct Step {
  int place;
  float probability;
  double u;
};
/// By `u` in [0, 1).
Step PickOne(double u, const float* weights, int places) {
  double x = 0;
  const auto picked = Pick<float>(weights, places, [&](float total) {
    x = u * total;
    return static_cast<float>(x);
  });
  return {static_cast<int>(picked.place), picked.weight > 0 ? picked.weight / picked.total : 0,
          Rest<double>(u, x, picked.start, picked.weight)};
}

struct StepLanes {
  IntLanes place;
  FloatLanes probability;
  DoubleLanes u;
  FloatLanes total;  ///< Of the weights.
};
StepLanes PickOne(const DoubleLanes& u, const FloatLanes* weights, int places) {
  DoubleLanes x;
  const auto picked = Pick<FloatLanes>(weights, places, [&](FloatLanes total) {
    const DoubleLanes wide = ToDoubleLanes(total);
    for (int half = 0; half < 2; ++half) x.half[half] = u.half[half] * wide.half[half];
    return ToFloatLanes(x);
  });
  StepLanes step = {ToInt(picked.place),
                    picked.weight > 0 ? picked.weight / picked.total : FloatLanes{},
                    {},
                    picked.total};
  const DoubleLanes start = ToDoubleLanes(picked.start), weight = ToDoubleLanes(picked.weight);
  for (int half = 0; half < 2; ++half)
    step.u.half[half] =
        Rest<Doubles4>(u.half[half], x.half[half], start.half[half], weight.half[half]);
  return step;
}

float Sum(const float* weights, int places) {
  float sum = 0;
  for (int i = 0; i < places; ++i) sum += weights[i];
  return sum;
}
/// The probability of picking the place.
float Share(const float* weights, int places, uint32_t place) {
  return weights[place] > 0 ? weights[place] / Sum(weights, places) : 0;
}

const float* Numbers(const Floats4& v) { return reinterpret_cast<const float*>(&v); }

/// Of sixteen numbers those at `index`.
IntLanes LookUp(const std::array<int32_t, LightTree::kRootPlaces>& table, IntLanes index) {
  const auto half = [&](size_t first) {
    const __m256i numbers = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(&table[first]));
    return reinterpret_cast<IntLanes>(
        _mm256_permutevar8x32_epi32(numbers, reinterpret_cast<__m256i>(index)));
  };
  return index < kLanes ? half(0) : half(kLanes);
}

}  // namespace

template <typename Real>
Real LightTree::WithEvenChoices(Real tree) const {
  const double even = kEvenChoices / static_cast<double>(lights_);
  return static_cast<float>(1 - kEvenChoices) * tree + static_cast<float>(even);
}

float LightTree::TreeProbability(uint32_t index, const LightReceiver& receiver) const {
  uint64_t trail = trails_[index];
  uint32_t place = trail % kRootPlaces;
  const Node* node = &nodes_[place / 4];
  float probability;
  if (receiver.root_sum > 0) {
    const Floats4 weights = Importance(node->group, receiver);
    probability = weights[place % 4] / receiver.root_sum;
  } else {
    probability = Share(WeighRoot(receiver).data(), root_places_, place);
  }
  place %= 4;
  for (trail /= kRootPlaces; probability > 0 && node->group.lights[place] != 1; trail /= 4) {
    node = &nodes_[node->child[place]];
    place = trail % 4;
    const Floats4 weights = Importance(node->group, receiver);
    probability *= Share(Numbers(weights), 4, place);
  }
  return probability;
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

LightTree::RootWeights LightTree::WeighRoot(const LightReceiver& receiver) const {
  RootWeights weights;
  const PointLanes point = PointOf<FloatLanes>(receiver);
  for (int first = 0; first < root_places_; first += kLanes) {
    const int second = first + 4 < root_places_ ? first + 4 : first;
    const FloatLanes w = Importance(nodes_[first / 4].group, nodes_[second / 4].group, point);
    _mm256_storeu_ps(&weights[first], w);
  }
  return weights;
}

bool LightTree::Descend(const float* weights, int places, Walk* walk) const {
  const Step step = PickOne(walk->u, weights, places);
  const Node& node = nodes_[walk->node + step.place / 4];
  const int place = step.place % 4;
  *walk = {node.child[place], walk->probability * step.probability, step.u, {}};
  const bool found = walk->probability > 0;
  if (found && node.group.lights[place] != 1) return true;
  walk->choice = found ? Choice{walk->node, WithEvenChoices(walk->probability), walk->u}
                       : Choice{0, 0, walk->u};
  return false;
}

LightTree::Choice LightTree::Select(const LightReceiver& receiver, double u) const {
  if (lights_ == 1) return {0, 1, u};
  if (const auto choice = ChooseEvenly(receiver, &u)) return *choice;
  Walk walk = {0, 1, u, {}};
  bool on = Descend(WeighRoot(receiver).data(), root_places_, &walk);
  while (on) {
    const Floats4 weights = Importance(nodes_[walk.node].group, receiver);
    on = Descend(Numbers(weights), 4, &walk);
  }
  return walk.choice;
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
  std::array<FloatLanes, kRootPlaces> root;
  const bool one_sided = !Any(mask & ~(points.one_sided < 0));
  for (int i = 0; i < root_places_; ++i)
    root[i] = Importance(nodes_[i / 4].group, i % 4, points, one_sided);
  DoubleLanes stretched;
  for (int half = 0; half < 2; ++half) stretched.half[half] = Stretch(u.half[half]);
  const StepLanes step = PickOne(stretched, root.data(), root_places_);
  const MaskLanes found = mask & (step.probability > 0);
  choices.u = ToFloatLanes(step.u);
  choices.root_sum = mask ? step.total : FloatLanes{};
  choices.probability = found ? WithEvenChoices(step.probability) : FloatLanes{};
  const IntLanes below = LookUp(root_children_, step.place);
  choices.index = (found & (below >= 0)) ? below : IntLanes{};
  std::array<Walk, kLanes> walks;
  unsigned walking = Bits(found & (below < 0));
  ForEachLane(found & (below < 0), [&](int lane) {
    walks[lane] = {
        static_cast<uint32_t>(~below[lane]), step.probability[lane], step.u.Get(lane), {}};
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
      if (Descend(Numbers(weights[lane]), 4, &walks[lane])) continue;
      walking &= ~(1u << lane);
      choose(lane, walks[lane].choice);
    }
  }
  return choices;
}

}  // namespace strata
