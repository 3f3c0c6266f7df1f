#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/status.h"

// What an experiment of `strata lab` is, and what it gives back. All numbers but times follow from
// the settings alone.

namespace strata::lab {

struct Settings {
  uint64_t seed = 0;
  int64_t samples = 0;  ///< What they are says the experiment; above 0.
};

/// Words, or a number; NaN where there is none.
using Cell = std::variant<std::string, double>;
inline constexpr double kNone = NAN;

/// What was measured, row by row.
struct Records {
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;

  /// The number in this column of the one row whose leading cells print as `labels`. CHECKs that it
  /// is there.
  double Number(const std::vector<std::string>& labels, std::string_view column) const;
};

/// As people read it: four significant digits, "-" for none.
std::string ToText(const Cell& cell);

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;
  bool theory = false;  ///< Drawn as a dashed line without points.
};
struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Series> series;
};

/// Linear RGB, row 0 at the top, interleaved.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgb;

  static Picture White(int width, int height);
  /// Copies rows of grey values, each times `scale`, to where their left upper corner lies at
  /// (left, top).
  void Place(std::span<const double> greys, int greys_width, int left, int top, double scale = 1);
};

struct Outcome {
  Records records;
  std::vector<std::string> remarks;  ///< What to see in the numbers: whole sentences.
  std::variant<Plot, Picture> figure;
  std::string caption;  ///< Of the figure.
};

struct Experiment {
  const char* name = "";
  const char* sentence = "";  ///< What it does.
  const char* samples = "";   ///< What `--samples` counts.
  int64_t default_samples = 0;
  bool draws_plot = true;  ///< Else a picture.
  absl::StatusOr<Outcome> (*run)(const Settings& settings) = nullptr;
};

/// All of them, in the order of a course.
std::span<const Experiment> Experiments();
/// Null when there is none of that name.
const Experiment* FindExperiment(std::string_view name);

// One file each.
absl::StatusOr<Outcome> RunQuadrature(const Settings& settings);
absl::StatusOr<Outcome> RunRoutines(const Settings& settings);
absl::StatusOr<Outcome> RunIntervals(const Settings& settings);
absl::StatusOr<Outcome> RunImportance(const Settings& settings);
absl::StatusOr<Outcome> RunIrradiance(const Settings& settings);
absl::StatusOr<Outcome> RunAreaLight(const Settings& settings);
absl::StatusOr<Outcome> RunMis(const Settings& settings);
absl::StatusOr<Outcome> RunRoulette(const Settings& settings);
absl::StatusOr<Outcome> RunFilter(const Settings& settings);

}  // namespace strata::lab
