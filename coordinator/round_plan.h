#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/status.h"
#include "common/unit.h"
#include "coordinator/tile_grid.h"

namespace strata {

/// Pixels of a round that get the same samples of each replicate, and how these are cut.
struct SampleClass {
  SampleRange range;
  std::vector<SampleRange> pieces;  ///< Adjacent, in order, cover `range` exactly; none is empty.
  bool operator==(const SampleClass&) const = default;
};

/// One round of a job (design, section 2): which samples every pixel gets, and the work units they
/// are cut into. Unit (round, tile, k) holds the k-th piece of each pixel of the tile; a pixel with
/// fewer pieces has an empty range there. So how a pixel's samples are cut, and the order in which
/// its pieces merge, depends on its class alone. Immutable once made; saved before the first lease.
struct RoundPlan {
  uint32_t round = 0;
  TileGrid grid;
  std::vector<SampleClass> classes;  ///< At least one.
  /// The class of each pixel of the crop, row-major; empty: all pixels are of class 0.
  std::vector<uint32_t> class_of;

  const SampleClass& ClassOf(int x, int y) const;
  /// The number of units of a tile: the most pieces any of its pixels has.
  uint32_t Pieces(uint32_t tile) const;
  uint64_t Units() const;
  /// Over all pixels and replicates.
  uint64_t Samples() const;
  /// Nothing when the plan has no such unit.
  std::optional<WorkUnit> Unit(const UnitId& id) const;

  bool operator==(const RoundPlan&) const = default;
};

/// The samples of all pixels and replicates in a unit.
uint64_t SamplesIn(const WorkUnit& unit);

/// INTERNAL with the reason when the rules above are broken.
absl::Status CheckRoundPlan(const RoundPlan& plan);

/// A plan that gives each pixel of the crop the samples [begins[i], ends[i]) of each replicate,
/// row-major. Requires vectors of the crop's size with begins[i] <= ends[i].
RoundPlan PlanCounts(uint32_t round, const TileGrid& grid, const std::vector<uint32_t>& begins,
                     const std::vector<uint32_t>& ends);

}  // namespace strata
