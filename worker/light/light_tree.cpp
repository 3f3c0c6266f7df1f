#include "worker/light/light_tree.h"

#include <array>
#include <limits>
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

/// Below this level groups are halved, whatever it costs, so that trails fit their words.
constexpr int kMaxCostDepth = 32;
constexpr int kBuckets = 12;

double AngleOf(float cosine) { return Acos(std::clamp(double{cosine}, -1.0, 1.0)); }

/// The intensity of a group times the measure of the directions it shines in and of its box: what
/// makes groups compact in place and direction (Conty Estevez and Kulla, 4.4).
double Cost(const LightBounds& b) {
  const double spread = AngleOf(b.cos_spread);
  const double reach = std::min(spread + kHalfTurn / 2, kHalfTurn);
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

  void Add(const LightBounds& b) { bounds = lights++ == 0 ? b : Union(bounds, b); }
};

struct Split {
  int axis = -1;
  int bucket = 0;  ///< The last one of the first group.
  double cost = std::numeric_limits<double>::infinity();
};

int BucketOf(float center, float low, float extent) {
  return std::clamp(static_cast<int>(kBuckets * ((center - low) / extent)), 0, kBuckets - 1);
}

}  // namespace

LightBounds Union(const LightBounds& a, const LightBounds& b) {
  LightBounds both;
  both.min = Min(a.min, b.min);
  both.max = Max(a.max, b.max);
  both.intensity = a.intensity + b.intensity;
  both.two_sided = a.two_sided || b.two_sided;
  // The smallest cone around both (PBRT 3.8.4).
  const LightBounds &wide = a.cos_spread <= b.cos_spread ? a : b, &other = &wide == &a ? b : a;
  const double between = AngleOf(Dot(wide.axis, other.axis));
  const double theta_wide = AngleOf(wide.cos_spread), theta_other = AngleOf(other.cos_spread);
  // A little more than that, for the roundings.
  constexpr double kMargin = 1e-5;
  both.axis = wide.axis;
  both.cos_spread = wide.cos_spread;
  if (std::min(between + theta_other, kHalfTurn) <= theta_wide) return both;
  const double spread = 0.5 * (theta_wide + between + theta_other) + kMargin;
  const Vec3d axis = ToDouble(wide.axis),
              side = ToDouble(other.axis) - axis * Dot(axis, ToDouble(other.axis));
  const double length = std::sqrt(Dot(side, side));
  if (spread >= kHalfTurn || !(length > 0)) {
    both.cos_spread = -1;
    return both;
  }
  const double turn = spread - theta_wide;
  both.axis = Normalize(ToFloat(axis * Cos(turn) + side * (Sin(turn) / length)));
  both.cos_spread = std::max(static_cast<float>(Cos(spread)) - 0x1p-23f, -1.0f);
  return both;
}

LightTree LightTree::Build(std::vector<LightBounds> bounds, LightSelection selection) {
  LightTree tree;
  tree.selection_ = selection;
  if (bounds.empty()) return tree;
  tree.nodes_.reserve(2 * bounds.size() - 1);
  tree.trails_.resize(bounds.size());
  std::vector<uint32_t> order(bounds.size());
  std::iota(order.begin(), order.end(), 0u);
  tree.BuildNode(bounds, order, 0, order.size(), 0, 0);
  return tree;
}

