#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>

#include "tests/statistics/direction_test.h"

// Tests of many densities as one, every day and by hand.

namespace strata {

struct DensityEffort {
  int samples;                  ///< Of each density.
  std::optional<double> error;  ///< Of the control's shape; none: the least that must be found.
};

/// What no control may hide from: an error of 1 %. Such runs take minutes (docs/stability.md).
inline constexpr DensityEffort kByHand = {10'000'000, 0.01};

/// All checks together are a test of level 0.01, shared out by Sidak's rule; each has a control
/// that must fail. The extremes are printed at the end.
class DensityChecks {
 public:
  DensityChecks(size_t checks, const DensityEffort& effort)
      : effort_(effort), level_(SidakLevel(0.01, static_cast<int>(checks))) {}
  ~DensityChecks() {
    std::printf("%d densities: the least p is %.3g, the greatest of the controls %.1e\n", count_,
                least_, greatest_control_);
  }
  DensityChecks(const DensityChecks&) = delete;
  DensityChecks& operator=(const DensityChecks&) = delete;

  double level() const { return level_; }
  int samples() const { return effort_.samples; }
  /// Of the controls that are not TestDirections' own.
  double ErrorOr(double every_day) const { return effort_.error.value_or(every_day); }

  void Expect(const std::string& name, const ChiSquareResult& right,
              const ChiSquareResult& control) {
    ++count_;
    least_ = std::min(least_, right.p);
    greatest_control_ = std::max(greatest_control_, control.p);
    EXPECT_GT(right.p, level_) << name << ": chi-square " << right.statistic << " with "
                               << right.degrees << " degrees of freedom";
    EXPECT_LT(control.p, kControlLevel) << name << ": the control was not found";
  }

  /// As TestDirections, of so many draws that the effort's samples are directions; what the
  /// density's integral must be is the caller's to say.
  template <typename Sample, typename Pdf>
  DirectionTestResult ExpectDirections(const std::string& name, const Sample& sample,
                                       const Pdf& pdf) {
    const DirectionTestResult result = TestDirections(sample, pdf, DrawsFor(sample), effort_.error);
    Expect(name, result.chi_square, result.control);
    if (effort_.error) {
      std::printf("%s: integral %.6f, p = %.3g, control p = %.1e\n", name.c_str(), result.integral,
                  result.chi_square.p, result.control.p);
      std::fflush(stdout);
    }
    return result;
  }

 private:
  /// By the share of a thousand draws that give a direction, a hundredth at least.
  template <typename Sample>
  int DrawsFor(const Sample& sample) const {
    constexpr int kPilot = 1000;
    int directions = 0;
    for (int i = 0; i < kPilot; ++i) directions += sample().has_value();
    return static_cast<int>(samples() * (double{kPilot} / std::max(directions, kPilot / 100)));
  }

  DensityEffort effort_;
  double level_;
  int count_ = 0;
  double least_ = 1, greatest_control_ = 0;
};

}  // namespace strata
