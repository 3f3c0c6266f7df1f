#include "coordinator/round_plan.h"

#include <absl/container/flat_hash_map.h>
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace strata {
namespace {

SampleClass CutClass(SampleRange range) { return {range, CutPieces(range)}; }

/// Calls visit(class index) for each pixel of a rectangle of the crop, row-major.
template <typename Visit>
void ForEachPixel(const RoundPlan& plan, const PixelRect& rect, Visit visit) {
  const PixelRect& crop = plan.grid.crop;
  for (int y = rect.y0; y < rect.y1; ++y) {
    const size_t row = static_cast<size_t>(y - crop.y0) * static_cast<size_t>(crop.Width());
    for (int x = rect.x0; x < rect.x1; ++x) {
      visit(plan.class_of[row + static_cast<size_t>(x - crop.x0)]);
    }
  }
}

absl::Status CheckClass(const SampleClass& sample_class) {
  uint32_t next = sample_class.range.begin;
  for (const SampleRange& piece : sample_class.pieces) {
    if (piece.begin != next || piece.end <= piece.begin) {
      return absl::InternalError("round plan: the pieces of a class are not adjacent");
    }
    next = piece.end;
  }
  if (next != sample_class.range.end) {
    return absl::InternalError("round plan: the pieces of a class do not cover its range");
  }
  return absl::OkStatus();
}

}  // namespace

const SampleClass& RoundPlan::ClassOf(int x, int y) const {
  if (class_of.empty()) return classes.front();
  const size_t pixel =
      static_cast<size_t>(y - grid.crop.y0) * grid.crop.Width() + (x - grid.crop.x0);
  return classes[class_of[pixel]];
}

uint32_t RoundPlan::Pieces(uint32_t tile) const {
  if (class_of.empty()) return static_cast<uint32_t>(classes.front().pieces.size());
  size_t most = 0;
  ForEachPixel(*this, grid.Rect(tile),
               [&](uint32_t c) { most = std::max(most, classes[c].pieces.size()); });
  return static_cast<uint32_t>(most);
}

uint64_t RoundPlan::Units() const {
  uint64_t units = 0;
  for (uint32_t tile = 0; tile < grid.Count(); ++tile) units += Pieces(tile);
  return units;
}

uint64_t RoundPlan::Samples() const {
  if (class_of.empty()) {
    return static_cast<uint64_t>(grid.crop.Pixels()) * kReplicates * classes.front().range.Count();
  }
  uint64_t samples = 0;
  for (const uint32_t c : class_of) samples += uint64_t{kReplicates} * classes[c].range.Count();
  return samples;
}

std::optional<WorkUnit> RoundPlan::Unit(const UnitId& id) const {
  if (id.round != round || id.tile >= grid.Count() || id.piece >= Pieces(id.tile)) {
    return std::nullopt;
  }
  WorkUnit unit{id, grid.Rect(id.tile), {}};
  if (class_of.empty()) {
    unit.ranges.push_back(classes.front().pieces[id.piece]);
    return unit;
  }
  unit.ranges.reserve(static_cast<size_t>(unit.pixels.Pixels()));
  ForEachPixel(*this, unit.pixels, [&](uint32_t c) {
    const std::vector<SampleRange>& pieces = classes[c].pieces;
    const uint32_t end = classes[c].range.end;
    unit.ranges.push_back(id.piece < pieces.size() ? pieces[id.piece] : SampleRange{end, end});
  });
  return unit;
}

uint64_t SamplesIn(const WorkUnit& unit) {
  uint64_t samples = 0;
  for (const SampleRange& range : unit.ranges) samples += uint64_t{kReplicates} * range.Count();
  return unit.ranges.size() == 1 ? samples * static_cast<uint64_t>(unit.pixels.Pixels()) : samples;
}

absl::Status CheckRoundPlan(const RoundPlan& plan) {
  const PixelRect& crop = plan.grid.crop;
  if (plan.grid.tile < 1 || crop.x0 < 0 || crop.y0 < 0 || crop.x1 <= crop.x0 ||
      crop.y1 <= crop.y0) {
    return absl::InternalError("round plan: its tiles are not a grid");
  }
  if (plan.classes.empty()) return absl::InternalError("round plan: it has no class of pixels");
  for (const SampleClass& sample_class : plan.classes) {
    STRATA_RETURN_IF_ERROR(CheckClass(sample_class));
  }
  if (plan.class_of.empty()) return absl::OkStatus();
  if (plan.class_of.size() != static_cast<size_t>(crop.Pixels())) {
    return absl::InternalError(
        fmt::format("round plan: {} classes for {} pixels", plan.class_of.size(), crop.Pixels()));
  }
  const uint32_t highest = *std::max_element(plan.class_of.begin(), plan.class_of.end());
  if (highest >= plan.classes.size()) {
    return absl::InternalError("round plan: a pixel's class does not exist");
  }
  return absl::OkStatus();
}

RoundPlan PlanCounts(uint32_t round, const TileGrid& grid, const std::vector<uint32_t>& begins,
                     const std::vector<uint32_t>& ends) {
  RoundPlan plan{round, grid, {}, {}};
  plan.class_of.reserve(begins.size());
  absl::flat_hash_map<std::pair<uint32_t, uint32_t>, uint32_t> known;
  for (size_t i = 0; i < begins.size(); ++i) {
    const auto [entry, is_new] =
        known.try_emplace({begins[i], ends[i]}, static_cast<uint32_t>(plan.classes.size()));
    if (is_new) plan.classes.push_back(CutClass({begins[i], ends[i]}));
    plan.class_of.push_back(entry->second);
  }
  if (plan.classes.size() == 1) plan.class_of.clear();
  return plan;
}

}  // namespace strata
