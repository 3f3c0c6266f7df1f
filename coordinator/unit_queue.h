#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "coordinator/round_plan.h"

namespace strata {

/// The units of a round that may be leased now, in the order they should be: the first pieces of
/// all tiles, then the second ones, so that an early picture is whole. A tile offers pieces within
/// a window of its merge front only, so that partials that wait for others stay few.
class UnitQueue {
 public:
  UnitQueue(std::shared_ptr<const RoundPlan> plan, uint32_t window);

  uint32_t window() const { return window_; }
  /// A window never shrinks.
  void WidenWindow(uint32_t window);

  /// The first unit that may be leased and that `accept` says yes to, without taking it.
  std::optional<UnitId> Next(const std::function<bool(const UnitId&)>& accept) const;
  /// Takes what Next returned.
  void Take(const UnitId& unit);
  /// Gives back a unit that was taken and not received.
  void Return(const UnitId& unit);
  /// The unit has been received; `front` is its tile's next piece to merge.
  void Received(const UnitId& unit, uint32_t front);

  /// Units that are not leased now and not received, within the window or not.
  uint64_t Pending() const { return pending_; }
  bool HasReady() const { return !ready_.empty(); }

 private:
  using Key = std::pair<uint32_t, uint32_t>;  ///< Piece, tile.
  struct Tile {
    uint32_t pieces = 0, front = 0;
    uint32_t fresh = 0;  ///< The first piece that was never taken.
  };
  bool Offers(const Tile& tile) const {
    return tile.fresh < tile.pieces && tile.fresh - tile.front < window_;
  }
  void Offer(uint32_t index);

  std::shared_ptr<const RoundPlan> plan_;
  std::vector<Tile> tiles_;
  std::set<Key> ready_;
  uint32_t window_;
  uint64_t pending_ = 0;
};

}  // namespace strata
