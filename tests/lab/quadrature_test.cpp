#include <cmath>

#include "cli/lab/grid_rules.h"
#include "tests/lab/numbers.h"

namespace strata::lab {
namespace {

double Integral(const GridRule& rule, int power) {
  double sum = 0;
  for (size_t i = 0; i < rule.nodes.size(); ++i) {
    sum += rule.weights[i] * std::pow(rule.nodes[i], power);
  }
  return sum;
}

TEST(GridRules, AreExactForThePolynomialsTheyShouldBe) {
  struct Case {
    RuleKind kind;
    int intervals, degree;
  };
  for (const Case& c : {Case{RuleKind::kRectangle, 5, 0}, Case{RuleKind::kTrapezoid, 5, 1},
                        Case{RuleKind::kSimpson, 6, 3}, Case{RuleKind::kGauss, 1, 1},
                        Case{RuleKind::kGauss, 4, 7}, Case{RuleKind::kGauss, 10, 19}}) {
    const GridRule rule = MakeRule(c.kind, c.intervals);
    EXPECT_EQ(static_cast<int>(rule.nodes.size()), NodesOf(c.kind, c.intervals));
    for (int power = 0; power <= c.degree; ++power) {
      EXPECT_NEAR(Integral(rule, power), 1.0 / (power + 1), 1e-14) << ToString(c.kind);
    }
    // And of no higher degree.
    EXPECT_GT(std::fabs(Integral(rule, c.degree + 1) - 1.0 / (c.degree + 2)), 1e-15)
        << ToString(c.kind);
  }
}

TEST(GridRules, AsManyIntervalsAsFit) {
  EXPECT_EQ(MostIntervals(RuleKind::kRectangle, 2, 100), 10);
  EXPECT_EQ(MostIntervals(RuleKind::kRectangle, 2, 99), 9);
  EXPECT_EQ(MostIntervals(RuleKind::kTrapezoid, 3, 1000), 9);
  EXPECT_EQ(MostIntervals(RuleKind::kSimpson, 1, 1000), 998);
  EXPECT_EQ(MostIntervals(RuleKind::kSimpson, 8, 65536), 2);
  EXPECT_EQ(MostIntervals(RuleKind::kSimpson, 8, 6560), 0);
  EXPECT_EQ(MostIntervals(RuleKind::kGauss, 8, 65536), 4);
  EXPECT_EQ(MostIntervals(RuleKind::kRectangle, 1, 65536), 65536);
}

TEST(Quadrature, ErrorsFallWithTheOrdersOfTheory) {
  const Records records = RecordsOf("quadrature", 4096);
  const auto order = [&](const char* d, const char* rule) {
    return records.Number({d, rule}, "order");
  };
  EXPECT_NEAR(order("1", "rectangle"), 1, 0.01);
  EXPECT_NEAR(order("1", "trapezoid"), 2, 0.01);
  EXPECT_NEAR(order("1", "Simpson"), 4, 0.05);
  EXPECT_NEAR(order("2", "rectangle"), 1.0 / 2, 0.02);
  EXPECT_NEAR(order("2", "trapezoid"), 2.0 / 2, 0.05);
  EXPECT_NEAR(order("2", "Simpson"), 4.0 / 2, 0.1);
  EXPECT_NEAR(order("4", "rectangle"), 1.0 / 4, 0.05);
  // Root mean squares of 32 runs err by an eighth, so slopes over a factor of 64 by 0.06.
  for (const char* d : {"1", "2", "3", "4", "5", "6", "7", "8"}) {
    EXPECT_NEAR(order(d, "Monte Carlo"), 0.5, 0.15) << d;
    EXPECT_RATIO(records.Number({d, "Monte Carlo"}, kVariance),
                 records.Number({d, "Monte Carlo"}, kTheory), 0.7);
  }
  EXPECT_GT(order("1", "Sobol'"), 1.3);
}

TEST(Quadrature, MonteCarloOvertakesTheRulesInManyDimensions) {
  const Records records = RecordsOf("quadrature", 4096);
  const auto error = [&](const char* d, const char* rule) {
    return records.Number({d, rule}, "error");
  };
  EXPECT_LT(error("1", "trapezoid"), 1e-4 * error("1", "Monte Carlo"));
  EXPECT_GT(error("8", "rectangle"), 10 * error("8", "Monte Carlo"));
  EXPECT_GT(error("8", "trapezoid"), 3 * error("8", "Monte Carlo"));
}

}  // namespace
}  // namespace strata::lab
