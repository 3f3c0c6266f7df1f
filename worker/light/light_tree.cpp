#include "worker/light/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

/// The part of the choices in which all lights are alike. A wall may hide what seems to matter
/// most, and the noise of what faint lights bring then stays bounded (defensive sampling:
/// Hesterberg 1995).
constexpr double kEvenChoices = 0.01;

constexpr int kBuckets = 12;

/// The intensity of a group times the measure of the directions it shines in and of its box: what
/// makes groups compact in place and direction (Conty Estevez and Kulla, 4.4).
double Cost(const LightBounds& b) {
  const double spread = SpreadAngle(b);
  const double reach = std::min(spread + EmitAngle(b), kHalfTurn);
  const double sine = Sin(spread), cosine = b.cos_spread;
  const double directions =
      2 * kHalfTurn * (1 - cosine) +
      kHalfTurn / 2 * (2 * reach * sine - Cos(spread - 2 * reach) - 2 * spread * sine + cosine);
  const Vec3d d = ToDouble(b.max) - ToDouble(b.min);
  // The square of the diagonal too, since lights in a row have no surface.
  const double size = 2 * (d.x * d.y + d.y * d.z + d.z * d.x) + Dot(d, d);
  return b.intensity * directions * size;
}

struct Bucket {
  LightBounds bounds;
  size_t lights = 0;

  void Add(const LightBounds& b, size_t count) {
    if (count == 0) return;
    bounds = lights == 0 ? b : Union(bounds, b);
    lights += count;
  }
  void Add(const Bucket& other) { Add(other.bounds, other.lights); }
};

struct BestSplit {
  int axis = -1;
  int bucket = 0;  ///< The last one of the first group.
  double cost = std::numeric_limits<double>::infinity();
};

int BucketOf(float center, float low, float extent) {
  return std::clamp(static_cast<int>(kBuckets * ((center - low) / extent)), 0, kBuckets - 1);
}

/// A part of the order in which lights are sorted into the tree.
struct Range {
  size_t begin = 0, end = 0;
  size_t Count() const { return end - begin; }
};

/// Sorts lights into groups.
class Sorter {
 public:
  explicit Sorter(const std::vector<LightBounds>& bounds) : bounds_(bounds), order_(bounds.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  uint32_t Light(size_t place) const { return order_[place]; }

  LightBounds BoundsOf(Range range) const {
    LightBounds all = bounds_[order_[range.begin]];
    for (size_t i = range.begin + 1; i < range.end; ++i) all = Union(all, bounds_[order_[i]]);
    return all;
  }

  /// Two groups of two lights or more: where the cost is least, or halves if `evenly`.
  std::pair<Range, Range> Split(Range range, bool evenly) {
    Vec3f low = bounds_[order_[range.begin]].Center(), high = low;
    for (size_t i = range.begin; i < range.end; ++i) {
      const Vec3f center = bounds_[order_[i]].Center();
      low = Min(low, center);
      high = Max(high, center);
    }
    const Vec3f extent = high - low;
    BestSplit best;
    for (int axis = 0; axis < 3 && !evenly; ++axis) {
      if (!(extent[axis] > 0) || !std::isfinite(extent[axis])) continue;
      // Long thin boxes are cut across.
      const double shape = MaxComponent(extent) / extent[axis];
      FindSplit(range, axis, low[axis], extent[axis], shape, &best);
    }
    size_t middle = range.begin + range.Count() / 2;
    if (best.axis >= 0) {
      const auto first = order_.begin() + static_cast<std::ptrdiff_t>(range.begin);
      const auto last = order_.begin() + static_cast<std::ptrdiff_t>(range.end);
      const auto before = [&](uint32_t light) {
        const float center = bounds_[light].Center()[best.axis];
        return BucketOf(center, low[best.axis], extent[best.axis]) <= best.bucket;
      };
      middle = static_cast<size_t>(std::stable_partition(first, last, before) - order_.begin());
    }
    return {{range.begin, middle}, {middle, range.end}};
  }

 private:
  void FindSplit(Range range, int axis, float low, float extent, double shape, BestSplit* best) {
    std::array<Bucket, kBuckets> buckets, behind;
    for (size_t i = range.begin; i < range.end; ++i) {
      const LightBounds& b = bounds_[order_[i]];
      buckets[BucketOf(b.Center()[axis], low, extent)].Add(b, 1);
    }
    for (int i = kBuckets - 1; i > 0; --i) {
      if (i + 1 < kBuckets) behind[i] = behind[i + 1];
      behind[i].Add(buckets[i]);
    }
    Bucket before;
    for (int i = 0; i + 1 < kBuckets; ++i) {
      before.Add(buckets[i]);
      if (before.lights == 0 || behind[i + 1].lights == 0) continue;
      const double cost = shape * (Cost(before.bounds) + Cost(behind[i + 1].bounds));
      if (cost < best->cost) *best = {axis, i, cost};
    }
  }

  const std::vector<LightBounds>& bounds_;
  std::vector<uint32_t> order_;
};

}  // namespace

