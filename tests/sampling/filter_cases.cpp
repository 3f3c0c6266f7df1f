#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "tests/sampling/density_cases.h"
#include "worker/sampling/filter.h"

namespace strata {
namespace {

/// Offsets in parts of the radii. A filter with negative lobes is sampled by its magnitude, which
/// is its value over the weight of a sample: all have the same, but for the sign.
PlaneCase Filter(const std::string& name, const FilterSpec& spec) {
  const auto filter = std::make_shared<FilterSampler>(spec);
  const double area = 4 * spec.radius_x * spec.radius_y;
  const double weight = std::fabs(filter->Sample({0.5f, 0.5f}).weight);
  std::vector<double> edges;  // Every eighth of the tabulated nodes.
  for (int i = 0; i <= 16; ++i) edges.push_back(i / 16.0);
  const auto value = [=](Vec2f p) {
    return filter->Eval({static_cast<float>(spec.radius_x) * (2 * p.x - 1),
                         static_cast<float>(spec.radius_y) * (2 * p.y - 1)});
  };
  return {.name = "Filter" + name,
          .sample = [=](TestRandom& random) -> std::optional<PlanePoint> {
            const FilterSample s = filter->Sample(random.Float2());
            EXPECT_NEAR(std::fabs(s.weight), weight, 1e-6 * weight);
            const PlanePoint p = {0.5 + 0.5 * s.offset.x / spec.radius_x,
                                  0.5 + 0.5 * s.offset.y / spec.radius_y};
            EXPECT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1);
            return p;
          },
          .density =
              [=](PlanePoint p) {
                return area / weight *
                       std::fabs(value({static_cast<float>(p.x), static_cast<float>(p.y)}));
              },
          .tilt = [](PlanePoint p) { return std::sin(2 * std::numbers::pi * p.x); },
          .x_edges = edges,
          .y_edges = edges};
}

}  // namespace

std::vector<FilterSpec> TestedFilters() {
  return {{.kind = FilterKind::kBox, .radius_x = 0.5, .radius_y = 0.5},
          {.kind = FilterKind::kBox, .radius_x = 1, .radius_y = 0.25},
          {.kind = FilterKind::kTriangle, .radius_x = 2, .radius_y = 1},
          {.kind = FilterKind::kGaussian, .radius_x = 1.5, .radius_y = 1.5, .sigma = 0.5},
          {.kind = FilterKind::kMitchell, .radius_x = 2, .radius_y = 2},
          {.kind = FilterKind::kMitchell, .radius_x = 3, .radius_y = 2, .b = 0, .c = 1}};
}

std::vector<PlaneCase> FilterCases() {
  const std::vector<FilterSpec> filters = TestedFilters();
  const char* names[] = {"Box", "FlatBox", "Triangle", "Gaussian", "Mitchell", "SharpMitchell"};
  std::vector<PlaneCase> cases;
  for (size_t i = 0; i < filters.size(); ++i) cases.push_back(Filter(names[i], filters[i]));
  return cases;
}

}  // namespace strata
