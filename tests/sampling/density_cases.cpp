#include "tests/sampling/density_cases.h"

#include <memory>
#include <numbers>

#include "worker/sampling/alias_table.h"
#include "worker/sampling/disk.h"
#include "worker/sampling/distribution.h"
#include "worker/sampling/inversion.h"
#include "worker/sampling/jacobian.h"
#include "worker/sampling/piecewise_linear.h"
#include "worker/sampling/rejection.h"
#include "worker/sampling/routines.h"
#include "worker/sampling/triangle_sqrt.h"
#include "worker/sampling/warp.h"
#include "worker/sampling/warp_inverse.h"

namespace strata {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double Wave(double u) { return std::cos(kTurn * u); }

/// A density on [x0, x1]; y is idle.
PlaneCase Line(std::string name, std::function<float(float)> sample,
               std::function<double(double)> pdf, std::function<float(float)> invert) {
  return {.name = std::move(name),
          .sample = [sample](TestRandom& random) -> std::optional<PlanePoint> {
            return PlanePoint{sample(random.Float()), 0.5};
          },
          .density = [pdf](PlanePoint p) { return pdf(p.x); },
          .tilt = [invert](PlanePoint p) { return Wave(invert(static_cast<float>(p.x))); },
          .y_edges = {0, 1}};
}

std::vector<double> EvenEdges(int cells, double high = 1) {
  std::vector<double> edges;
  for (int i = 0; i <= cells; ++i) edges.push_back(high * i / cells);
  return edges;
}

PlaneCase Exponential(float a) {
  // In x / (1 + x), which is finite.
  PlaneCase line = Line(
      "Exponential",
      [a](float u) {
        const float x = SampleExponential(u, a);
        return x / (1 + x);
      },
      [a](double t) {
        const double x = t / (1 - t);
        return ExponentialPdf(static_cast<float>(x), a) * (1 + x) * (1 + x);
      },
      [a](float t) { return InvertExponential(t / (1 - t), a); });
  return line;
}

PlaneCase Linear(const std::string& name, float a, float b) {
  return Line(
      name, [=](float u) { return SampleLinear(u, a, b); },
      [=](double x) { return LinearPdf(static_cast<float>(x), a, b); },
      [=](float x) { return InvertLinear(x, a, b); });
}

PlaneCase Power(const std::string& name, float n) {
  return Line(
      name, [n](float u) { return SamplePower(u, n); },
      [n](double x) { return PowerPdf(static_cast<float>(x), n); },
      [n](float x) { return InvertPower(x, n); });
}

PlaneCase PiecewiseConstant() {
  const PiecewiseConstant1D d(std::vector<double>{1, 3, 0.5, 4, 0, 2, 2.5, 0.1});
  PlaneCase line = Line(
      "PiecewiseConstant1D", [d](float u) { return d.Sample(u).x; },
      [d](double x) { return d.Pdf(static_cast<float>(x)); }, [d](float x) { return d.Invert(x); });
  line.x_edges = EvenEdges(8);
  return line;
}

PlaneCase PiecewiseLinear() {
  const PiecewiseLinear1D d({1, 3, 0, 0, 4, 0.5f, 2});
  PlaneCase line = Line(
      "PiecewiseLinear1D", [d](float u) { return d.Sample(u); },
      [d](double x) { return d.Pdf(static_cast<float>(x)); }, [d](float x) { return d.Invert(x); });
  line.x_edges = EvenEdges(12);
  return line;
}

/// An outcome and what is left of u: together a density on [0, outcomes).
template <typename Choose, typename Probability>
PlaneCase Discrete(std::string name, int outcomes, Choose choose, Probability probability) {
  return {.name = std::move(name),
          .sample = [=](TestRandom& random) -> std::optional<PlanePoint> {
            const auto [outcome, fraction] = choose(random.Float());
            return PlanePoint{outcome + fraction, 0.5};
          },
          .density = [=](PlanePoint p) { return probability(static_cast<int>(p.x)); },
          .tilt = [](PlanePoint p) { return Wave(p.x); },
          .x1 = static_cast<double>(outcomes),
          .x_edges = EvenEdges(4 * outcomes, outcomes),
          .y_edges = {0, 1}};
}

using Outcome = std::pair<int, double>;

/// A routine that takes the square to points of the plane.
PlaneCase Square(std::string name, std::function<Vec2f(Vec2f)> sample,
                 std::function<double(Vec2f)> pdf, std::function<Vec2f(Vec2f)> invert) {
  return {.name = std::move(name),
          .sample = [sample](TestRandom& random) -> std::optional<PlanePoint> {
            const Vec2f p = sample(random.Float2());
            return PlanePoint{p.x, p.y};
          },
          .density =
              [pdf](PlanePoint p) {
                return pdf({static_cast<float>(p.x), static_cast<float>(p.y)});
              },
          .tilt =
              [invert](PlanePoint p) {
                const Vec2f u = invert({static_cast<float>(p.x), static_cast<float>(p.y)});
                return 0.5 * (Wave(u.x) + Wave(u.y));
              }};
}

PlaneCase Bilinear() {
  const std::array<float, 4> corners = {1, 0.2f, 3, 0};
  return Square(
      "Bilinear", [=](Vec2f u) { return SampleBilinear(u, corners); },
      [=](Vec2f p) { return BilinearPdf(p, corners); },
      [=](Vec2f p) { return InvertBilinear(p, corners); });
}

PlaneCase MarginalAndConditional() {
  std::vector<float> weights;
  for (int i = 0; i < 32; ++i) weights.push_back(i % 5 == 4 ? 0 : 0.2f + static_cast<float>(i % 7));
  const PiecewiseConstant2D d(weights, 8, 4);
  PlaneCase square = Square(
      "PiecewiseConstant2D",
      [d](Vec2f u) {
        float pdf;
        return d.Sample(u, &pdf);
      },
      [d](Vec2f p) { return d.Pdf(p); }, [d](Vec2f p) { return d.Invert(p); });
  square.x_edges = EvenEdges(16);
  square.y_edges = EvenEdges(8);
  return square;
}

/// Points of the unit disk of density 1 / pi, told by radius and angle.
PlaneCase Disk(std::string name, std::function<Vec2f(TestRandom&)> sample,
               std::function<double(Vec2f)> tilt) {
  return {
      .name = std::move(name),
      .sample = [sample](TestRandom& random) -> std::optional<PlanePoint> {
        const Vec2f p = sample(random);
        return PlanePoint{std::hypot(p.x, p.y), std::atan2(p.y, p.x)};
      },
      .density =
          [](PlanePoint p) { return AreaToPolarPdf(ConcentricDiskPdf(), static_cast<float>(p.x)); },
      .tilt =
          [tilt](PlanePoint p) {
            return tilt(
                {static_cast<float>(p.x * std::cos(p.y)), static_cast<float>(p.x * std::sin(p.y))});
          },
      .y0 = -std::numbers::pi,
      .y1 = std::numbers::pi};
}

/// Weights of two corners, told by s = 1 - b0 and b1 / s: their area is 2 s ds dt of the
/// triangle's.
PlaneCase Triangle(std::string name, Vec2f (*sample)(Vec2f), Vec2f (*invert)(Vec2f)) {
  return {.name = std::move(name),
          .sample = [sample](TestRandom& random) -> std::optional<PlanePoint> {
            const Vec2f b = sample(random.Float2());
            const double s = 1 - static_cast<double>(b.x);
            return PlanePoint{s, s > 0 ? b.y / s : 0};
          },
          // The triangle of the weights has area 1/2.
          .density = [](PlanePoint p) { return TrianglePdf(0.5f) * p.x; },
          .tilt =
              [invert](PlanePoint p) {
                return Wave(invert({static_cast<float>(1 - p.x), static_cast<float>(p.x * p.y)}).x);
              }};
}

PlaneCase JobTriangle(std::string name, Vec2f (*numbers)(Vec2f)) {
  return Square(
      std::move(name), numbers, [](Vec2f) { return 1; }, [](Vec2f u) { return u; });
}

}  // namespace

