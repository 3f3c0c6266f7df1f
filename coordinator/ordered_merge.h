#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "coordinator/film.h"
#include "coordinator/round_plan.h"

namespace strata {

/// Sums over partials that were merged.
struct MergedCounts {
  uint64_t units = 0, samples = 0, rays = 0, nonfinite = 0;
};

/// Merges the units of a round into a film, for each tile in plan order: a partial that arrives
/// early waits, one that arrives again is dropped, as its bits are the same. Not thread-safe.
class OrderedMerge {
 public:
  OrderedMerge(Film& film, std::shared_ptr<const RoundPlan> plan);

  enum class Outcome {
    kMerged,   ///< It, and those that waited for it, are in the film.
    kWaiting,  ///< Kept until those before it have come.
    kKnown,    ///< Merged or waiting already; dropped.
    kTooEarly  ///< Too far ahead of its tile's front to wait; dropped, to be rendered again.
  };
  struct Result {
    Outcome outcome;
    uint32_t front = 0;  ///< The next piece of the tile.
    MergedCounts merged;
  };

  /// Requires a partial that CheckPartial accepted for a unit of the plan. Those `window` or more
  /// pieces ahead of the front are not kept.
  Result Add(Partial partial, uint32_t window);

  /// Partials that wait now, over all tiles.
  size_t Waiting() const { return waiting_count_; }

 private:
  struct Tile {
    uint32_t front = 0;
    std::map<uint32_t, Partial> waiting;  ///< By piece.
  };
  void Merge(Tile& tile, const Partial& partial, MergedCounts& merged);

  Film& film_;
  std::shared_ptr<const RoundPlan> plan_;
  std::vector<Tile> tiles_;
  size_t waiting_count_ = 0;
};

}  // namespace strata
