#include "coordinator/next_round.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "coordinator/allocation.h"
#include "coordinator/error_target.h"

namespace strata {
namespace {

/// Samples of the pilot of a target, over all replicates: enough to see the variance of most
/// pixels, and little beside what a target usually takes.
constexpr uint32_t kTargetPilot = 32;
/// With a deadline the first round always ends, so it has one sample of each replicate.
constexpr uint32_t kTimePilot = kReplicates;

using Counts = std::vector<uint32_t>;

TileGrid GridOf(const JobSpec& spec) { return {spec.crop, spec.tile}; }

PlaneSize SizeOf(const JobSpec& spec) {
  return {static_cast<size_t>(spec.crop.Width()), static_cast<size_t>(spec.crop.Height())};
}

/// Over all replicates.
uint32_t PilotOf(const JobSpec& spec) {
  switch (spec.target) {
    case TargetKind::kRelativeError:
    case TargetKind::kRmse:
      return std::min(spec.spp, kTargetPilot);
    case TargetKind::kTime:
      return std::min(spec.spp, kTimePilot);
    case TargetKind::kSamples:
      break;
  }
  return spec.allocation == AllocationKind::kUniform ? spec.spp
                                                     : PilotSamples(SizeOf(spec), spec.spp);
}

double SamplesIn(const Counts& counts) {
  return kReplicates * std::accumulate(counts.begin(), counts.end(), 0.0);
}

/// The rays it takes to get from what there is to `ends`.
double RaysTo(const Counts& ends, const PixelStatistics& now) {
  double rays = 0;
  for (size_t i = 0; i < ends.size(); ++i) {
    rays += kReplicates * static_cast<double>(ends[i] - now.samples[i]) * now.rays[i];
  }
  return rays;
}

/// For each pixel the samples of each replicate in all for an average of `spp`; at least what there
/// is.
Counts Spread(const JobSpec& spec, const PixelStatistics& now, uint32_t spp) {
  Counts ends;
  switch (spec.allocation) {
    case AllocationKind::kUniform:
      ends.assign(now.samples.size(), spp / kReplicates);
      break;
    case AllocationKind::kRing:
      ends = AllocateByRing(now, spp);
      break;
    case AllocationKind::kGreedy:
      ends = AllocateByOwnPixel(now, spp);
      break;
  }
  for (size_t i = 0; i < ends.size(); ++i) ends[i] = std::max(ends[i], now.samples[i]);
  return ends;
}

/// Nothing when no pixel gets more than it has.
std::optional<RoundPlan> PlanTo(const JobSpec& spec, uint32_t round, const PixelStatistics& now,
                                const Counts& ends) {
  if (ends == now.samples) return std::nullopt;
  return PlanCounts(round, GridOf(spec), now.samples, ends);
}

/// What a target takes when every pixel gets the same: squared errors fall at least as 1/n. All
/// pixels have their share in it, each in its own count too.
TargetRound UniformTarget(const JobSpec& spec, const PixelStatistics& now, TargetRound target) {
  const double have = now.samples.front();
  const double excess = target.error / spec.target_value;
  const double wanted = std::ceil(have * std::max(excess * excess, 1.0));
  const double most = std::max<double>(have, spec.spp / kReplicates);
  const uint32_t end = static_cast<uint32_t>(std::min(wanted, most));
  target.ends.assign(now.samples.size(), end);
  const double all = SamplesIn(target.ends);
  target.added_deviation = have < end && wanted < most ? target.square_deviation * all : 0;
  return target;
}

NextRound NextForError(const JobSpec& spec, uint32_t round, const PixelStatistics& now) {
  TargetRound target = spec.target == TargetKind::kRelativeError
                           ? PlanForRelativeError(now, spec.target_value, spec.spp)
                           : PlanForRmse(now, spec.target_value, spec.spp);
  if (spec.allocation == AllocationKind::kUniform)
    target = UniformTarget(spec, now, std::move(target));
  NextRound next;
  next.target_met = target.met;
  next.target_share = target.met_share;
  // Nothing when no pixel is to get more, met or not: see error_target.h.
  next.plan = PlanTo(spec, round, now, target.ends);
  next.samples_left = SamplesIn(target.ends) - SamplesIn(now.samples);
  next.deviation = target.added_deviation;
  return next;
}

/// A round for a part of the time left, so that a deadline that comes earlier than expected costs
/// little; the next one takes the same part of what is left then. How much that is follows the
/// clock and the rays of the whole image, which each pixel has its share in.
NextRound NextForTime(const JobSpec& spec, uint32_t round, const PixelStatistics& now,
                      const TimeLeft& left) {
  constexpr double kPartOfTime = 0.7;
  constexpr double kMostGrowth = 4;           // The floor of a ring allocation is a quarter.
  constexpr double kLeastGrowth = 17.0 / 16;  // Less is not worth another barrier.
  const double pixels = static_cast<double>(now.samples.size());
  const double have = SamplesIn(now.samples) / pixels;
  const double rays = std::accumulate(now.rays.begin(), now.rays.end(), 0.0);
  const double budget = kPartOfTime * left.seconds * left.rays_per_second;

  NextRound next;
  next.target_met = true;
  if (!(left.seconds > 0)) return next;
  double wanted = std::min(have + budget / std::max(rays, 1.0), kMostGrowth * have);
  // Once more, since a sample where the error is costs other than the mean one.
  for (int attempt = 0; attempt < 2; ++attempt) {
    const double average = std::min<double>(wanted, spec.spp);
    if (!(average >= kLeastGrowth * have)) return next;
    const uint32_t spp = static_cast<uint32_t>(average / kReplicates) * kReplicates;
    const Counts ends = Spread(spec, now, spp);
    const double needed = RaysTo(ends, now);
    if (attempt == 1 || needed <= budget) {
      next.plan = PlanTo(spec, round, now, ends);
      next.samples_left = SamplesIn(ends) - SamplesIn(now.samples);
      return next;
    }
    wanted = have + (average - have) * (budget / needed);
  }
  return next;
}

}  // namespace

RoundPlan PlanFirstRound(const JobSpec& spec) {
  const SampleRange range{0, PilotOf(spec) / kReplicates};
  return {0, GridOf(spec), {{range, CutPieces(range)}}, {}};
}

bool IsLastRound(const JobSpec& spec, uint32_t finished) {
  // The pilot alone decides where samples go.
  return spec.target == TargetKind::kSamples && (finished > 1 || PilotOf(spec) == spec.spp);
}

NextRound PlanNextRound(const JobSpec& spec, uint32_t finished, const PixelStatistics& now,
                        const TimeLeft& left) {
  if (spec.target == TargetKind::kTime) return NextForTime(spec, finished, now, left);
  if (spec.target != TargetKind::kSamples) return NextForError(spec, finished, now);
  NextRound next;
  next.target_met = true;
  if (IsLastRound(spec, finished)) return next;
  const Counts ends = Spread(spec, now, spec.spp);
  next.plan = PlanTo(spec, finished, now, ends);
  next.samples_left = SamplesIn(ends) - SamplesIn(now.samples);
  return next;
}

}  // namespace strata
