#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "common/digest.h"
#include "common/pixel_layout.h"
#include "common/status.h"
#include "common/unit.h"
#include "coordinator/tile_grid.h"

namespace strata {

/// What a film adds up. A job's picture is the sum of its layers, one film each.
enum class FilmLayer : uint32_t {
  kPath = 1,  ///< Camera paths, tile by tile.
};

struct FilmGeometry {
  FilmLayer layer = FilmLayer::kPath;
  TileGrid grid;
  PixelLayout layout;
  bool operator==(const FilmGeometry&) const = default;
};

/// What a film counts for a pixel.
struct PixelCounts {
  uint64_t rays = 0;
  uint32_t samples = 0;    ///< Of each replicate.
  uint32_t nonfinite = 0;  ///< Over all replicates.
};

struct FilmPixel {
  const PixelCounts* counts;
  const double* values;  ///< layout.Doubles() numbers.
};

/// The next unit of a tile in plan order: all before it are merged.
struct MergeFront {
  uint32_t round = 0;
  uint32_t piece = 0;
  auto operator<=>(const MergeFront&) const = default;
};

/// All merged samples of one layer of a job, in one tile-addressed memory-mapped file, so that idle
/// jobs leave memory; docs/film-format.md describes it. Not thread-safe: one writer, or readers.
class Film {
 public:
  /// Makes the file anew, with its space reserved, so that a full disk shows here.
  /// RESOURCE_EXHAUSTED when there is no space, UNAVAILABLE for other failures of the file system.
  static absl::StatusOr<std::unique_ptr<Film>> Create(const std::filesystem::path& path,
                                                      const FilmGeometry& geometry);
  /// DATA_LOSS when the file is damaged or of another version.
  static absl::StatusOr<std::unique_ptr<Film>> Open(const std::filesystem::path& path);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  const FilmGeometry& geometry() const { return geometry_; }

  /// A pixel of the crop, in frame coordinates.
  FilmPixel At(int x, int y) const;
  MergeFront Front(uint32_t tile) const;

  /// Adds what CheckPartial found in order to its tile and moves the tile's front. The order of the
  /// calls for a tile decides the bits; OrderedMerge keeps it.
  void Merge(const Partial& partial, MergeFront next);

  /// Over the counts, means and moments of all pixels, row-major over the crop: the same for any
  /// tile size. Uses all cores, since hashing a 4K frame takes seconds on one.
  Digest ResultDigest() const;

 private:
  Film(std::byte* data, size_t bytes, const FilmGeometry& geometry);
  std::byte* TileRecord(uint32_t tile) const;
  std::byte* PixelRecord(uint32_t tile, int64_t pixel) const;
  Digest RowDigest(int y) const;

  std::byte* data_;
  size_t bytes_;
  FilmGeometry geometry_;
  size_t pixel_bytes_, tile_bytes_;
};

}  // namespace strata
