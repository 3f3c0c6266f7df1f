#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <string>

#include "cli/console.h"
#include "common/report.h"

namespace strata {

/// The state of a job in one line of at most `width` columns: per cent, a bar, samples/s, error
/// now, time left, workers, the worst tile, samples left, the next worst tiles; what does not fit
/// is left out from the end.
std::string ProgressLine(const JobStatus& status, int width);

/// Shows how a job goes while it is followed.
class ProgressDisplay {
 public:
  using Time = std::chrono::steady_clock::time_point;

  virtual ~ProgressDisplay() = default;
  /// Called with every status that comes, in order.
  virtual void Show(const JobStatus& status, Time now) = 0;
};

struct ProgressStyle {
  bool json = false;   ///< Events on stdout, nothing on stderr.
  bool quiet = false;  ///< Nothing at all.
};

/// Adds --json and --quiet.
void AddProgressOptions(CLI::App* command, ProgressStyle& style);

/// A line redrawn in place on a terminal, lines at growing intervals elsewhere, or as `style` says.
/// `console` outlives the display.
std::unique_ptr<ProgressDisplay> MakeProgressDisplay(ProgressStyle style, Console& console);

}  // namespace strata
