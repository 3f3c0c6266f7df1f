#include <algorithm>
#include <cmath>

#include "common/job.h"
#include "tests/lab/numbers.h"
#include "worker/sampling/filter.h"

// The numbers of each experiment against closed forms, with fixed seeds. Tolerances are four or
// more standard errors, so that each would fail if the experiment did something else.

namespace strata::lab {
namespace {

TEST(Experiments, HaveNamesSentencesAndTheSameNumbersEachTime) {
  EXPECT_EQ(Experiments().size(), 9u);
  EXPECT_EQ(FindExperiment("no-such"), nullptr);
  for (const Experiment& experiment : Experiments()) {
    EXPECT_EQ(std::string_view(experiment.sentence).back(), '.') << experiment.name;
    EXPECT_EQ(FindExperiment(experiment.name), &experiment);
  }
  const Records one = RecordsOf("importance", 1000), two = RecordsOf("importance", 1000);
  const Records other = RecordsOf("importance", 1000, 2);
  EXPECT_EQ(one.Number({"0"}, kVariance), two.Number({"0"}, kVariance));
  EXPECT_NE(one.Number({"0"}, kVariance), other.Number({"0"}, kVariance));
}

TEST(Routines, MeansAreThoseOfClosedForms) {
  const Records records = RecordsOf("routines");
  ASSERT_EQ(records.rows.size(), 16u);
  for (const std::vector<Cell>& row : records.rows) {
    const std::string name = ToText(row[0]);
    const double error = records.Number({name}, "standard error");
    // Another density than the named one would be off by per cents.
    EXPECT_LT(error, 0.005 * records.Number({name}, "truth")) << name;
    EXPECT_NEAR(records.Number({name}, "mean"), records.Number({name}, "truth"), 4 * error) << name;
  }
}

TEST(Importance, VarianceIsThatOfTheoryAndZeroForTheRightDensity) {
  const Records records = RecordsOf("importance");
  for (const char* n : {"0", "1", "2", "2.5", "2.9", "3.1", "3.5", "4"}) {
    EXPECT_RATIO(records.Number({n}, kVariance), records.Number({n}, kTheory), 0.05);
  }
  for (const char* n : {"0", "1", "2", "2.5", "2.9", "3", "3.1", "3.5", "4", "5"}) {
    const double error = records.Number({n}, "standard error");
    EXPECT_NEAR(records.Number({n}, "mean"), 1, 4 * error + 1e-6) << n;
  }
  EXPECT_NEAR(records.Number({"0"}, kTheory), 16.0 / 7 - 1, 1e-12);
  EXPECT_LT(records.Number({"3"}, kVariance), 1e-12);
}

TEST(Irradiance, MeansAndVariancesAreThoseOfTheory) {
  constexpr double kSamples = 100000;
  const Records records = RecordsOf("irradiance", static_cast<int64_t>(kSamples));
  for (const std::vector<Cell>& row : records.rows) {
    const std::vector<std::string> labels = {ToText(row[0]), ToText(row[1])};
    const double theory = records.Number(labels, kTheory), truth = records.Number(labels, "truth");
    const double error = std::sqrt(theory / kSamples);
    EXPECT_NEAR(records.Number(labels, "mean"), truth, 4.5 * error + 1e-5 * truth)
        << labels[0] << ", " << labels[1];
    // Few directions meet the smallest lamp.
    const bool rare = labels[0] == "5" && (labels[1] == "uniform" || labels[1] == "cosine");
    if (theory > 1e-6 * truth * truth) {
      EXPECT_RATIO(records.Number(labels, kVariance), theory, rare ? 0.25 : 0.1);
    } else {
      EXPECT_LT(records.Number(labels, kVariance), 2e-6 * truth * truth);
    }
  }
  EXPECT_NEAR(records.Number({"90", "uniform"}, kTheory), M_PI * M_PI / 3, 1e-9);
  EXPECT_LT(records.Number({"90", "cosine"}, kVariance), 1e-9);
  EXPECT_LT(1e6 * records.Number({"5", "area"}, kVariance),
            records.Number({"5", "cosine"}, kVariance));
}

TEST(AreaLight, RandomSamplesDivideTheVarianceAndStratifiedOnesDoBetter) {
  const Records records = RecordsOf("area-light", 8);
  const auto gain = [&](const char* samples, const char* n) {
    return records.Number({samples, n}, "V of one / V");
  };
  // Variances over 9216 pixels of 8 estimates each err by about a per cent.
  EXPECT_RATIO(gain("random", "9"), 9.0, 0.06);
  EXPECT_RATIO(gain("random", "36"), 36.0, 0.06);
  EXPECT_RATIO(gain("stratified", "1"), 1.0, 0.06);
  EXPECT_GT(gain("stratified", "9"), 20);
  EXPECT_GT(gain("stratified", "36"), 150);
  const double mean = records.Number({"stratified", "36"}, "mean");
  for (const char* samples : {"random", "stratified"}) {
    for (const char* n : {"1", "9", "36"}) {
      EXPECT_RATIO(records.Number({samples, n}, "mean"), mean, 0.005);
    }
  }
}

TEST(MisExperiment, IsNearTheBetterStrategyEverywhereAndUnbiased) {
  const Records records = RecordsOf("mis", 32);
  const auto variance = [&](const char* where, const char* sampling) {
    return records.Number({where, sampling}, kVariance);
  };
  EXPECT_GT(variance("large lamp, smooth plate", "light"),
            20 * variance("large lamp, smooth plate", "BSDF"));
  EXPECT_GT(variance("small lamp, rough plate", "BSDF"),
            20 * variance("small lamp, rough plate", "light"));
  for (const char* where : {"small lamp, smooth plate", "small lamp, rough plate",
                            "large lamp, smooth plate", "large lamp, rough plate"}) {
    // Veach's theorem 9.2 for two samples, with room for the power heuristic and for noise.
    const double better = std::min(variance(where, "light"), variance(where, "BSDF"));
    for (const char* mis : {"MIS, balance", "MIS, power"}) {
      const double mean = records.Number({where, mis}, "mean");
      EXPECT_LT(variance(where, mis), 1.5 * better + 0.5 * mean * mean) << where << ", " << mis;
    }
  }
  for (const char* where : {"whole picture", "large lamp, rough plate"}) {
    const double mean = records.Number({where, "MIS, power"}, "mean");
    for (const char* sampling : {"light", "BSDF", "MIS, balance", "MIS, nearly maximum"}) {
      const double error = std::hypot(records.Number({where, sampling}, "standard error"),
                                      records.Number({where, "MIS, power"}, "standard error"));
      EXPECT_NEAR(records.Number({where, sampling}, "mean"), mean, 4 * error) << where;
      EXPECT_LT(error, 0.1 * mean) << "the test says nothing";
    }
  }
}

TEST(RouletteExperiment, KeepsTheMeanAndHasTheVarianceOfTheory) {
  constexpr double kSamples = 20000;
  const Records records = RecordsOf("roulette", static_cast<int64_t>(kSamples));
  EXPECT_EQ(records.rows.size(), 24u);
  for (const std::vector<Cell>& row : records.rows) {
    const std::vector<std::string> labels = {ToText(row[0]), ToText(row[1]), ToText(row[2])};
    const double theory = records.Number(labels, kTheory);
    EXPECT_NEAR(records.Number(labels, "mean"), records.Number(labels, "truth"),
                4 * std::sqrt(theory / kSamples));
    // A sample variance has the relative standard error sqrt((k - 1) / n), k the kurtosis: that of
    // the exponential part is 9, that of what survives with a chance of 1 - q, at most
    // E F^4 / (1 - q) where the variance is near (E F)^2 / (1 - q), and E F^4 is below 1.1.
    const double kurtosis = std::max(9.0, 1.1 / (1 - std::get<double>(row[2])));
    EXPECT_RATIO(records.Number(labels, kVariance), theory,
                 4.5 * std::sqrt((kurtosis - 1) / kSamples));
  }
  // c = mean adds next to nothing, c = 0 adds q / (1 - q) w^2.
  EXPECT_NEAR(records.Number({"1", "0", "0.5"}, kTheory), 1 + 2.0 / 64 + 1, 1e-9);
  EXPECT_NEAR(records.Number({"1", "1", "0.5"}, kTheory), 1 + 2.0 / 64, 1e-9);
}

TEST(FilterExperiment, TheWeightedAverageIsBiasedAndTheOthersAreNot) {
  constexpr int64_t kSamples = 50000;
  const Records records = RecordsOf("filter", kSamples);
  for (const char* filter : {"gaussian", "mitchell"}) {
    for (const char* estimator : {"weighted sum", "importance sampled"}) {
      for (const char* n : {"1", "4", "16", "64"}) {
        EXPECT_NEAR(records.Number({filter, estimator, n}, "bias"), 0,
                    4 * records.Number({filter, estimator, n}, "its error"));
      }
    }
    EXPECT_LT(records.Number({filter, "importance sampled", "16"}, kVariance),
              0.6 * records.Number({filter, "weighted sum", "16"}, kVariance));
  }
  // With one sample the average is that of the support: (radius - 0.3) / (2 radius).
  const FilterSpec spec = DefaultFilter(FilterKind::kGaussian);
  const FilterAxis axis(FilterKind::kGaussian, spec.radius_x, spec);
  double truth = 0;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double x = 0.3 + (spec.radius_x - 0.3) * (i + 0.5) / kSteps;
    truth += axis.Eval(static_cast<float>(x)) * (spec.radius_x - 0.3) / kSteps;
  }
  const auto bias = [&](const char* n) {
    return records.Number({"gaussian", "weighted average", n}, "bias");
  };
  EXPECT_NEAR(bias("1"), (spec.radius_x - 0.3) / (2 * spec.radius_x) - truth,
              4 * records.Number({"gaussian", "weighted average", "1"}, "its error"));
  EXPECT_GT(std::fabs(bias("4")),
            10 * records.Number({"gaussian", "weighted average", "4"}, "its error"));
  EXPECT_LT(std::fabs(bias("64")), std::fabs(bias("4")) / 6);
}

TEST(Intervals, SharesAreThoseOfClosedFormsAndNeverBelowChebyshev) {
  constexpr double kSamples = 50000;
  const Records records = RecordsOf("intervals", static_cast<int64_t>(kSamples));
  const auto expect_share = [&](const char* of, const char* n, const char* k, double share) {
    EXPECT_NEAR(records.Number({of, n, k}, "within k sigma"), share,
                4 * std::sqrt(share * (1 - share) / kSamples))
        << of << " " << n << " " << k;
  };
  expect_share("uniform", "1", "1", 1 / std::sqrt(3.0));
  expect_share("exponential", "1", "1", 1 - std::exp(-2.0));
  expect_share("exponential", "1", "3", 1 - std::exp(-4.0));
  expect_share("rare", "1", "1", 0.99);
  expect_share("uniform", "256", "3", 0.9973);
  expect_share("uniform", "256", "1", 0.6827);
  for (const std::vector<Cell>& row : records.rows) {
    const std::vector<std::string> labels = {ToText(row[0]), ToText(row[1]), ToText(row[2])};
    const double bound = records.Number(labels, "Chebyshev: at least");
    EXPECT_GE(records.Number(labels, "within k sigma"),
              bound - 4 * std::sqrt(bound * (1 - bound) / kSamples));
    EXPECT_RATIO(records.Number(labels, kVariance), records.Number(labels, kTheory), 0.2);
  }
  EXPECT_NEAR(records.Number({"uniform", "1", "3"}, "normal"), 0.9973, 1e-4);
}

}  // namespace
}  // namespace strata::lab
