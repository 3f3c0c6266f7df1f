#include <gtest/gtest.h>

#include <cmath>

#include "tests/light/sources.h"
#include "tests/statistics/density_checks.h"
#include "tests/statistics/plane_test.h"
#include "tests/statistics/random.h"

// Rays that leave a light have the densities that PdfLe says, of directions and of places.

namespace strata {
namespace {

LePdf Densities(const Light& light, const SceneSphere& scene, const Leaving& ray) {
  return std::visit([&](const auto& l) { return PdfLe(l, scene, ray); }, light);
}
constexpr DensityEffort kEveryDay = {50000, {}};

/// `sample` and `pdf` are those of directions.
void ExpectDensity(DensityChecks* checks, const std::string& name,
                   const std::function<std::optional<Vec3f>(Vec2f)>& sample,
                   const std::function<float(Vec3f)>& pdf, uint64_t seed) {
  TestRandom random(seed);
  const DirectionTestResult result = checks->ExpectDirections(
      name, [&] { return sample(random.Float2()); }, pdf);
  EXPECT_NEAR(result.integral, 1, 2e-3) << name;
}

/// The directions of surfaces around the normal that they leave by; those of others in the world.
void ExpectDensitiesOfDirections(const DensityEffort& effort) {
  const LightFiles files;
  const std::vector<Source> sources = Sources(files);
  DensityChecks checks(sources.size(), effort);
  uint64_t seed = 300;
  for (const Source& source : sources) {
    SceneDescription description;
    source.add(&description);
    const LightScene scene(std::move(description), files.source());
    const Light& light = scene.lights.lights()[0];
    // A portal's density has poles, which have a test of their own.
    if (std::holds_alternative<DistantLight>(light) ||
        std::holds_alternative<PortalEnvironment>(light))
      continue;
    const bool surface = scene.geometry->emitters().size() > 0;
    TestRandom random(seed);
    int rays = 0, differing = 0;
    ExpectDensity(
        &checks, source.name,
        [&](Vec2f u) -> std::optional<Vec3f> {
          const auto emitted = Emit(light, {}, random.Float2(), u);
          if (!emitted) return std::nullopt;
          const Vec3f w = emitted->ray.direction;
          const LePdf pdf =
              Densities(light, {}, {emitted->ray.origin, surface ? emitted->ng : Vec3f{}, w});
          // Beside the edge of a pixel rounding may lead to the next.
          ++rays;
          differing +=
              !(std::abs(pdf.direction - emitted->pdf.direction) <= 2e-3f * pdf.direction &&
                std::abs(pdf.position - emitted->pdf.position) <= 2e-3f * pdf.position);
          return surface ? Frame::FromNormal(emitted->ng).ToLocal(w) : w;
        },
        [&](Vec3f w) {
          // Of the normal's side: half of the rays leave by each, if there are two.
          const LePdf pdf = Densities(light, {}, {{}, {0, 0, 1}, w});
          const bool both = surface && scene.geometry->emitters()[0].two_sided;
          return both ? (w.z > 0 ? 2 * pdf.direction : 0) : pdf.direction;
        },
        seed++);
    EXPECT_LE(differing, rays / 1000) << source.name;
  }
}
TEST(EmissionDensities, OfDirections) { ExpectDensitiesOfDirections(kEveryDay); }
TEST(EmissionDensities, DISABLED_OfDirectionsAreToldFromOnePercentOfShape) {
  ExpectDensitiesOfDirections(kByHand);
}

/// The density of rays through a portal has poles where they graze its plane. By the angles a and b
/// of their projections on the two planes across it, in which a direction is along
/// (tan a, tan b, 1), it has none: it jumps between cells of the portal's table, 64 by 64 of them.
void ExpectDensityOfPortalRays(const DensityEffort& effort) {
  const LightFiles files;
  std::vector<double> edges;
  for (int i = 0; i <= 16; ++i) edges.push_back(i / 16.0);
  const std::vector<std::string> portals = {"portal to a sky", "portal to a striped sky"};
  DensityChecks checks(portals.size(), effort);
  uint64_t seed = 500;
  for (const std::string& name : portals) {
    SceneDescription description;
    for (const Source& source : Sources(files)) {
      if (source.name == name) source.add(&description);
    }
    const LightScene scene(std::move(description), files.source());
    const Light& light = scene.lights.lights().at(0);
    const PlaneCase rays = {
        .name = name,
        .sample = [&](TestRandom& random) -> std::optional<PlanePoint> {
          const Vec2f u_point = random.Float2();
          const auto emitted = Emit(light, {}, u_point, random.Float2());
          if (!emitted) return std::nullopt;
          const Vec3f w = -emitted->ray.direction;
          const auto angle = [&](double across) {
            return 0.5 + std::atan2(across, double{w.z}) / M_PI;
          };
          return PlanePoint{angle(w.x), angle(w.y)};
        },
        .density =
            [&](PlanePoint p) {
              const double x = std::tan(M_PI * (p.x - 0.5)), y = std::tan(M_PI * (p.y - 0.5));
              const double length = std::sqrt(x * x + y * y + 1);
              const double solid_angle =
                  M_PI * M_PI * (1 + x * x) * (1 + y * y) / (length * length * length);
              const Vec3f out = {static_cast<float>(x / length), static_cast<float>(y / length),
                                 static_cast<float>(1 / length)};
              return Densities(light, {}, {{}, {}, -out}).direction * solid_angle;
            },
        .tilt = [](PlanePoint p) { return std::cos(2 * M_PI * p.x); },
        .x_edges = edges,
        .y_edges = edges};
    const PlaneTestResult right = TestPlane(rays, effort.samples, 0, seed);
    EXPECT_NEAR(right.integral, 1, 2e-4);
    checks.Expect(rays.name, right.chi_square,
                  TestPlane(rays, effort.samples, *effort.error, seed++).chi_square);
  }
}
TEST(EmissionDensities, OfRaysThroughAPortal) { ExpectDensityOfPortalRays({200000, 0.1}); }
TEST(EmissionDensities, DISABLED_OfRaysThroughAPortalAreToldFromOnePercentOfShape) {
  ExpectDensityOfPortalRays(kByHand);
}

/// Where rays start, seen as directions from a point to which each hides none of the others: a
/// density by area is one of directions times the squared distance over the cosine.
void ExpectDensitiesOfPlaces(const DensityEffort& effort) {
  const LightFiles files;
  struct Case {
    std::string name;
    Vec3f from;
  };
  // Spheres are looked at from within, all else across; no limb is in view.
  const std::vector<Case> cases = {{"triangle", {0.1f, 0.2f, 0}},
                                   {"rectangle", {0.2f, -0.1f, 0.8f}},
                                   {"rectangle of two sides", {0, 0, 2.5f}},
                                   {"sphere", {0.4f, 0.2f, 1.6f}},
                                   {"disk", {0.4f, 0.3f, 0.7f}},
                                   {"cylinder", {0.35f, 0.05f, 1.45f}},
                                   {"spheroid", {0.35f, 0.05f, 1.45f}},
                                   {"bilinear patch", {0, 0, 0}},
                                   {"textured rectangle", {0.2f, -0.1f, 0.8f}},
                                   {"part of a sphere", {0.35f, 0.05f, 1.45f}},
                                   {"textured sphere", {0.4f, 0.2f, 1.6f}},
                                   {"textured cylinder", {0.35f, 0.05f, 1.45f}}};
  DensityChecks checks(cases.size(), effort);
  uint64_t seed = 400;
  for (const Case& c : cases) {
    SceneDescription description;
    for (const Source& source : Sources(files)) {
      if (source.name == c.name) source.add(&description);
    }
    const LightScene scene(std::move(description), files.source());
    const Light& light = scene.lights.lights()[0];
    TestRandom random(seed);
    ExpectDensity(
        &checks, c.name,
        [&](Vec2f u) -> std::optional<Vec3f> {
          const auto emitted = Emit(light, {}, u, random.Float2());
          if (!emitted) return std::nullopt;
          return Normalize(emitted->ray.origin - c.from);
        },
        [&](Vec3f w) {
          double sum = 0;
          Ray ray = {c.from, w};
          for (Hit hit; scene.geometry->Intersect(ray, &hit);) {
            const SurfacePoint point = scene.geometry->Surface(ray, hit);
            const LePdf pdf = Densities(light, {}, {point.p, point.ng, point.ng});
            sum += AreaToSolidAngle(pdf.position, point.ng, w, LengthSquared(point.p - c.from));
            ray.origin = OffsetRayOrigin(point, w);
          }
          return static_cast<float>(sum);
        },
        seed++);
  }
}
TEST(EmissionDensities, OfPlaces) { ExpectDensitiesOfPlaces(kEveryDay); }
TEST(EmissionDensities, DISABLED_OfPlacesAreToldFromOnePercentOfShape) {
  ExpectDensitiesOfPlaces(kByHand);
}

}  // namespace
}  // namespace strata
