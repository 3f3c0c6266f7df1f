#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tests/light/sources.h"
#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"
#include "worker/integrator/path.h"
#include "worker/scene/scene.h"

// Rays from each light bring a closed box the light's power, and a floor what the path tracer finds
// there.

namespace strata {
namespace {

constexpr float kRoom = 4;  ///< Half the edge of the box around everything.

SceneSphere SphereOf(const Geometry& geometry) {
  const Geometry::Bounds bounds = geometry.bounds();
  return {(bounds.min + bounds.max) * 0.5f, 0.5f * Length(bounds.max - bounds.min) * 1.001f};
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

/// Standard errors. Of the 15 degrees of freedom that kRepetitions leave, one mean in 110 is
/// further off by chance; seeds are fixed.
constexpr double kLevel = 3;
/// Of controls, in the standard errors that are allowed at most: more than twice kLevel.
constexpr double kControl = 7;

/// How many rays and paths are taken, and what the standard errors are at most, relative. By hand:
/// see docs/stability.md.
struct EnergyEffort {
  int rays_to_box;
  double box_precision;
  int rays_to_floor, paths;
  double floor_precision;
};
constexpr EnergyEffort kEveryDayEnergy = {1 << 14, 1e-3, 1 << 15, 1 << 13, 1e-2};
constexpr EnergyEffort kByHandEnergy = {1 << 18, 3e-4, 1 << 20, 1 << 19, 1e-3};

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

/// The area of the box's shadow in the direction `w`: of each pair of faces one, foreshortened.
double BoxShadow(Vec3f w) {
  return 4 * kRoom * kRoom *
         (std::abs(double{w.x}) + std::abs(double{w.y}) + std::abs(double{w.z}));
}

/// The integral over the sphere of the green radiance times `factor`, which must not jump: by the
/// midpoints of parts of each pixel, within which the radiance is constant.
double IntegrateSky(const EnvironmentImage& image, const std::function<double(Vec3f)>& factor) {
  constexpr int kLeast = 1000;
  const int columns = (kLeast / image.width + 1) * image.width;
  const int rows = (kLeast / image.height + 1) * image.height;
  double sum = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vec3f local = SquareToSphere(
          image.mapping,
          {(static_cast<float>(column) + 0.5f) / columns, (static_cast<float>(row) + 0.5f) / rows});
      const Vec3f w = image.axes.ToWorld(local);
      sum += Le(ImageEnvironment{&image}, w).g * factor(w) * SphereDensity(image.mapping, local);
    }
  }
  return sum / columns / rows;
}

double EverySide(Vec3f) { return 1; }

/// The power that lands on the box: of light from afar the irradiance times the box's shadow, over
/// all directions; through a portal, what the sky sends into its front. A convex box's shadow is on
/// average a quarter of its surface, so that an even sky brings pi times its radiance to each area.
double PowerOnBox(const Light& light, const SceneSphere& sphere) {
  if (const auto* distant = std::get_if<DistantLight>(&light))
    return distant->irradiance.g * BoxShadow(distant->direction);
  if (const auto* constant = std::get_if<ConstantEnvironment>(&light))
    return M_PI * constant->radiance.g * 24 * kRoom * kRoom;
  if (const auto* sky = std::get_if<ImageEnvironment>(&light))
    return IntegrateSky(*sky->image, BoxShadow);
  if (const auto* portal = std::get_if<PortalEnvironment>(&light)) {
    const Vec3f outwards = portal->portal->axes.z;
    return portal->portal->Area() * IntegrateSky(portal->portal->sky, [&](Vec3f w) {
             return std::max(0.0, double{Dot(w, outwards)});
           });
  }
  return PowerOf(light, sphere).g;
}

bool IsFromAfar(const Light& light) {
  return std::holds_alternative<DistantLight>(light) ||
         std::holds_alternative<ConstantEnvironment>(light) ||
         std::holds_alternative<ImageEnvironment>(light);
}

/// A light amid the closed box.
struct BoxedLight {
  BoxedLight(const Source& source, const LightFiles& files)
      : scene(Describe(source), files.source()) {
    EXPECT_EQ(scene.lights.lights().size(), 1u) << source.name;
  }
  static SceneDescription Describe(const Source& source) {
    SceneDescription description;
    source.add(&description);
    AddBox(&description);
    return description;
  }
  const Light& light() const { return scene.lights.lights().at(0); }

