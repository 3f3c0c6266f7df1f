#pragma once

#include <algorithm>
#include <cstdint>

#include "common/job.h"

namespace strata {

/// The tiles of a crop, row-major from its upper left corner. Tiles at the right and lower edges
/// may be smaller. Nothing in a result depends on the tile size.
struct TileGrid {
  PixelRect crop;
  int tile = 0;  ///< Edge in pixels.

  uint32_t Columns() const { return static_cast<uint32_t>((crop.Width() + tile - 1) / tile); }
  uint32_t Rows() const { return static_cast<uint32_t>((crop.Height() + tile - 1) / tile); }
  uint32_t Count() const { return Columns() * Rows(); }

  /// Requires index < Count(). In frame coordinates.
  PixelRect Rect(uint32_t index) const {
    const int x0 = crop.x0 + static_cast<int>(index % Columns()) * tile;
    const int y0 = crop.y0 + static_cast<int>(index / Columns()) * tile;
    return {x0, y0, std::min(x0 + tile, crop.x1), std::min(y0 + tile, crop.y1)};
  }

  /// The tile that holds a pixel of the crop.
  uint32_t IndexOf(int x, int y) const {
    return static_cast<uint32_t>((y - crop.y0) / tile) * Columns() +
           static_cast<uint32_t>((x - crop.x0) / tile);
  }

  bool operator==(const TileGrid&) const = default;
};

}  // namespace strata