LightTree LightTree::Build(const std::vector<LightBounds>& bounds, LightSelection selection) {
  LightTree tree;
  tree.selection_ = selection;
  tree.lights_ = bounds.size();
  tree.trails_.resize(bounds.size());
  Sorter sorter(bounds);
  struct Open {
    Range range;
    uint32_t node;
    int depth;
    uint64_t trail;
  };
  // Below this level groups are cut evenly, whatever it costs, so that trails fit their words.
  constexpr int kMaxCostDepth = 16;
  std::vector<Open> open = {{{0, bounds.size()}, 0, 0, 0}};
  tree.nodes_.emplace_back();
  while (!open.empty()) {
    const Open now = open.back();
    open.pop_back();
    const bool evenly = now.depth >= kMaxCostDepth;
    std::vector<Range> parts = {now.range};
    while (parts.size() < 4) {
      // The largest part is cut next.
      const auto largest = std::max_element(parts.begin(), parts.end(),
                                            [](Range a, Range b) { return a.Count() < b.Count(); });
      if (largest->Count() < 2) break;
      const auto [first, second] = sorter.Split(*largest, evenly);
      *largest = first;
      parts.push_back(second);
    }
    for (size_t place = 0; place < parts.size(); ++place) {
      const Range part = parts[place];
      const uint64_t trail = now.trail | uint64_t{place} << (2 * now.depth);
      const uint32_t count = static_cast<uint32_t>(part.Count());
      uint32_t child;
      if (count == 1) {
        child = sorter.Light(part.begin);
        tree.trails_[child] = trail;
      } else {
        child = static_cast<uint32_t>(tree.nodes_.size());
        tree.nodes_.emplace_back();
        open.push_back({part, child, now.depth + 1, trail});
      }
      Node& node = tree.nodes_[now.node];
      node.child[place] = child;
      node.group.Set(static_cast<int>(place), sorter.BoundsOf(part), count);
    }
  }
  return tree;
}

Floats4 LightTree::Weights(const LightGroup& group, const LightReceiver& receiver) const {
  if (selection_ == LightSelection::kTree) return Importance(group, receiver);
  if (selection_ == LightSelection::kIntensity) return group.intensity;
  Floats4 counts;
  for (int i = 0; i < 4; ++i) counts[i] = static_cast<float>(group.lights[i]);
  return counts;
}

float LightTree::TreeProbability(uint32_t index, const LightReceiver& receiver) const {
  float probability = 1;
  uint64_t trail = trails_[index];
  for (uint32_t node = 0;; trail >>= 2) {
    const Floats4 weights = Weights(nodes_[node].group, receiver);
    const uint64_t place = trail & 3;
    if (!(weights[place] > 0)) return 0;
    probability *= weights[place] / (weights[0] + weights[1] + weights[2] + weights[3]);
    if (nodes_[node].group.lights[place] == 1) return probability;
    node = nodes_[node].child[place];
  }
}

