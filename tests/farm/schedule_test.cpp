// The scheduler's decisions, one by one.

#include "coordinator/schedule.h"

#include <gtest/gtest.h>

namespace strata {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
const SteadyTime kStart{std::chrono::hours(1)};

TEST(PickJobTest, PrefersPriorityThenTheLeastServedThenTheFirst) {
  EXPECT_FALSE(PickJob({}).has_value());
  const std::vector<JobOffer> offers = {{0, 0, 5, 1}, {1, 0, 3, 2}, {2, 0, 3, 3}};
  EXPECT_EQ(PickJob(offers), 1u);
  const std::vector<JobOffer> urgent = {{0, 0, 0, 1}, {1, 7, 1e9, 2}};
  EXPECT_EQ(PickJob(urgent), 1u);
}

TEST(UnitsForLeaseTest, AimsAtASecond) {
  EXPECT_EQ(UnitsForLease({0, 1000, 10000, 2}), 1u) << "not measured yet";
  EXPECT_EQ(UnitsForLease({10000, 1000, 10000, 2}), 10u);
  EXPECT_EQ(UnitsForLease({10000, 1e6, 10000, 2}), 1u) << "at least one";
  EXPECT_EQ(UnitsForLease({1e9, 1000, 1000000, 2}), kMaxUnitsPerLease);
}

TEST(UnitsForLeaseTest, ShrinksNearTheEnd) {
  uint64_t last = kMaxUnitsPerLease;
  for (uint64_t pending = 1000; pending > 0; --pending) {
    const uint64_t units = UnitsForLease({1e6, 1000, pending, 3});
    EXPECT_LE(units, last);
    EXPECT_LE(units, std::max<uint64_t>(1, pending / 6)) << "others get their share";
    last = units;
  }
  EXPECT_EQ(last, 1u);
}

TEST(WindowTest, IsSmallForManyTilesAndEnoughForFew) {
  EXPECT_EQ(WindowFor(1000, 2), 4u);
  for (const int workers : {1, 7, 100}) {
    for (const uint32_t tiles : {1u, 4u, 300u}) {
      EXPECT_GE(WindowFor(tiles, workers) * tiles,
                static_cast<uint32_t>(kLeasesPerWorker * workers));
    }
  }
}

TEST(ForgiveStallTest, CountsSilenceOnlyWhileTheFarmListens) {
  const SteadyTime tick = kStart + seconds(5);
  EXPECT_EQ(ForgiveStall(kStart, tick, tick + milliseconds(100), seconds(2)), kStart);
  // A minute's stall counts as one heartbeat period.
  const SteadyTime now = tick + seconds(60);
  EXPECT_EQ(now - ForgiveStall(kStart, tick, now, seconds(2)), seconds(7));
  EXPECT_EQ(ForgiveStall(now, tick, now, seconds(2)), now) << "never later than now";
}

class StragglerTest : public ::testing::Test {
 protected:
  static bool Any(const JobId&) { return true; }
  LeaseTable leases_;
};

TEST_F(StragglerTest, IsTheOldestLeaseOfAnother) {
  const UnitId first{0, 0, 0}, second{0, 1, 0}, third{0, 2, 0};
  leases_.Grant("j-1", "w-1", {first}, kStart);
  leases_.Grant("j-1", "w-2", {second}, kStart + milliseconds(1));
  leases_.Grant("j-2", "w-2", {third}, kStart + milliseconds(2));
  const SteadyTime later = kStart + 2 * kStragglerAge;
  EXPECT_EQ(PickStraggler(leases_, "w-3", later, Any), std::pair(JobId("j-1"), first));
  EXPECT_EQ(PickStraggler(leases_, "w-1", later, Any), std::pair(JobId("j-1"), second));
  const auto second_job = [](const JobId& job) { return job == "j-2"; };
  EXPECT_EQ(PickStraggler(leases_, "w-1", later, second_job), std::pair(JobId("j-2"), third));
}

TEST_F(StragglerTest, IsNotYoungAndNotDuplicatedAlready) {
  const UnitId unit{0, 0, 0};
  leases_.Grant("j-1", "w-1", {unit}, kStart);
  EXPECT_FALSE(PickStraggler(leases_, "w-2", kStart, Any).has_value());
  const SteadyTime later = kStart + 2 * kStragglerAge;
  EXPECT_TRUE(PickStraggler(leases_, "w-2", later, Any).has_value());
  leases_.Grant("j-1", "w-2", {unit}, later);
  EXPECT_FALSE(PickStraggler(leases_, "w-3", later, Any).has_value());
}

TEST(LeaseTableTest, KnowsWhoHoldsWhat) {
  LeaseTable leases;
  const UnitId a{0, 0, 0}, b{0, 1, 0};
  const uint64_t first = leases.Grant("j-1", "w-1", {a, b}, kStart).id;
  const uint64_t second = leases.Grant("j-1", "w-2", {a}, kStart).id;
  EXPECT_NE(first, second);
  EXPECT_EQ(leases.Holders("j-1", a), 2);
  EXPECT_EQ(leases.Holders("j-2", a), 0);
  EXPECT_EQ(leases.Workers("j-1"), 2);
  EXPECT_EQ(leases.UnitsOut("j-1"), 3u);
  EXPECT_EQ(leases.UnitsOut("j-2"), 0u);
  const auto emptied = leases.Finish("j-1", a);
  ASSERT_EQ(emptied.size(), 1u) << "the other one still holds b";
  EXPECT_EQ(emptied[0].id, second);
  EXPECT_EQ(leases.UnitsOut("j-1"), 1u);
  EXPECT_EQ(leases.Count("w-1"), 1);
  EXPECT_EQ(leases.Count("w-2"), 0);
  EXPECT_TRUE(leases.GiveUp("w-1", "j-1", b));
  EXPECT_FALSE(leases.GiveUp("w-1", "j-1", b));
  EXPECT_TRUE(leases.leases().empty());
  EXPECT_EQ(leases.UnitsOut("j-1"), 0u);
  leases.Grant("j-1", "w-1", {a, b}, kStart);
  leases.Grant("j-1", "w-2", {a}, kStart);
  leases.RemoveWorker("w-1");
  EXPECT_EQ(leases.UnitsOut("j-1"), 1u);
  leases.RemoveJob("j-1");
  EXPECT_EQ(leases.UnitsOut("j-1"), 0u);
}

}  // namespace
}  // namespace strata
