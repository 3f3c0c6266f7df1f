#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/lab/experiment.h"
#include "cli/lab/measure.h"

namespace strata::lab {

/// The records of an experiment with a fixed seed. `samples` 0: its default.
inline Records RecordsOf(std::string_view name, int64_t samples = 0, uint64_t seed = 1) {
  const Experiment* experiment = FindExperiment(name);
  EXPECT_NE(experiment, nullptr) << name;
  const auto outcome = experiment->run({seed, samples ? samples : experiment->default_samples});
  EXPECT_TRUE(outcome.ok()) << outcome.status();
  for (const std::vector<Cell>& row : outcome->records.rows) {
    EXPECT_EQ(row.size(), outcome->records.columns.size());
  }
  return outcome->records;
}

/// Expects a ratio of 1 within `tolerance`.
#define EXPECT_RATIO(a, b, tolerance) EXPECT_NEAR((a) / (b), 1, tolerance) << (a) << " and " << (b)

}  // namespace strata::lab
