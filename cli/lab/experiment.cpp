#include "cli/lab/experiment.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace strata::lab {
namespace {

constexpr std::array kExperiments = {
    Experiment{"quadrature",
               "Rectangle, trapezoid, Simpson and Gauss-Legendre rules against Monte Carlo and "
               "Sobol' points in 1 to 8 dimensions.",
               "evaluations of the integrand for one estimate", 65536, true, RunQuadrature},
    Experiment{"routines",
               "Where the sampling routines put their points, and the means of these beside their "
               "closed forms.",
               "points for each row", 100000, false, RunRoutines},
    Experiment{"intervals",
               "How many estimates lie within 1, 2 and 3 sigma, beside Chebyshev's bound and the "
               "normal distribution's share.",
               "estimates for each row", 100000, true, RunIntervals},
    Experiment{"importance",
               "Importance sampling of 4 x^3 with p from uniform to p = f / mu, where the variance "
               "is zero, and beyond.",
               "samples for each row", 200000, true, RunImportance},
    Experiment{"irradiance",
               "Irradiance under lamps of several sizes by uniform, cosine, area and solid-angle "
               "sampling.",
               "samples for each row", 200000, true, RunIrradiance},
    Experiment{"area-light",
               "Soft shadows by 1, 9 and 36 samples of an area light, random and stratified.",
               "estimates for each pixel", 16, false, RunAreaLight},
    Experiment{"mis",
               "Veach's plates by light sampling, BSDF sampling and both under multiple importance "
               "sampling.",
               "samples for each pixel", 32, false, RunMis},
    Experiment{"roulette",
               "Russian roulette with several q on a costly part of an estimate that matters "
               "little, and on one that matters.",
               "estimates for each row", 100000, true, RunRoulette},
    Experiment{"filter",
               "A pixel at an edge by weighted averages, which are biased, and by filter "
               "importance sampling, which is not.",
               "estimates for each row", 100000, true, RunFilter},
};

}  // namespace

std::span<const Experiment> Experiments() { return kExperiments; }

const Experiment* FindExperiment(std::string_view name) {
  for (const Experiment& experiment : kExperiments) {
    if (experiment.name == name) return &experiment;
  }
  return nullptr;
}

std::string ToText(const Cell& cell) {
  if (const std::string* words = std::get_if<std::string>(&cell)) return *words;
  const double number = std::get<double>(cell);
  return std::isnan(number) ? "-" : absl::StrFormat("%.4g", number);
}

double Records::Number(const std::vector<std::string>& labels, std::string_view column) const {
  size_t c = 0;
  while (c < columns.size() && columns[c] != column) ++c;
  for (const std::vector<Cell>& row : rows) {
    bool matches = c < columns.size() && labels.size() <= row.size();
    for (size_t i = 0; matches && i < labels.size(); ++i) matches = ToText(row[i]) == labels[i];
    if (matches) return std::get<double>(row[c]);
  }
  std::fprintf(stderr, "no row or column '%s' in an experiment's records\n",
               std::string(column).c_str());
  std::abort();
}

Picture Picture::White(int width, int height) {
  return {width, height, std::vector<float>(static_cast<size_t>(width) * height * 3, 1.0f)};
}

void Picture::Place(std::span<const double> greys, int greys_width, int left, int top,
                    double scale) {
  for (size_t i = 0; i < greys.size(); ++i) {
    const size_t x = left + i % greys_width, y = top + i / greys_width;
    std::fill_n(&rgb[(y * width + x) * 3], 3, static_cast<float>(greys[i] * scale));
  }
}

}  // namespace strata::lab
