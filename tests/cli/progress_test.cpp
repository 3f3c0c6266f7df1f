#include "cli/progress.h"

#include <gtest/gtest.h>

#include "cli/format.h"

namespace strata {
namespace {

JobStatus Running() {
  JobStatus status;
  status.id = "j-1";
  status.state = JobState::kRunning;
  status.fraction = 0.427;
  status.samples = 5000000;
  status.samples_per_second = 1234567;
  status.rel_error = 0.031;
  status.eta_s = 72;
  status.workers = 2;
  status.samples_left = 2345678;
  status.worst_tiles = {{{320, 64, 352, 96}, 0.12},
                        {{0, 32, 32, 64}, 0.11},
                        {{64, 0, 96, 32}, 0.1},
                        {{96, 0, 128, 32}, 0.09}};
  return status;
}

TEST(ProgressLine, TellsPercentRateErrorTimeLeftAndWorkers) {
  const std::string line = ProgressLine(Running(), 200);
  for (const char* part : {"42 %", "1.23 M samples/s", "error 3.1 %", "1 min 12 s left",
                           "2 workers", "worst 12 % at 320,64", "2.35 M samples left",
                           "then 11 % at 0,32", "then 10 % at 64,0", "[########....."}) {
    EXPECT_NE(line.find(part), std::string::npos) << part << " in: " << line;
  }
  EXPECT_EQ(line.find("96,0"), std::string::npos) << "three tiles are enough";
}

TEST(ProgressLine, FitsEveryWidthAndLeavesOutTheLeastFirst) {
  int last = 1000;
  for (int width = 200; width >= 5; --width) {
    const std::string line = ProgressLine(Running(), width);
    EXPECT_LE(DisplayWidth(line), width);
    EXPECT_LE(DisplayWidth(line), last);
    EXPECT_NE(line.find("42 %"), std::string::npos);
    last = DisplayWidth(line);
  }
  EXPECT_EQ(ProgressLine(Running(), 30), " 42 %  1.23 M samples/s");
}

TEST(ProgressLine, SaysWhatAJobWaitsFor) {
  JobStatus status;
  status.state = JobState::kQueued;
  EXPECT_NE(ProgressLine(status, 80).find("waiting for a worker"), std::string::npos);
  status.state = JobState::kPaused;
  EXPECT_NE(ProgressLine(status, 80).find("paused"), std::string::npos);
  status.state = JobState::kRunning;
  status.workers = 1;
  EXPECT_NE(ProgressLine(status, 80).find("loading the scene"), std::string::npos);
  EXPECT_NE(ProgressLine(status, 80).find("1 worker"), std::string::npos);
  EXPECT_EQ(ProgressLine(status, 80).find("1 workers"), std::string::npos);
}

TEST(ProgressLine, IsNotAtAHundredPerCentBeforeTheEnd) {
  JobStatus status = Running();
  status.fraction = 0.9999;
  EXPECT_NE(ProgressLine(status, 80).find("99 %"), std::string::npos);
}

TEST(ProgressDisplay, WithoutATerminalLinesComeEverMoreRarely) {
  Console console(Console::Terminal{});
  const auto display = MakeProgressDisplay({}, console);
  const ProgressDisplay::Time start{};
  testing::internal::CaptureStderr();
  for (int tenth = 0; tenth <= 1200; ++tenth) {
    display->Show(Running(), start + std::chrono::milliseconds(100 * tenth));
  }
  const std::string shown = testing::internal::GetCapturedStderr();
  // At 0, 2, 6, 14, 30, 62 s; the next would come at 122 s.
  EXPECT_EQ(std::count(shown.begin(), shown.end(), '\n'), 6) << shown;
  EXPECT_EQ(shown.find('\x1b'), std::string::npos);
}

TEST(ProgressDisplay, QuietMeansQuiet) {
  Console console(Console::Terminal{.live = true, .colour = true});
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  MakeProgressDisplay({.quiet = true}, console)->Show(Running(), {});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace strata
