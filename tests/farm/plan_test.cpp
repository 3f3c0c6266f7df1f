// Round plans: every sample once, the same cuts for any tiles, a durable form that shows damage.

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "coordinator/next_round.h"
#include "coordinator/round_plan.h"
#include "coordinator/round_plan_format.h"
#include "coordinator/unit_queue.h"
#include "tests/farm/fake_renderer.h"

namespace strata {
namespace {

JobSpec CropSpec(int tile) {
  JobSpec spec;
  spec.width = 100;
  spec.height = 80;
  spec.crop = {3, 5, 57, 46};
  spec.tile = tile;
  spec.spp = 8 * 75;
  return spec;
}

/// A plan whose counts differ from pixel to pixel, as allocation makes them.
RoundPlan UnevenPlan(int tile) {
  const JobSpec spec = CropSpec(tile);
  const size_t pixels = static_cast<size_t>(spec.crop.Pixels());
  std::vector<uint32_t> begins(pixels), ends(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    begins[i] = 32;
    ends[i] = 32 + static_cast<uint32_t>(200 * FakeUniform(3, static_cast<int>(i), 0, 0, 0, 0));
  }
  return PlanCounts(1, {spec.crop, tile}, begins, ends);
}

/// For each pixel its pieces in the order of the units.
std::map<std::pair<int, int>, std::vector<std::pair<uint32_t, uint32_t>>> PiecesOf(
    const RoundPlan& plan) {
  std::map<std::pair<int, int>, std::vector<std::pair<uint32_t, uint32_t>>> pieces;
  uint64_t units = 0;
  for (uint32_t tile = 0; tile < plan.grid.Count(); ++tile) {
    for (uint32_t k = 0; k < plan.Pieces(tile); ++k, ++units) {
      const WorkUnit unit = *plan.Unit({plan.round, tile, k});
      int64_t i = 0;
      for (int y = unit.pixels.y0; y < unit.pixels.y1; ++y) {
        for (int x = unit.pixels.x0; x < unit.pixels.x1; ++x, ++i) {
          const SampleRange range = unit.RangeOf(i);
          if (range.Count() > 0) pieces[{x, y}].emplace_back(range.begin, range.end);
        }
      }
    }
  }
  EXPECT_EQ(units, plan.Units());
  return pieces;
}

class AnyPlan : public ::testing::TestWithParam<bool> {
 protected:
  static RoundPlan Plan(int tile) {
    return GetParam() ? UnevenPlan(tile) : PlanFirstRound(CropSpec(tile));
  }
};
INSTANTIATE_TEST_SUITE_P(UniformAndUneven, AnyPlan, ::testing::Bool());

TEST_P(AnyPlan, CoversEverySampleOnceInOrder) {
  const RoundPlan plan = Plan(16);
  ASSERT_TRUE(CheckRoundPlan(plan).ok());
  uint64_t samples = 0;
  const auto pieces = PiecesOf(plan);
  for (int y = plan.grid.crop.y0; y < plan.grid.crop.y1; ++y) {
    for (int x = plan.grid.crop.x0; x < plan.grid.crop.x1; ++x) {
      const SampleRange range = plan.ClassOf(x, y).range;
      uint32_t next = range.begin;
      if (const auto entry = pieces.find({x, y}); entry != pieces.end()) {
        for (const auto& [begin, end] : entry->second) {
          EXPECT_EQ(begin, next);
          EXPECT_LE(end - begin, LongestPiece(range));
          next = end;
        }
      }
      EXPECT_EQ(next, range.end);
      samples += uint64_t{kReplicates} * range.Count();
    }
  }
  EXPECT_EQ(samples, plan.Samples());
}

TEST_P(AnyPlan, CutsAPixelTheSameForAnyTiles) {
  const auto expected = PiecesOf(Plan(16));
  for (const int tile : {8, 32, 64}) EXPECT_EQ(PiecesOf(Plan(tile)), expected);
}

TEST_P(AnyPlan, IsReadAsItWasWritten) {
  const RoundPlan plan = Plan(32);
  const auto read = DecodeRoundPlan(EncodeRoundPlan(plan));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(*read, plan);
}

TEST_P(AnyPlan, ShowsEveryDamage) {
  const std::string bytes = EncodeRoundPlan(Plan(32));
  const size_t stride = std::max<size_t>(1, bytes.size() / 500);
  for (size_t i = 0; i < bytes.size(); i += stride) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_EQ(DecodeRoundPlan(damaged).status().code(), absl::StatusCode::kDataLoss) << i;
    EXPECT_EQ(DecodeRoundPlan(bytes.substr(0, i)).status().code(), absl::StatusCode::kDataLoss);
  }
  EXPECT_FALSE(DecodeRoundPlan(bytes + "x").ok());
}

TEST(RoundPlanTest, HasNoUnitsBeyondItself) {
  const RoundPlan plan = PlanFirstRound(CropSpec(16));
  EXPECT_TRUE(plan.Unit({0, 0, 0}).has_value());
  EXPECT_FALSE(plan.Unit({1, 0, 0}).has_value());
  EXPECT_FALSE(plan.Unit({0, plan.grid.Count(), 0}).has_value());
  EXPECT_FALSE(plan.Unit({0, 0, plan.Pieces(0)}).has_value());
}

TEST(RoundPlanTest, IsRefusedWhenItsPiecesDoNotFit) {
  RoundPlan plan = PlanFirstRound(CropSpec(16));
  plan.classes[0].pieces.pop_back();
  EXPECT_FALSE(CheckRoundPlan(plan).ok());
  plan = UnevenPlan(16);
  plan.class_of[7] = static_cast<uint32_t>(plan.classes.size());
  EXPECT_FALSE(CheckRoundPlan(plan).ok());
  EXPECT_FALSE(DecodeRoundPlan(EncodeRoundPlan(plan)).ok());
}

// ---- the queue over a plan ----

TEST_P(AnyPlan, IsQueuedWithinTheWindowAndWhole) {
  const auto plan = std::make_shared<const RoundPlan>(Plan(16));
  constexpr uint32_t kWindow = 3;
  UnitQueue queue(plan, kWindow);
  EXPECT_EQ(queue.Pending(), plan->Units());
  std::vector<uint32_t> front(plan->grid.Count());
  std::vector<UnitId> out;
  uint64_t received = 0;
  const auto any = [](const UnitId&) { return true; };
  while (received < plan->Units()) {
    while (const std::optional<UnitId> unit = queue.Next(any)) {
      EXPECT_LT(unit->piece - front[unit->tile], kWindow);
      queue.Take(*unit);
      out.push_back(*unit);
      // Every third comes back and is given out again.
      if (out.size() % 3 == 0)
        queue.Return(*unit), out.pop_back(), queue.Take(*queue.Next(any)), out.push_back(*unit);
    }
    // The oldest in hand is the next of its tile.
    ASSERT_FALSE(out.empty());
    const UnitId unit = out.front();
    out.erase(out.begin());
    EXPECT_EQ(unit.piece, front[unit.tile]);
    queue.Received(unit, ++front[unit.tile]);
    ++received;
  }
  EXPECT_EQ(queue.Pending(), 0u);
  EXPECT_FALSE(queue.HasReady());
}

}  // namespace
}  // namespace strata
