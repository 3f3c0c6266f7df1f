#include "coordinator/ordered_merge.h"

#include <utility>

namespace strata {

OrderedMerge::OrderedMerge(Film& film, std::shared_ptr<const RoundPlan> plan)
    : film_(film), plan_(std::move(plan)), tiles_(plan_->grid.Count()) {
  for (uint32_t t = 0; t < tiles_.size(); ++t) {
    const MergeFront front = film.Front(t);
    if (front.round == plan_->round) tiles_[t].front = front.piece;
  }
}

OrderedMerge::Result OrderedMerge::Add(Partial partial, uint32_t window) {
  // Of a round before this one, which is wholly merged.
  if (partial.unit.round != plan_->round) return {Outcome::kKnown, 0, {}};
  Tile& tile = tiles_[partial.unit.tile];
  const uint32_t piece = partial.unit.piece;
  if (piece < tile.front || tile.waiting.contains(piece)) {
    return {Outcome::kKnown, tile.front, {}};
  }
  if (piece - tile.front >= window) return {Outcome::kTooEarly, tile.front, {}};
  if (piece > tile.front) {
    tile.waiting.emplace(piece, std::move(partial));
    ++waiting_count_;
    return {Outcome::kWaiting, tile.front, {}};
  }
  Result result{Outcome::kMerged, 0, {}};
  Merge(tile, partial, result.merged);
  for (auto next = tile.waiting.find(tile.front); next != tile.waiting.end();
       next = tile.waiting.find(tile.front)) {
    Merge(tile, next->second, result.merged);
    tile.waiting.erase(next);
    --waiting_count_;
  }
  result.front = tile.front;
  return result;
}

void OrderedMerge::Merge(Tile& tile, const Partial& partial, MergedCounts& merged) {
  ++tile.front;
  film_.Merge(partial, {plan_->round, tile.front});
  ++merged.units;
  for (size_t i = 0; i < partial.samples.size(); ++i) {
    merged.samples += uint64_t{kReplicates} * partial.samples[i];
    merged.rays += partial.rays[i];
    merged.nonfinite += partial.nonfinite[i];
  }
}

}  // namespace strata
