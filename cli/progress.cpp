#include "cli/progress.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <vector>

#include "cli/events.h"
#include "cli/format.h"

namespace strata {
namespace {

constexpr int kBarColumns = 20;
constexpr size_t kWorstTilesShown = 3;

std::string Bar(double fraction) {
  const int full = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarColumns);
  return "[" + std::string(full, '#') + std::string(kBarColumns - full, '.') + "]";
}

std::string Workers(int workers) {
  return absl::StrCat(workers, workers == 1 ? " worker" : " workers");
}

/// "3m 20s left", with the interval it lies in where that says more.
std::string TimeLeft(const JobStatus& status) {
  const auto duration = [](double seconds) { return FormatDuration(std::max(1.0, seconds)); };
  const std::string low = duration(status.eta_low_s), high = duration(status.eta_high_s);
  std::string text = duration(status.eta_s) + " left";
  if (status.eta_low_s >= 0 && low != high) absl::StrAppend(&text, " (", low, " to ", high, ")");
  return text;
}

/// The i-th worst tile, if so many are known.
void AddWorstTile(const JobStatus& status, size_t i, std::vector<std::string>* segments) {
  if (i >= status.worst_tiles.size()) return;
  const TileError& tile = status.worst_tiles[i];
  segments->push_back(absl::StrFormat("%s %s at %d,%d", i == 0 ? "worst" : "then",
                                      FormatPercent(tile.rel_error), tile.pixels.x0,
                                      tile.pixels.y0));
}

/// What goes on, most wanted first.
std::vector<std::string> Segments(const JobStatus& status) {
  std::vector<std::string> segments;
  // Never 100 % before the end.
  const int percent = static_cast<int>(std::clamp(status.fraction, 0.0, 1.0) * 100);
  segments.push_back(absl::StrFormat("%3d %%", percent));
  if (status.state == JobState::kQueued) {
    segments.push_back("waiting for a worker");
  } else if (status.state != JobState::kRunning) {
    segments.push_back(std::string(ToString(status.state)));
  } else if (status.samples == 0) {
    segments.push_back(status.workers > 0 ? "loading the scene" : "waiting for a worker");
  }
  if (status.samples_per_second > 0) {
    segments.push_back(FormatCount(status.samples_per_second) + " samples/s");
  }
  if (status.rel_error > 0) segments.push_back("error " + FormatPercent(status.rel_error));
  if (status.eta_s >= 0 && !IsFinal(status.state)) {
    segments.push_back(TimeLeft(status));
  }
  segments.push_back(Workers(status.workers));
  AddWorstTile(status, 0, &segments);
  if (status.samples_left > 0) {
    segments.push_back(FormatCount(status.samples_left) + " samples left");
  }
  for (size_t i = 1; i < kWorstTilesShown; ++i) AddWorstTile(status, i, &segments);
  return segments;
}

std::string Join(const std::vector<std::string>& segments, int width) {
  std::string line;
  for (const std::string& segment : segments) {
    const std::string longer = line.empty() ? segment : line + "  " + segment;
    if (DisplayWidth(longer) > width) break;
    line = longer;
  }
  return line;
}

/// Redraws one line in place.
class LiveDisplay : public ProgressDisplay {
 public:
  explicit LiveDisplay(Console& console) : console_(console) {}
  ~LiveDisplay() override { console_.Clear(); }

  void Show(const JobStatus& status, Time) override {
    // The last column stays free: some terminals wrap when it is written.
    console_.Redraw(ProgressLine(status, console_.Width() - 1));
  }

 private:
  Console& console_;
};

/// Plain lines for logs: soon at first, then ever rarer, up to one a minute.
class PlainDisplay : public ProgressDisplay {
 public:
  explicit PlainDisplay(Console& console) : console_(console) {}

  void Show(const JobStatus& status, Time now) override {
    if (shown_ && now < next_) return;
    console_.Note(Join(Segments(status), kPlainColumns));
    interval_ = shown_ ? std::min(2 * interval_, kLongest) : kFirst;
    next_ = now + interval_;
    shown_ = true;
  }

 private:
  static constexpr int kPlainColumns = 200;
  static constexpr std::chrono::seconds kFirst{2}, kLongest{60};
  Console& console_;
  bool shown_ = false;
  std::chrono::seconds interval_{0};
  Time next_;
};

class JsonDisplay : public ProgressDisplay {
 public:
  explicit JsonDisplay(Console& console) : console_(console) {}
  void Show(const JobStatus& status, Time) override { console_.Result(ProgressEvent(status)); }

 private:
  Console& console_;
};

class SilentDisplay : public ProgressDisplay {
 public:
  void Show(const JobStatus&, Time) override {}
};

}  // namespace

std::string ProgressLine(const JobStatus& status, int width) {
  std::vector<std::string> segments = Segments(status);
  const std::string line = Join(segments, width);
  // The bar is decoration: it comes only where all that was said has room beside it.
  segments.insert(segments.begin() + 1, Bar(status.fraction));
  const std::string with_bar = Join(segments, width);
  return DisplayWidth(with_bar) == DisplayWidth(line) + kBarColumns + 4 ? with_bar : line;
}

void AddProgressOptions(CLI::App* command, ProgressStyle& style) {
  command->add_flag("--json", style.json, "Print events, one JSON object per line");
  command->add_flag("--quiet", style.quiet, "Show no progress and no warnings");
}

std::unique_ptr<ProgressDisplay> MakeProgressDisplay(ProgressStyle style, Console& console) {
  if (style.json) return std::make_unique<JsonDisplay>(console);
  if (style.quiet) return std::make_unique<SilentDisplay>();
  if (console.live()) return std::make_unique<LiveDisplay>(console);
  return std::make_unique<PlainDisplay>(console);
}

}  // namespace strata
