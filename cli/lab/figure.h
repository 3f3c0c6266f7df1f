#pragma once

#include <filesystem>

#include "cli/lab/experiment.h"

namespace strata::lab {

/// Whether WriteFigure can write a figure of this experiment there: INVALID_ARGUMENT for a kind of
/// file it does not write (plots: .png, .svg; pictures: .png, .exr), FAILED_PRECONDITION when a
/// plot is wanted and gnuplot is not installed. Asked before the work is done.
absl::Status CheckFigure(const Experiment& experiment, const std::filesystem::path& path);

/// Plots by gnuplot, pictures by the renderer's own image writer.
absl::Status WriteFigure(const Outcome& outcome, const std::filesystem::path& path);

/// What gnuplot is told to draw the plot. `path` ends in .png or .svg.
std::string GnuplotScript(const Plot& plot, const std::filesystem::path& path);

}  // namespace strata::lab
