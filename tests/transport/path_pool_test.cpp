#include <gtest/gtest.h>

#include <deque>

#include "tests/statistics/random.h"
#include "worker/integrator/path_pool.h"

// Where the fast kernel's paths are kept and wait, against plain containers.

namespace strata {
namespace {

MaskLanes AnyMask(TestRandom& random) {
  MaskLanes mask = {};
  for (int lane = 0; lane < kLanes; ++lane) mask[lane] = random.Float() < 0.5f ? -1 : 0;
  return mask;
}

TEST(PathStates, AreLoadedAsTheyAreStored) {
  PathStates states;
  for (int path = 0; path < kPaths; ++path) states[path].beta.r = static_cast<float>(path);
  const PathBatch batch(IntLanes{5, 63, 0, 17, 2, 9, 30, 31}, FirstLanes(6));
  const RowLanes before = states.Load(offsetof(PathState, beta), batch);
  states.Store(offsetof(PathState, beta), batch,
               {{before.v[0] + 100, before.v[0] + 200, before.v[0] + 300, before.v[0] + 400}});
  for (int path = 0; path < kPaths; ++path) {
    const PathState& state = states[path];
    const float x = static_cast<float>(path);
    bool in_batch = false;
    for (int lane = 0; lane < 6; ++lane) in_batch |= batch.path.at[lane] == path;
    EXPECT_EQ(state.beta, (in_batch ? Rgb{x + 100, x + 200, x + 300} : Rgb{x, 0, 0})) << path;
    EXPECT_EQ(state.eta_scale, in_batch ? x + 400 : 1) << path;
  }
}

TEST(PathQueue, IsFirstComeFirstServed) {
  TestRandom random(1);
  PathQueue queue;
  std::deque<int32_t> expected;
  int64_t pushed = 0, taken = 0;
  for (int i = 0; i < 10000; ++i) {
    const bool take = expected.size() > kPaths - kLanes || random.Float() < 0.4f;
    if (take) {
      const PathBatch batch = queue.Take();
      for (int lane = 0; lane < kLanes; ++lane) {
        ASSERT_EQ(batch.mask[lane] != 0, !expected.empty());
        ASSERT_EQ(batch.path.at[lane], expected.empty() ? kNoPath : expected.front());
        ASSERT_EQ(batch.ids[lane], batch.path.at[lane]);
        if (expected.empty()) continue;
        expected.pop_front();
        ++taken;
      }
    } else {
      IntLanes paths = {};
      for (int lane = 0; lane < kLanes; ++lane)
        paths[lane] = static_cast<int32_t>(random.Bits() % kPaths);
      const MaskLanes mask = AnyMask(random);
      queue.Push(paths, mask);
      ForEachLane(mask, [&](int lane) {
        expected.push_back(paths[lane]);
        ++pushed;
      });
    }
    ASSERT_EQ(queue.size(), static_cast<int>(expected.size()));
    ASSERT_EQ(queue.pushed(), pushed);
    ASSERT_EQ(queue.taken(), taken);
  }
  EXPECT_GT(taken, 10000);
}

/// Shadow rays of which all numbers are made of one.
ShadowQueue::Lanes ShadowsOf(FloatLanes number) {
  ShadowQueue::Lanes lanes;
  lanes.rays.origin = {number + 1, number + 2, number + 3};
  lanes.rays.direction = {number + 4, number + 5, number + 6};
  lanes.rays.t_max = number + 7;
  lanes.rays.time = number + 8;
  lanes.rays.id = ToInt(number + 9);
  lanes.contribution = {number + 10, number + 11, number + 12};
  lanes.medium = ToInt(number + 13);
  lanes.path = ToInt(number + 14);
  lanes.last = ToInt(number + 15);
  return lanes;
}

void ExpectShadows(const ShadowQueue::Lanes& found, std::deque<float>* expected, int count) {
  FloatLanes numbers = {};
  for (int lane = 0; lane < count; ++lane) {
    numbers[lane] = expected->front();
    expected->pop_front();
  }
  ShadowQueue::Lanes wanted = ShadowsOf(numbers);
  ShadowQueue::Lanes::ForEach(found, &wanted, [&](auto a, auto* b) {
    for (int lane = 0; lane < count; ++lane) ASSERT_EQ(a[lane], (*b)[lane]);
  });
}

TEST(ShadowQueue, GivesEightAtATimeInTheirOrder) {
  TestRandom random(2);
  ShadowQueue queue;
  std::deque<float> expected;
  int full_times = 0;
  for (int i = 0; i < 2000; ++i) {
    FloatLanes numbers = {};
    for (int lane = 0; lane < kLanes; ++lane)
      numbers[lane] = static_cast<float>(random.Bits() % (1 << 20));
    const MaskLanes mask = random.Float() < 0.1f ? SameInt(-1) : AnyMask(random);
    ForEachLane(mask, [&](int lane) { expected.push_back(numbers[lane]); });
    ShadowQueue::Lanes full;
    const bool is_full = queue.Push(ShadowsOf(numbers), mask, &full);
    ASSERT_EQ(is_full, expected.size() >= kLanes);
    if (is_full) {
      ++full_times;
      ExpectShadows(full, &expected, kLanes);
    }
    ASSERT_EQ(queue.size(), static_cast<int>(expected.size()));
    if (random.Float() < 0.1f) {
      const int count = queue.size();
      ExpectShadows(queue.Take(), &expected, count);
      ASSERT_EQ(queue.size(), 0);
    }
  }
  EXPECT_GT(full_times, 500);
}

}  // namespace
}  // namespace strata
