#pragma once

#include <absl/status/status.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/allocation.h"
#include "coordinator/estimate.h"
#include "coordinator/film.h"
#include "coordinator/next_round.h"

// A crop rendered under many seeds: planned, merged and estimated as a farm does, in one process.

namespace strata {

/// What renders a job's units.
using RenderUnit = std::function<absl::StatusOr<Partial>(const WorkUnit&)>;

/// How the samples of a trial are spread.
struct Allocation {
  std::string name;
  AllocationKind kind = AllocationKind::kUniform;
  AllocationGoal goal = AllocationGoal::kRelativeError;
  /// Not empty: just these samples of each replicate for each pixel, whatever a pilot would show.
  std::vector<uint32_t> counts;
};

/// The result of one seed. Per channel: index pixel * kColours + colour.
struct Trial {
  std::vector<double> mean;
  std::vector<float> ci95, error_squared;
  std::vector<float> iid_error_squared;  ///< s^2 / n of single samples.
  std::vector<uint32_t> samples;         ///< For each pixel, over all replicates.
  std::vector<uint8_t> flagged;          ///< For each pixel.
};

inline absl::StatusOr<std::unique_ptr<Film>> UnnamedFilm(const JobSpec& spec) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     ("strata-calibration-" + std::to_string(getpid()) + ".film");
  auto film = Film::Create(path, {FilmLayer::kPath, {spec.crop, spec.tile}, LayoutOf(spec)});
  std::error_code ignored;
  std::filesystem::remove(path, ignored);  // The mapping lives on.
  return film;
}

/// Calls `look` after each piece of the round is merged in all tiles.
inline absl::Status RenderRound(
    const RoundPlan& plan, const RenderUnit& render, Film& film,
    const std::function<void()>& look = [] {}) {
  bool more = true;
  for (uint32_t piece = 0; more; ++piece) {
    more = false;
    for (uint32_t tile = 0; tile < plan.grid.Count(); ++tile) {
      const std::optional<WorkUnit> unit = plan.Unit({plan.round, tile, piece});
      if (!unit) continue;
      more = true;
      STRATA_ASSIGN_OR_RETURN(const Partial partial, render(*unit));
      film.Merge(partial, {plan.round, piece + 1});
    }
    if (more) look();
  }
  return absl::OkStatus();
}

inline RoundPlan PlanFirst(const JobSpec& spec, const Allocation& allocation) {
  if (allocation.counts.empty()) return PlanFirstRound(spec);
  const std::vector<uint32_t> none(allocation.counts.size());
  return PlanCounts(0, {spec.crop, spec.tile}, none, allocation.counts);
}

/// What the farm does next, or the same allocation for another goal than the farm's.
inline std::optional<RoundPlan> PlanSecond(const JobSpec& spec, const Allocation& allocation,
                                           const Film& film) {
  if (!allocation.counts.empty() || IsLastRound(spec, 1)) return std::nullopt;
  const PixelStatistics pilot = GatherPixelStatistics(film);
  if (allocation.goal == AllocationGoal::kRelativeError) return PlanNextRound(spec, 1, pilot).plan;
  const auto allocate =
      allocation.kind == AllocationKind::kRing ? AllocateByRing : AllocateByOwnPixel;
  std::vector<uint32_t> ends = allocate(pilot, spec.spp, allocation.goal);
  for (size_t i = 0; i < ends.size(); ++i) ends[i] = std::max(ends[i], pilot.samples[i]);
  return PlanCounts(1, {spec.crop, spec.tile}, pilot.samples, ends);
}

inline Trial TrialOf(const Film& film, const PixelRect& crop) {
  Trial trial;
  for (const PixelEstimate& e : Estimate(GatherEstimateInput(film, crop))) {
    for (int c = 0; c < kColours; ++c) {
      const double error = e.standard_error[c];
      trial.mean.push_back(e.mean[c]);
      trial.ci95.push_back(static_cast<float>(e.ci95[c]));
      trial.error_squared.push_back(static_cast<float>(error * error));
      trial.iid_error_squared.push_back(
          static_cast<float>(e.variance[c] / static_cast<double>(e.samples)));
    }
    trial.samples.push_back(static_cast<uint32_t>(e.samples));
    trial.flagged.push_back(e.flags != 0);
  }
  return trial;
}

/// `render` must be for `spec`, whose own allocation does not count.
inline absl::StatusOr<Trial> RenderTrial(JobSpec spec, const Allocation& allocation,
                                         const RenderUnit& render) {
  spec.allocation = allocation.kind;
  STRATA_ASSIGN_OR_RETURN(const auto film, UnnamedFilm(spec));
  STRATA_RETURN_IF_ERROR(RenderRound(PlanFirst(spec, allocation), render, *film));
  if (const auto plan = PlanSecond(spec, allocation, *film)) {
    STRATA_RETURN_IF_ERROR(RenderRound(*plan, render, *film));
  }
  return TrialOf(*film, spec.crop);
}

/// The control of controls: samples that are normal, with mean and standard deviation 1.
inline Partial NormalPartial(const JobSpec& spec, const WorkUnit& unit) {
  std::seed_seq key{static_cast<uint32_t>(spec.seed), unit.id.round, unit.id.tile, unit.id.piece};
  std::mt19937_64 random(key);
  std::normal_distribution<double> normal;
  Partial partial{unit.id, unit.pixels, LayoutOf(spec)};
  const size_t doubles = static_cast<size_t>(partial.layout.Doubles());
  const int64_t pixels = unit.pixels.Pixels();
  partial.values.resize(static_cast<size_t>(pixels) * doubles);
  partial.nonfinite.resize(static_cast<size_t>(pixels));
  for (int64_t p = 0; p < pixels; ++p) {
    const double n = unit.RangeOf(p).Count();
    partial.samples.push_back(unit.RangeOf(p).Count());
    partial.rays.push_back(uint64_t{kReplicates} * unit.RangeOf(p).Count());
    if (n == 0) continue;
    double* values = &partial.values[static_cast<size_t>(p) * doubles];
    for (int c = 0; c < kColours; ++c) {
      for (int r = 0; r < kReplicates; ++r) {
        values[partial.layout.Mean(r, c)] = 1 + normal(random) / std::sqrt(n);
      }
      values[partial.layout.M2(c)] = kReplicates * n - 1;
    }
  }
  return partial;
}

}  // namespace strata