float LightTree::Probability(uint32_t index, const LightReceiver& receiver) const {
  if (lights_ == 1) return 1;
  const float even = static_cast<float>(kEvenChoices / static_cast<double>(lights_));
  return static_cast<float>(1 - kEvenChoices) * TreeProbability(index, receiver) + even;
}

bool LightTree::ChooseEvenly(const LightReceiver& receiver, Walk* walk) const {
  if (walk->u >= kEvenChoices) {
    walk->u = (walk->u - kEvenChoices) / (1 - kEvenChoices);
    return false;
  }
  const double n = static_cast<double>(lights_);
  const double at = walk->u / kEvenChoices * n;
  const uint32_t index = static_cast<uint32_t>(std::min(at, n - 1));
  walk->choice = {index, Probability(index, receiver), at - index};
  return true;
}

bool LightTree::Descend(Floats4 weights, Walk* walk) const {
  const float sum = weights[0] + weights[1] + weights[2] + weights[3];
  if (!(sum > 0)) {
    walk->choice = {0, 0, walk->u};
    return false;
  }
  // The place whose part of the sum u falls into; roundings at the end fall to the last of them.
  // Without branches, which no one could predict.
  const double x = walk->u * sum;
  double starts[4] = {};
  for (int i = 1; i < 4; ++i) starts[i] = starts[i - 1] + weights[i - 1];
  const int passed = (x >= starts[1]) + (x >= starts[2]) + (x >= starts[3]);
  const auto positive = static_cast<unsigned>(_mm_movemask_ps(weights > 0 ? -weights : weights));
  const int place = std::min(passed, static_cast<int>(std::bit_width(positive)) - 1);
  walk->u = std::min((x - starts[place]) / weights[place], 1.0);
  walk->probability *= weights[place] / sum;
  const Node& node = nodes_[walk->node];
  walk->node = node.child[place];
  if (node.group.lights[place] != 1) return true;
  const float even = static_cast<float>(kEvenChoices / static_cast<double>(lights_));
  walk->choice = {node.child[place],
                  static_cast<float>(1 - kEvenChoices) * walk->probability + even, walk->u};
  return false;
}

LightTree::Choice LightTree::Select(const LightReceiver& receiver, double u) const {
  if (lights_ == 1) return {0, 1, u};
  Walk walk = {0, 1, u, {}};
  if (ChooseEvenly(receiver, &walk)) return walk.choice;
  while (Descend(Weights(nodes_[walk.node].group, receiver), &walk)) {
  }
  return walk.choice;
}

std::array<LightTree::Choice, kLanes> LightTree::Select(const LightReceiverLanes& receivers,
                                                        const std::array<double, kLanes>& u,
                                                        MaskLanes mask) const {
  std::array<Choice, kLanes> choices;
  if (lights_ == 1 || selection_ != LightSelection::kTree) {
    ForEachLane(mask, [&](int lane) { choices[lane] = Select(receivers.Get(lane), u[lane]); });
    return choices;
  }
  std::array<Walk, kLanes> walks;
  unsigned walking = 0;
  ForEachLane(mask, [&](int lane) {
    walks[lane] = {0, 1, u[lane], {}};
    if (!ChooseEvenly(receivers.Get(lane), &walks[lane])) walking |= 1u << lane;
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
                                     nodes_[walks[second].node].group, receivers, first, second);
      weights[second] = _mm256_extractf128_ps(both, 1);
      weights[first] = _mm256_castps256_ps128(both);
    }
    for (unsigned rest = walking; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (!Descend(weights[lane], &walks[lane])) walking &= ~(1u << lane);
    }
  }
  ForEachLane(mask, [&](int lane) { choices[lane] = walks[lane].choice; });
  return choices;
}

}  // namespace strata
