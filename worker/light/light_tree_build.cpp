#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "worker/light/light_tree.h"
#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

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

  /// Up to `most` groups: the largest is cut until there are so many.
  std::vector<Range> Cut(Range range, size_t most, bool evenly) {
    std::vector<Range> parts = {range};
    while (parts.size() < most) {
      const auto largest = std::max_element(parts.begin(), parts.end(),
                                            [](Range a, Range b) { return a.Count() < b.Count(); });
      if (largest->Count() < 2) break;
      const auto [first, second] = Split(*largest, evenly);
      *largest = first;
      parts.push_back(second);
    }
    return parts;
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

LightTree LightTree::Build(const std::vector<LightBounds>& bounds) {
  LightTree tree;
  tree.lights_ = bounds.size();
  tree.trails_.resize(bounds.size());
  Sorter sorter(bounds);
  struct Open {
    Range range;
    uint32_t node;
    int depth;
    uint64_t trail;
  };
  // The root counts for two levels. Below this one groups are cut evenly, whatever it costs, so
  // that trails fit their words.
  constexpr int kMaxCostDepth = 16;
  std::vector<Open> open = {{{0, bounds.size()}, 0, 0, 0}};
  while (!open.empty()) {
    const Open now = open.back();
    open.pop_back();
    const bool root = now.depth == 0;
    const std::vector<Range> parts =
        sorter.Cut(now.range, root ? kRootPlaces : 4, now.depth >= kMaxCostDepth);
    if (root) {
      tree.root_places_ = static_cast<int>(parts.size());
      tree.nodes_.resize((parts.size() + 3) / 4);
    }
    for (size_t part = 0; part < parts.size(); ++part) {
      const size_t place = 4 * now.node + part;
      const uint64_t trail = now.trail | uint64_t{part} << (2 * now.depth);
      const uint32_t count = static_cast<uint32_t>(parts[part].Count());
      uint32_t child;
      if (count == 1) {
        child = sorter.Light(parts[part].begin);
        tree.trails_[child] = trail;
      } else {
        child = static_cast<uint32_t>(tree.nodes_.size());
        tree.nodes_.emplace_back();
        open.push_back({parts[part], child, now.depth + (root ? 2 : 1), trail});
      }
      Node& node = tree.nodes_[place / 4];
      node.child[place % 4] = child;
      if (root) tree.root_children_[part] = static_cast<int32_t>(count == 1 ? child : ~child);
      node.group.Set(static_cast<int>(place % 4), sorter.BoundsOf(parts[part]), count);
    }
  }
  return tree;
}

}  // namespace strata