  LightScene scene;
  SceneSphere sphere = SphereOf(*scene.geometry);
};

/// Rays deposit their flux where they land: on the box, or on the light itself (of two sides) and
/// from there no further. Those from afar may pass the box by.
void ExpectPowerOnABox(const EnergyEffort& effort) {
  const LightFiles files;
  for (const Source& source : Sources(files)) {
    const BoxedLight boxed(source, files);
    const bool afar = IsFromAfar(boxed.light());
    const double power = PowerOnBox(boxed.light(), boxed.sphere);
    int past = 0;
    const int rays = effort.rays_to_box * (afar ? 2 : 1);
    const MeanWithError mean = MeanOverRays(rays, [&](Vec2f u_point, Vec2f u_w) {
      const auto emitted = Emit(boxed.light(), boxed.sphere, u_point, u_w);
      if (!emitted) return 0.0;
      Hit hit;
      if (boxed.scene.geometry->Intersect(emitted->ray, &hit)) return double{emitted->Flux().g};
      ++past;
      return 0.0;
    });
    // Of the disk that light from afar comes through, no direction's shadow of the box is all.
    if (afar)
      EXPECT_GT(past, rays) << source.name;
    else
      EXPECT_LE(past, 1) << source.name;
    EXPECT_LE(mean.error(), effort.box_precision * power) << source.name;
    const double allowed = kLevel * mean.error() + source.power_tolerance * power;
    EXPECT_NEAR(mean.mean(), power, allowed) << source.name;
    // The control.
    const double off_by = kControl * effort.box_precision;
    for (const double off : {1 - off_by, 1 + off_by})
      EXPECT_GT(std::abs(mean.mean() - off * power), allowed) << source.name;
    std::printf("%-30s %.6f +- %.6f  %.6f\n", source.name.c_str(), mean.mean(), mean.error(),
                power);
  }
}
TEST(EmissionEnergy, ArrivesOnAClosedBox) { ExpectPowerOnABox(kEveryDayEnergy); }
TEST(EmissionEnergy, DISABLED_ArrivesOnAClosedBoxToThreeHundredthsOfAPerCent) {
  ExpectPowerOnABox(kByHandEnergy);
}

/// No rays here: what Power says of light from afar is not what reaches the box, but what comes
/// through the disk, and that of a portal is a sum over points of a grid.
TEST(EmissionEnergy, OfSkiesIsTheirRadianceOverAllDirections) {
  const LightFiles files;
  int skies = 0;
  for (const Source& source : Sources(files)) {
    const BoxedLight boxed(source, files);
    const SceneSphere& sphere = boxed.sphere;
    const double power = PowerOf(boxed.light(), sphere).g;
    const double disk = M_PI * sphere.radius * sphere.radius;
    double tolerance = 1e-5, expected = 0;
    if (const auto* distant = std::get_if<DistantLight>(&boxed.light())) {
      expected = distant->irradiance.g * disk;
    } else if (const auto* constant = std::get_if<ConstantEnvironment>(&boxed.light())) {
      expected = 4 * M_PI * constant->radiance.g * disk;
    } else if (const auto* sky = std::get_if<ImageEnvironment>(&boxed.light())) {
      expected = IntegrateSky(*sky->image, EverySide) * disk;
    } else if (std::holds_alternative<PortalEnvironment>(boxed.light())) {
      expected = PowerOnBox(boxed.light(), sphere);
      // The grid is blind to where between its points the radiance of pixels jumps, if it does.
      tolerance = source.name == "portal to a sky" ? 3e-4 : 5e-5;
    } else {
      continue;
    }
    ++skies;
    EXPECT_NEAR(power, expected, tolerance * expected) << source.name;
    std::printf("%-30s %.7f %.7f %g\n", source.name.c_str(), power, expected, power / expected - 1);
  }
  EXPECT_EQ(skies, 6);
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
    const double allowed = kLevel * error + 2e-5 * traced.mean();
    EXPECT_LE(error, effort.floor_precision * traced.mean()) << source.name;
    EXPECT_NEAR(landed.mean(), traced.mean(), allowed)
        << source.name << ": " << landed.mean() << " +- " << landed.error() << ", " << traced.mean()
        << " +- " << traced.error();
    // The control.
    const double off_by = kControl * effort.floor_precision;
    for (const double off : {1 - off_by, 1 + off_by})
      EXPECT_GT(std::abs(off * landed.mean() - traced.mean()), allowed) << source.name;
    std::printf("%-30s %.6f +- %.6f  %.6f +- %.6f\n", source.name.c_str(), landed.mean(),
                landed.error(), traced.mean(), traced.error());
  }
}
TEST(EmissionEnergy, LightsAFloorAsThePathTracerDoes) {
  ExpectTheFloorOfThePathTracer(kEveryDayEnergy);
}
TEST(EmissionEnergy, DISABLED_LightsAFloorToATenthOfAPerCent) {
  ExpectTheFloorOfThePathTracer(kByHandEnergy);
}

}  // namespace
}  // namespace strata
