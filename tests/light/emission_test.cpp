#include "worker/light/emission.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/light/light_scene.h"
#include "tests/statistics/density_checks.h"
#include "tests/statistics/plane_test.h"
#include "tests/statistics/random.h"
#include "worker/integrator/path.h"
#include "worker/scene/scene.h"

// Light as it leaves its source. Rays from each light bring a closed box the light's power, and a
// floor what the path tracer finds there; and they have the densities that PdfLe says.

namespace strata {
namespace {

// ---- one of each kind ----

constexpr float kRoom = 4;  ///< Half the edge of the box around everything.

struct Source {
  std::string name;
  std::function<void(SceneDescription*)> add;
  bool afar = false;  ///< Comes from outside the box.
  double power_tolerance = 1e-4;
};

ShapeDescription Emissive(ShapeGeometry geometry, const Transform& to_world, bool two_sided) {
  ShapeDescription shape;
  shape.geometry = std::move(geometry);
  shape.to_world = to_world;
  shape.emission = AreaEmission{{3, 2, 1}, two_sided};
  return shape;
}

/// Faces down, at height 1.5.
TriangleMeshShape Board() {
  TriangleMeshShape mesh;
  mesh.positions = {
      {-0.4f, -0.3f, 1.5f}, {-0.4f, 0.5f, 1.5f}, {0.6f, 0.5f, 1.5f}, {0.6f, -0.3f, 1.5f}};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

const Transform kAbove = Transform::Translate(0.3, 0.1, 1.5);
/// A light's z axis turned down, a little aslant.
const Transform kDown = kAbove * Transform::Rotate(170, 1, 0.3, 0);

std::vector<Source> Sources(const LightFiles& files) {
  TestRandom random(21);
  std::vector<Rgb> picture, sky;
  for (int i = 0; i < 12 * 8; ++i) picture.push_back(Rgb::Gray(i % 7 == 0 ? 0 : random.Float()));
  for (int i = 0; i < 16 * 16; ++i)
    sky.push_back(Rgb::Gray(i % 5 == 0 ? 0 : i == 130 ? 40 : random.Float()));
  files.WriteImage("picture.pfm", 12, 8, picture);
  files.WriteImage("sky.pfm", 16, 16, sky);
  files.Write("lamp.ies",
              "TILT=NONE\n1 -1 1 4 3 1 2 0 0 0 1 1 9\n0 30 60 120\n0 45 90\n"
              "9 7 3 0 9 8 5 2 9 4 1 0\n");
  const auto shape = [](ShapeGeometry geometry, const Transform& to_world, bool two_sided) {
    return [=](SceneDescription* scene) {
      scene->shapes.push_back(Emissive(geometry, to_world, two_sided));
    };
  };
  const auto light = [](decltype(LightDescription::light) description) {
    return [=](SceneDescription* scene) { scene->lights.push_back({{}, description}); };
  };
  TriangleMeshShape triangle = Board();
  triangle.triangles.pop_back();
  BilinearPatchShape patch;
  patch.positions = {
      {-0.5f, -0.5f, 1.4f}, {-0.4f, 0.6f, 1.6f}, {0.5f, -0.5f, 1.7f}, {0.6f, 0.5f, 1.5f}};
  patch.patches = {{0, 1, 2, 3}};
  SpotLightDescription spot;
  spot.position = {0.3, 0.1, 1.5};
  spot.direction = Normalize(Vec3f{0.1f, 0.2f, -1});
  spot.intensity = {3, 2, 1};
  spot.cone_angle = 60;
  spot.falloff_start = 20;
  ProjectionLightDescription projection;
  projection.path = "picture.pfm";
  projection.to_world = kDown;
  GoniometricLightDescription lamp;
  lamp.path = "lamp.ies";
  lamp.to_world = kAbove * Transform::Rotate(100, 1, 0, 0);
  lamp.intensity = {3, 2, 1};
  ImageInfiniteLightDescription image;
  image.path = "sky.pfm";
  image.to_world = Transform::Rotate(20, 1, 2, 3);
  ImageInfiniteLightDescription portal = image;
  portal.portal = {Vec3d{-0.5, -0.4, 1.5}, {-0.5, 0.6, 1.5}, {0.7, 0.6, 1.5}, {0.7, -0.4, 1.5}};
  const auto textured = [](SceneDescription* scene) {
    scene->textures = {ConstantTexture{}, ConstantTexture{{1, 0.8f, 0.2f}},
                       CheckerboardTexture{0, 1, {4, 4}}};
    scene->shapes.push_back(Emissive(Board(), {}, false));
    scene->shapes.back().emission->texture = 2;
  };
  const Transform egg = kAbove * Transform::Scale(0.3, 0.2, 0.4);
  return {
      {"triangle", shape(triangle, {}, false)},
      {"rectangle", shape(Board(), {}, false)},
      {"rectangle of two sides", shape(Board(), {}, true)},
      {"sphere", shape(SphereShape{0.4f, -0.4f, 0.4f, 360}, kAbove, false)},
      {"sphere of two sides", shape(SphereShape{0.4f, -0.4f, 0.4f, 360}, kAbove, true)},
      {"disk", shape(DiskShape{.radius = 0.5f}, kDown, false)},
      {"cylinder", shape(CylinderShape{0.3f, -0.4f, 0.4f, 250}, kDown, true)},
      {"spheroid", shape(SphereShape{1, -1, 1, 360}, egg, false)},
      {"bilinear patch", shape(patch, {}, true)},
      // Its power, and that of the portal, are sums over points of a grid.
      {"textured rectangle", textured, false, 0.02},
      {"point", light(PointLightDescription{{0.3, 0.1, 1.5}, {3, 2, 1}})},
      {"spot", light(spot)},
      {"projection", light(projection)},
      {"goniometric", light(lamp)},
      {"distant", light(DistantLightDescription{Normalize(Vec3f{0.3f, 0.2f, 1}), {3, 2, 1}}), true},
      {"constant sky", light(ConstantInfiniteLightDescription{{3, 2, 1}}), true},
      {"image of a sky", light(image), true},
      {"portal to a sky", light(portal), false, 2e-3},
  };
}

SceneSphere SphereOf(const Geometry& geometry) {
  const Geometry::Bounds bounds = geometry.bounds();
  return {(bounds.min + bounds.max) * 0.5f, 0.5f * Length(bounds.max - bounds.min) * 1.001f};
}

std::optional<EmittedRay> Emit(const Light& light, const SceneSphere& scene, Vec2f u_point,
                               Vec2f u_w) {
  return std::visit([&](const auto& l) { return SampleLe(l, scene, u_point, u_w); }, light);
}
LePdf Densities(const Light& light, const SceneSphere& scene, const Leaving& ray) {
  return std::visit([&](const auto& l) { return PdfLe(l, scene, ray); }, light);
}
Rgb PowerOf(const Light& light, const SceneSphere& scene) {
  return std::visit([&](const auto& l) { return Power(l, scene); }, light);
}

constexpr int kRepetitions = 16;

/// Mean over the replicates of f(u_point, u_direction) at `count` points, spread evenly in four
/// dimensions (Kronecker's sequence by the powers of the root of x^5 = x + 1), each replicate's
/// shifted at random.
MeanWithError MeanOverRays(int count, const std::function<double(Vec2f, Vec2f)>& f) {
  constexpr double kRoot = 1.1673039782614187;
  TestRandom random(77);
  MeanWithError mean;
  for (int replicate = 0; replicate < kRepetitions; ++replicate) {
    std::array<double, 4> x = {random.Double(), random.Double(), random.Double(), random.Double()};
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      double step = 1;
      std::array<float, 4> u;
      for (int d = 0; d < 4; ++d) {
        step /= kRoot;
        x[d] += step;
        x[d] -= std::floor(x[d]);
        u[d] = std::min(static_cast<float>(x[d]), 1 - 0x1p-24f);
      }
      sum += f({u[0], u[1]}, {u[2], u[3]});
    }
    mean.Add(sum / count);
  }
  return mean;
}

MeanWithError MeanOverPaths(uint32_t count, const std::function<double(const SobolSampler&)>& f) {
  MeanWithError mean;
  for (uint32_t replicate = 0; replicate < kRepetitions; ++replicate) {
    SobolSampler sampler({.seed = 5, .replicate = replicate});
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i) {
      sampler.StartSample(i);
      sum += f(sampler);
    }
    mean.Add(sum / count);
  }
  return mean;
}

// ---- energy ----

constexpr double kLevel = 3;  ///< Standard errors.
/// How many rays and paths are taken, and what the standard errors are at most, relative. Every day
/// one per cent; a tenth by hand (docs/stability.md).
struct EnergyEffort {
  int rays_to_box, rays_to_floor, paths;
  double precision;
};
constexpr EnergyEffort kEveryDayEnergy = {4096, 1 << 15, 1 << 13, 1e-2};
constexpr EnergyEffort kByHandEnergy = {1 << 17, 1 << 20, 1 << 19, 1e-3};

void AddBox(SceneDescription* scene) {
  TriangleMeshShape box;
  for (int i = 0; i < 8; ++i)
    box.positions.push_back(
        {i & 1 ? kRoom : -kRoom, i & 2 ? kRoom : -kRoom, i & 4 ? kRoom : -kRoom});
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  ShapeDescription& shape = scene->shapes.emplace_back();
  shape.geometry = box;
}

/// Rays deposit their flux where they land: on the box, or on the light itself (of two sides) and
/// from there no further. Those from afar that pass the box by count too.
void ExpectPowerOnABox(const EnergyEffort& effort) {
  const LightFiles files;
  for (const Source& source : Sources(files)) {
    SceneDescription description;
    source.add(&description);
    AddBox(&description);
    const LightScene scene(std::move(description), files.source());
    ASSERT_EQ(scene.lights.lights().size(), 1u) << source.name;
    const Light& light = scene.lights.lights()[0];
    const SceneSphere sphere = SphereOf(*scene.geometry);
    const double power = PowerOf(light, sphere).g;
    int lost = 0;
    const MeanWithError mean = MeanOverRays(effort.rays_to_box, [&](Vec2f u_point, Vec2f u_w) {
      const auto emitted = Emit(light, sphere, u_point, u_w);
      if (!emitted) return 0.0;
      Hit hit;
      if (!source.afar && !scene.geometry->Intersect(emitted->ray, &hit)) {
        ++lost;
        return 0.0;
      }
      return double{emitted->Flux().g};
    });
    EXPECT_LE(lost, 1) << source.name;
    EXPECT_LE(mean.error(), effort.precision * power) << source.name;
    EXPECT_NEAR(mean.mean(), power, kLevel * mean.error() + source.power_tolerance * power)
        << source.name;
  }
}
TEST(EmissionEnergy, ArrivesOnAClosedBox) { ExpectPowerOnABox(kEveryDayEnergy); }
TEST(EmissionEnergy, DISABLED_ArrivesOnAClosedBoxToATenthOfAPerCent) {
  ExpectPowerOnABox(kByHandEnergy);
}

/// The mean irradiance of a square floor, half under a screen, twice: by rays from the light, and
/// by the path tracer's paths of one bounce from the floor.
void ExpectTheFloorOfThePathTracer(const EnergyEffort& effort) {
  constexpr float kHalf = 1;
  const LightFiles files;
  for (const Source& source : Sources(files)) {
    SceneDescription description;
    source.add(&description);
    TriangleMeshShape floor, screen;
    floor.positions = {
        {-kHalf, -kHalf, 0}, {kHalf, -kHalf, 0}, {kHalf, kHalf, 0}, {-kHalf, kHalf, 0}};
    screen.positions = {
        {0.2f, -0.9f, 0.6f}, {0.7f, -0.9f, 0.6f}, {0.7f, 0.4f, 0.7f}, {0.2f, 0.4f, 0.7f}};
    floor.triangles = screen.triangles = {{0, 1, 2}, {0, 2, 3}};
    for (const TriangleMeshShape& mesh : {floor, screen})
      description.shapes.emplace_back().geometry = mesh;
    description.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
    description.materials.push_back(
        DiffuseMaterial{static_cast<TextureId>(description.textures.size()) - 1});
    const auto scene = Scene::Build(std::move(description), files.source());
    ASSERT_TRUE(scene.ok()) << scene.status();
    const Geometry& geometry = (*scene)->geometry();
    const Light& light = (*scene)->lights().lights().at(0);
    const SceneSphere sphere = SphereOf(geometry);
    const float floor_z = -static_cast<float>((*scene)->origin().z);
    const Vec3f center = {-static_cast<float>((*scene)->origin().x),
                          -static_cast<float>((*scene)->origin().y), floor_z};

    const double area = 4 * kHalf * kHalf;
    const MeanWithError landed = MeanOverRays(effort.rays_to_floor, [&](Vec2f u_point, Vec2f u_w) {
      const auto emitted = Emit(light, sphere, u_point, u_w);
      Hit hit;
      if (!emitted || !(emitted->ray.direction.z < 0) || !geometry.Intersect(emitted->ray, &hit))
        return 0.0;
      const SurfacePoint point = geometry.Surface(emitted->ray, hit);
      return std::abs(point.p.z - floor_z) < 1e-4f ? emitted->Flux().g / area : 0.0;
    });

    const PathSettings settings = {.max_depth = 1};
    const MeanWithError traced = MeanOverPaths(effort.paths, [&](const SobolSampler& sampler) {
      const Vec2f u = sampler.Get2D(kPairFilm);
      const Vec3f above = center + Vec3f{(2 * u.x - 1) * kHalf, (2 * u.y - 1) * kHalf, 0.01f};
      SilentObserver observer;
      PathTracer<SobolSampler, SilentObserver> tracer(**scene, settings, sampler, observer);
      // Radiance of a floor that reflects half is its irradiance over 2 pi.
      return tracer.Trace({above, {0, 0, -1}}).radiance.g * 2 * M_PI;
    });

    const double error = std::hypot(landed.error(), traced.error());
    EXPECT_LE(error, effort.precision * traced.mean()) << source.name;
    EXPECT_NEAR(landed.mean(), traced.mean(), kLevel * error + 2e-5 * traced.mean())
        << source.name << ": " << landed.mean() << " +- " << landed.error() << ", " << traced.mean()
        << " +- " << traced.error();
    std::printf("%-24s %.6f +- %.6f  %.6f +- %.6f\n", source.name.c_str(), landed.mean(),
                landed.error(), traced.mean(), traced.error());
  }
}
TEST(EmissionEnergy, LightsAFloorAsThePathTracerDoes) {
  ExpectTheFloorOfThePathTracer(kEveryDayEnergy);
}
TEST(EmissionEnergy, DISABLED_LightsAFloorToATenthOfAPerCent) {
  ExpectTheFloorOfThePathTracer(kByHandEnergy);
}

// ---- densities ----

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
    // A portal's density has poles, which have a test of their own.
    if (source.name == "distant" || source.name == "portal to a sky") continue;
    SceneDescription description;
    source.add(&description);
    const LightScene scene(std::move(description), files.source());
    const Light& light = scene.lights.lights()[0];
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
  SceneDescription description;
  for (const Source& source : Sources(files)) {
    if (source.name == "portal to a sky") source.add(&description);
  }
  const LightScene scene(std::move(description), files.source());
  const Light& light = scene.lights.lights().at(0);
  std::vector<double> edges;
  for (int i = 0; i <= 16; ++i) edges.push_back(i / 16.0);
  const PlaneCase rays = {
      .name = "rays of a portal",
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
  DensityChecks checks(1, effort);
  const PlaneTestResult right = TestPlane(rays, effort.samples, 0, 500);
  EXPECT_NEAR(right.integral, 1, 2e-4);
  checks.Expect(rays.name, right.chi_square,
                TestPlane(rays, effort.samples, *effort.error, 500).chi_square);
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
                                   {"textured rectangle", {0.2f, -0.1f, 0.8f}}};
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
