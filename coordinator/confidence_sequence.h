#pragma once

// An interval for someone who watches.
//
// The final report's interval, t(25, 0.975) sqrt(v / n), holds at a count fixed beforehand. Looked
// at after every sample it fails at some time far more often. Shown instead, from the first display
// at n0 samples to the last that are planned, N, is +- c sqrt(v / n) with one c for the whole time:
// the boundary of a repeated significance test. For a Brownian motion W
//   P(|W(n)| >= c sqrt(n) for some n in [n0, N]) ~ phi(c) ((c - 1/c) ln(N / n0) + 4/c)
// (Miller and Siegmund 1982, "Maximally selected chi square statistics", Biometrics 38; Siegmund
// 1985, "Sequential Analysis", chapter 4), which is set to 5 %. Then c is widened as Student's
// quantile with 25 degrees of freedom is against the normal one, since v is of the pixel and its
// 8 neighbours and always has about so few, however large n is.
//
// Why this one. The asymptotic confidence sequence of Waudby-Smith, Arbour, Sinha, Kennedy and
// Ramdas (2021, "Time-uniform central limit theory and asymptotic confidence sequences") holds for
// ever. Tuned to N = 32 n0 it is 5.6 sqrt(v / n) wide at n0 and 3.04 at N, which pays for times
// that are not shown. Tuned to 4 n0 it is 3.26, 3.04 and 3.21 at n0, 4 n0 and N, as good as
// the 3.30 here, but another number for each pixel, and too wide for short watches (3.26 to 3.08
// against 2.73 for N = 2 n0). Bonferroni's t(25) quantile over doubling looks is narrower (2.86),
// but it holds for these looks alone, and a farm shows more of them: looked at all the time, it
// misses 10 % at some time, this one 4 %. Figures: tests/farm/confidence_sequence_test.cpp.
//
// It is for display. No plan depends on it.

namespace strata {

/// c: a shown half-width is this many sqrt(v / n), with v as in ci95 (estimate.h)
/// and n the samples of the pixel, wherever first <= n <= planned. The interval then misses the
/// expectation at some time with a probability of 5 % at most. Requires 0 < first <= planned;
/// with one look, first == planned, it is kStudent25.
double AnytimeFactor(double first, double planned);

}  // namespace strata