std::vector<PlaneCase> OneDimensionalCases() {
  const std::vector<double> weights = {1, 0, 3, 0.1, 7, 2};
  const PiecewiseConstant1D inversion(weights);
  const AliasTable alias(weights);
  return {Power("PowerHalf", 0.5f),
          Power("PowerFive", 5),
          Exponential(2),
          Linear("Linear", 1, 4),
          Linear("LinearFromZero", 0, 1),
          Linear("LinearToZero", 2, 0),
          PiecewiseConstant(),
          PiecewiseLinear(),
          Discrete(
              "DiscreteInversion", 6,
              [=](float u) {
                const auto choice = inversion.Choose(u);
                return Outcome{choice.cell, choice.fraction};
              },
              [=](int outcome) { return inversion.Probability(outcome); }),
          Discrete(
              "AliasTable", 6,
              [=](float u) {
                const auto choice = alias.Choose(u);
                return Outcome{choice.outcome, choice.fraction};
              },
              [=](int outcome) { return alias.Probability(outcome); })};
}

std::vector<PlaneCase> PlanarCases() {
  return {
      Bilinear(),
      MarginalAndConditional(),
      Disk(
          "PolarDisk", [](TestRandom& random) { return SamplePolarDisk(random.Float2()); },
          [](Vec2f p) { return Wave(InvertPolarDisk(p).x); }),
      Disk(
          "ConcentricDisk",
          [](TestRandom& random) { return SampleConcentricDisk(random.Float2()); },
          [](Vec2f p) { return Wave(InvertConcentricDisk(p).x); }),
      Disk(
          "RejectionDisk",
          [](TestRandom& random) {
            return SampleDiskByRejection([&] { return random.Float(); }).point;
          },
          [](Vec2f p) { return Wave(InvertPolarDisk(p).x); }),
      Disk(
          "JobDiskByRejection",
          [](TestRandom& random) {
            return SampleDiskBy(SamplingRoutines::kRejection, random.Float2());
          },
          [](Vec2f p) { return Wave(InvertPolarDisk(p).x); }),
      JobTriangle("JobTrianglePlain",
                  [](Vec2f u) { return TriangleNumbers(SamplingRoutines::kPlain, u); }),
      JobTriangle("JobTriangleByRejection",
                  [](Vec2f u) { return TriangleNumbers(SamplingRoutines::kRejection, u); }),
      Triangle("TriangleSqrt", SampleTriangleSqrt, InvertTriangleSqrt),
      Triangle("TriangleLowDistortion", SampleTriangle, InvertTriangle),
  };
}

}  // namespace strata
