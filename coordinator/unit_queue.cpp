#include "coordinator/unit_queue.h"

#include <algorithm>

namespace strata {

UnitQueue::UnitQueue(std::shared_ptr<const RoundPlan> plan, uint32_t window)
    : plan_(std::move(plan)), tiles_(plan_->grid.Count()), window_(window) {
  for (uint32_t t = 0; t < tiles_.size(); ++t) {
    tiles_[t].pieces = plan_->Pieces(t);
    pending_ += tiles_[t].pieces;
    Offer(t);
  }
}

void UnitQueue::Offer(uint32_t index) {
  if (Offers(tiles_[index])) ready_.insert({tiles_[index].fresh, index});
}

void UnitQueue::WidenWindow(uint32_t window) {
  if (window <= window_) return;
  window_ = window;
  for (uint32_t t = 0; t < tiles_.size(); ++t) Offer(t);
}

std::optional<UnitId> UnitQueue::Next(const std::function<bool(const UnitId&)>& accept) const {
  for (const auto& [piece, tile] : ready_) {
    const UnitId unit{plan_->round, tile, piece};
    if (accept(unit)) return unit;
  }
  return std::nullopt;
}

void UnitQueue::Take(const UnitId& unit) {
  if (ready_.erase({unit.piece, unit.tile}) == 0) return;
  --pending_;
  Tile& tile = tiles_[unit.tile];
  if (unit.piece != tile.fresh) return;
  ++tile.fresh;
  Offer(unit.tile);
}

void UnitQueue::Return(const UnitId& unit) {
  if (unit.piece < tiles_[unit.tile].front) return;
  if (ready_.insert({unit.piece, unit.tile}).second) ++pending_;
}

void UnitQueue::Received(const UnitId& unit, uint32_t front) {
  Take(unit);  // It may have been given back before it came.
  Tile& tile = tiles_[unit.tile];
  tile.front = std::max(tile.front, front);
  // A unit may come that this queue never gave out: one leased before a restart.
  for (; tile.fresh < tile.front; ++tile.fresh) {
    ready_.erase({tile.fresh, unit.tile});
    --pending_;
  }
  Offer(unit.tile);
}

}  // namespace strata