uint32_t LightTree::BuildNode(std::vector<LightBounds>& bounds, std::vector<uint32_t>& order,
                              size_t begin, size_t end, uint64_t trail, int depth) {
  const uint32_t index = static_cast<uint32_t>(nodes_.size());
  nodes_.emplace_back();
  if (end - begin == 1) {
    nodes_[index] = {bounds[order[begin]], 1, order[begin]};
    trails_[order[begin]] = trail;
    return index;
  }
  Vec3f low = bounds[order[begin]].Center(), high = low;
  for (size_t i = begin; i < end; ++i) {
    const Vec3f c = bounds[order[i]].Center();
    low = Min(low, c);
    high = Max(high, c);
  }
  const Vec3f extent = high - low;
  Split best;
  for (int axis = 0; axis < 3 && depth < kMaxCostDepth; ++axis) {
    if (!(extent[axis] > 0) || !std::isfinite(extent[axis])) continue;
    std::array<Bucket, kBuckets> buckets, behind;
    for (size_t i = begin; i < end; ++i) {
      const LightBounds& b = bounds[order[i]];
      buckets[BucketOf(b.Center()[axis], low[axis], extent[axis])].Add(b);
    }
    behind[kBuckets - 1] = buckets[kBuckets - 1];
    for (int i = kBuckets - 2; i > 0; --i) {
      behind[i] = buckets[i].lights == 0 ? behind[i + 1] : buckets[i];
      if (buckets[i].lights > 0 && behind[i + 1].lights > 0) {
        behind[i].bounds = Union(buckets[i].bounds, behind[i + 1].bounds);
        behind[i].lights += behind[i + 1].lights;
      }
    }
    Bucket before;
    // Long thin boxes are cut across.
    const double shape = MaxComponent(extent) / extent[axis];
    for (int i = 0; i + 1 < kBuckets; ++i) {
      if (buckets[i].lights > 0) {
        const size_t lights = before.lights + buckets[i].lights;
        before.Add(buckets[i].bounds);
        before.lights = lights;
      }
      if (before.lights == 0 || behind[i + 1].lights == 0) continue;
      const double cost = shape * (Cost(before.bounds) + Cost(behind[i + 1].bounds));
      if (cost < best.cost) best = {axis, i, cost};
    }
  }
  size_t middle = begin + (end - begin) / 2;
  if (best.axis >= 0) {
    const int a = best.axis;
    middle = static_cast<size_t>(
        std::stable_partition(order.begin() + static_cast<std::ptrdiff_t>(begin),
                              order.begin() + static_cast<std::ptrdiff_t>(end),
                              [&](uint32_t light) {
                                return BucketOf(bounds[light].Center()[a], low[a], extent[a]) <=
                                       best.bucket;
                              }) -
        order.begin());
  }
  BuildNode(bounds, order, begin, middle, trail, depth + 1);
  const uint32_t second =
      BuildNode(bounds, order, middle, end, trail | uint64_t{1} << depth, depth + 1);
  nodes_[index] = {Union(nodes_[index + 1].bounds, nodes_[second].bounds),
                   static_cast<uint32_t>(end - begin), second};
  return index;
}

float LightTree::FirstProbability(const Node& first, const Node& second,
                                  const LightReceiver& receiver) const {
  if (selection_ == LightSelection::kUniform)
    return static_cast<float>(first.lights) / static_cast<float>(first.lights + second.lights);
  if (selection_ == LightSelection::kPower)
    return first.bounds.intensity / (first.bounds.intensity + second.bounds.intensity);
  const float a = Importance(first.bounds, receiver), b = Importance(second.bounds, receiver);
  return a + b > 0 ? a / (a + b) : -1;
}

float LightTree::TreeProbability(uint32_t index, const LightReceiver& receiver) const {
  float probability = 1;
  uint64_t trail = trails_[index];
  for (uint32_t node = 0; !nodes_[node].IsLeaf(); trail >>= 1) {
    const uint32_t second = nodes_[node].second_or_light;
    const float p = FirstProbability(nodes_[node + 1], nodes_[second], receiver);
    if (p < 0) return 0;
    probability *= trail & 1 ? 1 - p : p;
    node = trail & 1 ? second : node + 1;
  }
  return probability;
}

float LightTree::Probability(uint32_t index, const LightReceiver& receiver) const {
  if (trails_.size() == 1) return 1;
  const float even = static_cast<float>(kEvenChoices / static_cast<double>(trails_.size()));
  return static_cast<float>(1 - kEvenChoices) * TreeProbability(index, receiver) + even;
}

LightTree::Choice LightTree::Select(const LightReceiver& receiver, double u) const {
  const size_t lights = trails_.size();
  if (lights == 1) return {0, 1, u};
  const double n = static_cast<double>(lights);
  if (u < kEvenChoices) {
    const double at = u / kEvenChoices * n;
    const uint32_t index = static_cast<uint32_t>(std::min(at, n - 1));
    return {index, Probability(index, receiver), at - index};
  }
  u = (u - kEvenChoices) / (1 - kEvenChoices);
  float probability = 1;
  uint32_t node = 0;
  while (!nodes_[node].IsLeaf()) {
    const uint32_t second = nodes_[node].second_or_light;
    const float p = FirstProbability(nodes_[node + 1], nodes_[second], receiver);
    if (p < 0) return {0, 0, u};
    if (u < p) {
      probability *= p;
      u /= p;
      ++node;
    } else {
      probability *= 1 - p;
      u = (u - p) / (1 - double{p});
      node = second;
    }
  }
  const float even = static_cast<float>(kEvenChoices / n);
  return {nodes_[node].second_or_light, static_cast<float>(1 - kEvenChoices) * probability + even,
          u};
}

}  // namespace strata
