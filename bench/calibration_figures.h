#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "bench/calibration_trials.h"

// What trials say of the errors that were claimed for them.

namespace strata {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// A figure and, where one is asked for, its range.
struct Figure {
  std::string name;
  double value = 0;
  double least = -kNoLimit, greatest = kNoLimit;

  bool HasRange() const { return least > -kNoLimit || greatest < kNoLimit; }
  bool InRange() const { return value >= least && value <= greatest; }
};

/// In the order in which they are printed.
using Figures = std::vector<Figure>;

/// For parts whose figures are told and not judged.
inline void ClearRanges(Figures* figures) {
  for (Figure& figure : *figures) {
    figure.least = -kNoLimit;
    figure.greatest = kNoLimit;
  }
}

using Trials = std::vector<Trial>;

/// Mean and variance of a single trial's estimate, for each channel.
struct Reference {
  double trials = 0;
  std::vector<double> mean, variance;
};

/// Of every `step`-th trial from `first` on; at least 2.
inline Reference ReferenceOf(const Trials& trials, size_t first = 0, size_t step = 1) {
  Reference reference;
  reference.mean.resize(trials.front().mean.size());
  reference.variance.resize(reference.mean.size());
  for (size_t t = first; t < trials.size(); t += step) {  // Welford's update.
    reference.trials += 1;
    for (size_t i = 0; i < reference.mean.size(); ++i) {
      const double deviation = trials[t].mean[i] - reference.mean[i];
      reference.mean[i] += deviation / reference.trials;
      reference.variance[i] += deviation * (trials[t].mean[i] - reference.mean[i]);
    }
  }
  for (double& v : reference.variance) v /= reference.trials - 1;
  return reference;
}

/// The truth as each trial may know it: a reference of other trials or, where the trials are the
/// reference's own, of all the others. Its own error is taken into account.
struct Truth {
  const Reference& reference;
  bool own;

  /// Of a trial's mean from the truth.
  double Deviation(const Trial& trial, size_t i) const {
    const double scale = own ? reference.trials / (reference.trials - 1) : 1;
    return scale * (trial.mean[i] - reference.mean[i]);
  }
  /// Of the truth.
  double ErrorSquared(size_t i) const {
    return reference.variance[i] / (reference.trials - (own ? 1 : 0));
  }
  /// Whether +- factor x sqrt(error_squared) around the trial's mean holds the truth. Two
  /// independent errors are compared with, so their squares add up.
  bool Held(const Trial& trial, size_t i, double factor, double error_squared) const {
    const double deviation = Deviation(trial, i);
    return deviation * deviation <= factor * factor * (error_squared + ErrorSquared(i));
  }
};

/// A share of many.
struct Share {
  int64_t counted = 0, all = 0;
  void Add(bool counts) {
    counted += counts;
    ++all;
  }
  double Value() const { return static_cast<double>(counted) / static_cast<double>(all); }
};

/// Of independent values.
struct MeanAndError {
  double mean = 0, error = 0;
};
inline MeanAndError MeanOf(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / (n - 1) / n)};
}

/// v / n of a trial's ci95.
inline double PooledErrorSquared(const Trial& trial, size_t i) {
  const double error = trial.ci95[i] / kStudent25;
  return error * error;
}

/// The value below which 5 % of them lie.
inline double FifthPercentile(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 20);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Which intervals hold the truth. `at_lamp` marks the pixels at edges of visible lamps. Flags are
/// judged from 1024 samples per pixel on.
inline void AddCoverage(const Trials& trials, const Truth& truth,
                        const std::vector<uint8_t>& at_lamp, double spp, Figures* figures) {
  constexpr double kNormal95 = 1.959963984540054;
  Share held, dark, bright, raw, held_at_lamp, held_unflagged, flagged;
  std::vector<double> away_from_lamp, held_by_trial(trials.size());
  for (size_t i = 0; i < truth.reference.mean.size(); ++i) {
    if (truth.reference.variance[i] == 0) continue;
    Share channel;
    for (size_t t = 0; t < trials.size(); ++t) {
      const Trial& trial = trials[t];
      const bool holds = truth.Held(trial, i, kStudent25, PooledErrorSquared(trial, i));
      const bool is_dark = truth.Deviation(trial, i) < 0;
      held_by_trial[t] += holds;
      channel.Add(holds);
      held.Add(holds);
      dark.Add(!holds && is_dark);
      bright.Add(!holds && !is_dark);
      raw.Add(truth.Held(trial, i, kNormal95, trial.error_squared[i]));
      if (at_lamp[i / kColours]) held_at_lamp.Add(holds);
      const bool flag = trial.flagged[i / kColours];
      if (!flag) held_unflagged.Add(holds);
      flagged.Add(flag);
    }
    if (!at_lamp[i / kColours]) away_from_lamp.push_back(channel.Value());
  }
  const double channels = static_cast<double>(truth.reference.mean.size());
  const double live = static_cast<double>(held.all) / static_cast<double>(trials.size());
  figures->push_back({"channels without variance", channels - live});
  figures->push_back({"coverage of ci95", held.Value(), 0.94, 0.96});
  figures->push_back({"coverage of ci95, +-", MeanOf(held_by_trial).error / live});
  figures->push_back({"missed, estimate too dark", dark.Value(), 0.01, 0.04});
  figures->push_back({"missed, estimate too bright", bright.Value(), 0.01, 0.04});
  figures->push_back({"coverage, 5th percentile of channels off lamp edges",
                      FifthPercentile(away_from_lamp), 0.90});
  figures->push_back({"channels at lamp edges", live - static_cast<double>(away_from_lamp.size())});
  if (held_at_lamp.all > 0) figures->push_back({"coverage at lamp edges", held_at_lamp.Value()});
  figures->push_back({"flagged", flagged.Value(), -kNoLimit, spp < 1024 ? kNoLimit : 0.20});
  figures->push_back({"coverage where not flagged", held_unflagged.Value()});
  figures->push_back({"control: coverage of 1.96 stderr", raw.Value(), -kNoLimit, 0.94});
}

