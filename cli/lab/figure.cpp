#include "cli/lab/figure.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_replace.h>
#include <absl/strings/str_split.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "common/image_file.h"

namespace strata::lab {
namespace {

bool IsInstalled(const std::string& program) {
  const char* folders = std::getenv("PATH");
  for (const absl::string_view folder : absl::StrSplit(folders ? folders : "", ':')) {
    if (access(absl::StrCat(folder, "/", program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// A string of gnuplot's that stands for itself.
std::string Quoted(const std::string& text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"'", "''"}}), "'");
}

absl::Status WritePlot(const Plot& plot, const std::filesystem::path& path) {
  std::FILE* gnuplot = popen("gnuplot", "w");
  if (gnuplot == nullptr) return absl::InternalError("gnuplot cannot be started");
  const std::string script = GnuplotScript(plot, path);
  std::fwrite(script.data(), 1, script.size(), gnuplot);
  if (pclose(gnuplot) != 0) {
    return absl::UnknownError(absl::StrCat(path.string(), ": gnuplot could not write it"));
  }
  return absl::OkStatus();
}

absl::Status WritePicture(const Picture& picture, const std::filesystem::path& path) {
  ImageLayers layers;
  layers.full_width = picture.width;
  layers.full_height = picture.height;
  layers.crop = {0, 0, picture.width, picture.height};
  layers.channels = {"R", "G", "B"};
  layers.values = picture.rgb;
  return path.extension() == ".exr" ? WriteExr(path, layers) : WritePng(path, layers);
}

}  // namespace

absl::Status CheckFigure(const Experiment& experiment, const std::filesystem::path& path) {
  const std::string kind = path.extension();
  if (!experiment.draws_plot) {
    if (kind == ".png" || kind == ".exr") return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat("--out: ", path.string(), " is neither .png nor .exr, which the picture of ",
                     experiment.name, " can be"));
  }
  if (kind != ".png" && kind != ".svg") {
    return absl::InvalidArgumentError(absl::StrCat("--out: ", path.string(),
                                                   " is neither .png nor .svg, which the plot of ",
                                                   experiment.name, " can be"));
  }
  if (!IsInstalled("gnuplot")) {
    return absl::FailedPreconditionError(
        "--out: plots are drawn by gnuplot, which is not installed: apt install gnuplot-nox, or "
        "take the numbers with --csv");
  }
  return absl::OkStatus();
}

absl::Status WriteFigure(const Outcome& outcome, const std::filesystem::path& path) {
  if (const Plot* plot = std::get_if<Plot>(&outcome.figure)) return WritePlot(*plot, path);
  return WritePicture(std::get<Picture>(outcome.figure), path);
}

std::string GnuplotScript(const Plot& plot, const std::filesystem::path& path) {
  static constexpr const char* kColours[] = {"#2060b0", "#d08030", "#109050", "#c03060",
                                             "#7050a0", "#808080", "#a08020", "#30a0a0"};
  std::string script = path.extension() == ".svg"
                           ? "set terminal svg size 720,480 background 'white'\n"
                           : "set terminal pngcairo size 720,480 font 'sans,10'\n";
  absl::StrAppend(&script, "set output ", Quoted(path.string()), "\nset title ", Quoted(plot.title),
                  " noenhanced\nset xlabel ", Quoted(plot.x_label), " noenhanced\nset ylabel ",
                  Quoted(plot.y_label),
                  " noenhanced\nset grid\nset key outside right top noenhanced\n");
  if (plot.log_x) script += "set logscale x\n";
  if (plot.log_y) script += "set logscale y\nset format y '%g'\n";
  std::string commands;
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const Series& series = plot.series[i];
    absl::StrAppend(&script, "$series", i, " << END\n");
    for (const auto& [x, y] : series.points) absl::StrAppendFormat(&script, "%.9g %.9g\n", x, y);
    script += "END\n";
    absl::StrAppend(&commands, i > 0 ? ", " : "plot ", "$series", i, " using 1:2 with ",
                    series.theory ? "lines dashtype 2" : "linespoints pointtype 7 pointsize 0.6",
                    " linewidth 2 linecolor rgb '", kColours[i % std::size(kColours)], "' title ",
                    Quoted(series.name));
  }
  return absl::StrCat(script, commands, "\n");
}

}  // namespace strata::lab