/// Mean over pixels of mean(claimed squared error) / variance, times (S-3)/(S-1), the reciprocal of
/// the mean of a reciprocal chi-square of S-1 degrees of freedom over S-1.
inline void AddErrorRatio(const Trials& trials, Figures* figures) {
  const Reference spread = ReferenceOf(trials);
  double sum = 0, sum_of_squares = 0, iid_sum = 0, live = 0;
  for (size_t i = 0; i < spread.mean.size(); ++i) {
    if (spread.variance[i] == 0) continue;
    double claimed = 0, iid = 0;
    for (const Trial& trial : trials) {
      claimed += trial.error_squared[i];
      iid += trial.iid_error_squared[i];
    }
    const double ratio = claimed / spread.trials / spread.variance[i];
    sum += ratio;
    sum_of_squares += ratio * ratio;
    iid_sum += iid / spread.trials / spread.variance[i];
    live += 1;
  }
  const double unbiased = (spread.trials - 3) / (spread.trials - 1);
  const double mean = sum / live;
  const double variance = sum_of_squares / live - mean * mean;
  figures->push_back({"mean stderr^2 / variance", mean * unbiased, 0.97, 1.03});
  // Channels of a pixel may be as good as one.
  figures->push_back({"mean stderr^2 / variance, +-", std::sqrt(variance / (live / kColours))});
  figures->push_back({"control: the same with s^2/n", iid_sum / live * unbiased});
}

/// (mean - reference) / sigma, averaged over channels, for each trial.
inline std::vector<double> Biases(const Trials& trials, const Reference& reference,
                                  const std::vector<double>& variance) {
  std::vector<double> biases;
  for (const Trial& trial : trials) {
    double sum = 0, live = 0;
    for (size_t i = 0; i < variance.size(); ++i) {
      if (variance[i] == 0) continue;
      sum += (trial.mean[i] - reference.mean[i]) / std::sqrt(variance[i]);
      live += 1;
    }
    biases.push_back(sum / live);
  }
  return biases;
}

/// In units of the standard deviation of a uniform trial. Where noise is skewed, the mean and the
/// deviation of one set of trials are correlated; hence the mean of one half of the references and
/// the deviation of the other, both ways.
inline void AddBias(const Trials& trials, const Trials& references, Figures* figures) {
  const Reference halves[] = {ReferenceOf(references, 0, 2), ReferenceOf(references, 1, 2)};
  double bias = 0, reference_error_squared = 0;
  std::vector<double> both(trials.size());
  for (int h = 0; h < 2; ++h) {
    const std::vector<double>& variance = halves[1 - h].variance;
    const std::vector<double> biases = Biases(trials, halves[h], variance);
    for (size_t t = 0; t < biases.size(); ++t) both[t] += biases[t] / 2;
    bias += MeanOf(biases).mean / 2;
    const double error = MeanOf(Biases(references, halves[h], variance)).error;
    reference_error_squared += error * error / 2;  // Of half as many trials, halved.
  }
  const double error = MeanOf(both).error;
  const double own_error = std::sqrt(error * error + reference_error_squared);
  // Judged where it is known well enough.
  const double most = own_error <= 0.0015 ? 0.005 : kNoLimit;
  figures->push_back({"bias in sigma of uniform", bias, -most, most});
  figures->push_back({"bias in sigma of uniform, +-", own_error});
  double fewest = static_cast<double>(trials.size());
  for (size_t i = 0; i < trials.front().mean.size(); ++i) {
    double lit = 0;
    for (const Trial& trial : trials) lit += trial.mean[i] != 0;
    if (lit > 0) fewest = std::min(fewest, lit);
  }
  figures->push_back({"fewest trials with light in a channel that has any", fewest});
}

/// Mean squared error over that of uniform trials of `spp`, both times their samples. Predicted: if
/// variances fell as 1 / n from those of uniform trials.
inline void AddEfficiency(const Trials& trials, const Truth& truth, double spp, Figures* figures) {
  const std::vector<double>& variance = truth.reference.variance;
  double uniform = 0, samples = 0, predicted = 0;
  for (const double v : variance) uniform += v;
  std::vector<double> errors;
  for (const Trial& trial : trials) {
    double sum = 0;
    for (size_t i = 0; i < variance.size(); ++i) {
      const double deviation = truth.Deviation(trial, i);
      sum += deviation * deviation - truth.ErrorSquared(i);
      predicted += variance[i] * spp / trial.samples[i / kColours];
    }
    errors.push_back(sum / uniform);
    for (const uint32_t n : trial.samples) samples += n;
  }
  const double renders = static_cast<double>(trials.size());
  samples /= renders * static_cast<double>(trials.front().samples.size());
  const MeanAndError error = MeanOf(errors);
  figures->push_back({"samples per pixel", samples});
  figures->push_back({"MSE x samples over uniform's", error.mean * samples / spp});
  figures->push_back({"MSE x samples over uniform's, +-", error.error * samples / spp});
  figures->push_back(
      {"predicted from uniform's variances", predicted / renders / uniform * samples / spp});
}

}  // namespace strata
