#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/light/light_scene.h"
#include "tests/statistics/random.h"
#include "tests/statistics/sphere_quadrature.h"
#include "worker/light/emission.h"

// Spot, projection and goniometric lights against pbrt-v4's definitions, worked out here once more.

namespace strata {
namespace {

const Transform kTurned = Transform::Translate(1, 2, 3) * Transform::Rotate(35, 1, 2, -0.5);
const SceneSphere kNoScene;

template <typename X>
const X& Only(const LightScene& scene) {
  return std::get<X>(scene.lights.lights().at(0));
}

LightScene Build(decltype(LightDescription::light) light,
                 const FileSource& source = DirectorySource(".")) {
  SceneDescription scene;
  scene.lights.push_back({{"test", 1}, std::move(light)});
  return LightScene(std::move(scene), source);
}

Vec3f ToWorld(const Transform& transform, Vec3d v) {
  const Vec3d w = transform.Vector(v);
  const double length = std::sqrt(w.x * w.x + w.y * w.y + w.z * w.z);
  return {static_cast<float>(w.x / length), static_cast<float>(w.y / length),
          static_cast<float>(w.z / length)};
}

/// What a light does is at one place: intensity over the square of the distance.
template <typename X>
void ExpectLiFollowsIntensity(const LightScene& scene) {
  TestRandom random(4);
  int lit = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f from = {4 * random.Float() - 1, 4 * random.Float(), 4 * random.Float() + 1};
    const Vec3f d = from - Only<X>(scene).position;
    const Rgb intensity = Intensity(Only<X>(scene), Normalize(d));
    const std::optional<LightSample> sample = scene.lights.Sample(0, from, random.Float2());
    EXPECT_EQ(sample.has_value(), !IsBlack(intensity));
    if (!sample) continue;
    ++lit;
    EXPECT_TRUE(sample->delta);
    EXPECT_EQ(sample->pdf, 1);
    EXPECT_EQ(sample->end, Only<X>(scene).position);
    EXPECT_NEAR(sample->radiance.g, intensity.g / LengthSquared(d), 1e-4f * sample->radiance.g);
    // The choice among lights leaves none out that gives light.
    EXPECT_GT(scene.lights.Probability(0, {from, {0, 0, 1}}), 0);
  }
  EXPECT_GT(lit, 100);
}

template <typename X>
double IntegratedPower(const LightScene& scene, double tolerance) {
  return IntegrateSphere([&](Vec3f w) { return Intensity(Only<X>(scene), w).g; }, tolerance);
}

// ---- spot ----

SpotLightDescription Spot(float cone, float start) {
  SpotLightDescription spot;
  spot.position = {1, 2, 3};
  spot.direction = ToWorld(kTurned, {0, 0, 1});
  spot.cone_angle = cone;
  spot.falloff_start = start;
  spot.intensity = {1, 2, 3};
  return spot;
}

TEST(SpotLights, FallOffAsASmoothStepOfTheCosine) {
  const LightScene scene = Build(Spot(40, 25));
  const double low = std::cos(40 * M_PI / 180), high = std::cos(25 * M_PI / 180);
  for (double degrees = 0.5; degrees < 60; ++degrees) {
    const double angle = degrees * M_PI / 180;
    const Vec3f w =
        ToWorld(kTurned, {std::sin(angle) * 0.6, std::sin(angle) * 0.8, std::cos(angle)});
    const double t = std::clamp((std::cos(angle) - low) / (high - low), 0.0, 1.0);
    EXPECT_NEAR(Intensity(Only<SpotLight>(scene), w).g, 2 * t * t * (3 - 2 * t), 1e-5) << degrees;
  }
  ExpectLiFollowsIntensity<SpotLight>(scene);
}

/// The intensity's integral over angles to the axis of up to `degrees`, by the midpoint rule.
double IntegratedAroundAxis(const SpotLight& spot, double degrees) {
  constexpr int kSteps = 20000;
  const Frame frame = Frame::FromNormal(spot.axis);
  const double step = degrees * M_PI / 180 / kSteps;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = (i + 0.5) * step;
    const Vec3f w = frame.ToWorld(
        {static_cast<float>(std::sin(angle)), 0, static_cast<float>(std::cos(angle))});
    sum += 2 * M_PI * std::sin(angle) * step * Intensity(spot, w).g;
  }
  return sum;
}

TEST(SpotLights, OfAnyWidthHaveTheirPower) {
  for (const auto& [cone, start] :
       {std::pair{90.0f, 0.0f}, {180.0f, 180.0f}, {30.0f, 25.0f}, {20.0f, 20.0f}, {2.0f, 1.0f}}) {
    const LightScene scene = Build(Spot(cone, start));
    const double power = Power(Only<SpotLight>(scene), kNoScene).g;
    EXPECT_NEAR(IntegratedAroundAxis(Only<SpotLight>(scene), cone), power, 1e-4 * power) << cone;
    const double mean_cosine = 0.5 * (std::cos(cone * M_PI / 180) + std::cos(start * M_PI / 180));
    EXPECT_NEAR(power, 2 * 2 * M_PI * (1 - mean_cosine), 1e-5 * power) << cone;
  }
}

/// A degree of a degree: float's cosine cannot tell it from 0.
TEST(SpotLights, MayBeVeryNarrow) {
  const LightScene scene = Build(Spot(0.02f, 0.01f));
  const SpotLight& spot = Only<SpotLight>(scene);
  const Frame frame = Frame::FromNormal(spot.axis);
  const auto at = [&](float degrees) {
    return Intensity(spot, Normalize(frame.ToWorld({0, degrees * kPi / 180, 1}))).g;
  };
  EXPECT_NEAR(at(0.009f), 2, 1e-3);
  EXPECT_NEAR(at(0.0158f), 2 * 0.5, 0.02);  // Its square lies midway between the others'.
  EXPECT_EQ(at(0.0202f), 0);
}

// ---- projection ----

/// Six by four pixels, no two alike.
std::vector<Rgb> Picture() {
  std::vector<Rgb> pixels;
  for (int i = 0; i < 24; ++i) pixels.push_back({0.1f, 0.2f + static_cast<float>(i), 0.3f});
  return pixels;
}

ProjectionLightDescription Projector(float fov) {
  ProjectionLightDescription projector;
  projector.path = "picture.pfm";
  projector.to_world = kTurned;
  projector.fov = fov;
  projector.scale = 2;
  return projector;
}

TEST(ProjectionLights, ShowTheirPictureUpright) {
  const LightFiles files;
  files.WriteImage("picture.pfm", 6, 4, Picture());
  const LightScene scene = Build(Projector(50), files.source());
  const double half = std::tan(25 * M_PI / 180);  // Of the shorter side, which is the height.
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 6; ++x) {
      for (const double off : {0.05, 0.5, 0.95}) {
        const Vec3f w =
            ToWorld(kTurned, {((x + off) / 3 - 1) * 1.5 * half, (1 - (y + off) / 2) * half, 1});
        EXPECT_FLOAT_EQ(Intensity(Only<ProjectionLight>(scene), w).g,
                        2 * Picture()[static_cast<size_t>(y * 6 + x)].g);
      }
    }
  }
  for (const Vec3d outside : {Vec3d{1.51 * half, 0, 1},
                              {0, 1.01 * half, 1},
                              {0, -1.01 * half, 1},
                              {0, 0, -1},
                              {0.1, 0.1, -1},
                              {1, 0, 0}})
    EXPECT_TRUE(IsBlack(Intensity(Only<ProjectionLight>(scene), ToWorld(kTurned, outside))));
  ExpectLiFollowsIntensity<ProjectionLight>(scene);
}

/// The intensity's integral over the rectangle at the distance 1, by the midpoint rule.
double IntegratedOverPicture(const LightScene& scene, float fov) {
  constexpr int kColumns = 600, kRows = 400;
  const double half = std::tan(fov * M_PI / 360), cell = 2 * half / kRows;
  double sum = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double x = (column + 0.5 - kColumns / 2) * cell, y = (row + 0.5 - kRows / 2) * cell;
      const Vec3f w = ToWorld(kTurned, {x, y, 1});
      sum += Intensity(Only<ProjectionLight>(scene), w).g * cell * cell /
             std::pow(1 + x * x + y * y, 1.5);
    }
  }
  return sum;
}

TEST(ProjectionLights, HaveTheirPower) {
  const LightFiles files;
  files.WriteImage("picture.pfm", 6, 4, Picture());
  for (const float fov : {20.0f, 90.0f, 150.0f}) {
    const LightScene scene = Build(Projector(fov), files.source());
    const double power = Power(Only<ProjectionLight>(scene), kNoScene).g;
    EXPECT_NEAR(IntegratedOverPicture(scene, fov), power, 1e-3 * power) << fov;
    ProjectionLightDescription powered = Projector(fov);
    powered.power = 60;
    const LightScene other = Build(powered, files.source());
    EXPECT_NEAR(Luminance(Power(Only<ProjectionLight>(other), kNoScene)), 60, 1e-3);
  }
}

// ---- goniometric ----

GoniometricLightDescription Lamp(const std::string& path) {
  GoniometricLightDescription lamp;
  lamp.path = path;
  lamp.to_world = kTurned;
  lamp.intensity = {1, 2, 3};
  return lamp;
}

TEST(GoniometricLights, ShineAsTheirDiagramSaysWithTheSecondAxisUp) {
  const LightFiles files;
  constexpr int kSize = 512;  // Look-ups between pixels err by the square of their size, or,
                              // across the map's folds, by the size itself.
  const auto shape = [](Vec3f d) { return 2 + d.x - 0.5f * d.y + 0.8f * d.z * d.z * d.z; };
  std::vector<Rgb> pixels;
  for (int i = 0; i < kSize * kSize; ++i) {
    const Vec3f d = EqualAreaSquareToSphere({(static_cast<float>(i % kSize) + 0.5f) / kSize,
                                             (static_cast<float>(i / kSize) + 0.5f) / kSize});
    pixels.push_back({shape(d) - 0.3f, shape(d), shape(d) + 0.3f});  // The mean counts.
  }
  files.WriteImage("lamp.pfm", kSize, kSize, pixels);
  const LightScene scene = Build(Lamp("lamp.pfm"), files.source());
  TestRandom random(9);
  for (int i = 0; i < 5000; ++i) {
    const Vec3f d = SampleUniformSphere(random.Float2());
    // pbrt-v4: the diagram's x, y, z are the light's x, z, y.
    const Vec3f w = ToWorld(kTurned, {d.x, d.z, d.y});
    EXPECT_NEAR(Intensity(Only<GoniometricLight>(scene), w).g, 2 * shape(d), 0.01);
  }
  ExpectLiFollowsIntensity<GoniometricLight>(scene);
}

/// Longitudes go from the light's x to its z, colatitudes from its y.
TEST(GoniometricLights, MayBeMappedByLatitudeAndLongitude) {
  const LightFiles files;
  constexpr int kWidth = 512, kHeight = 256;
  const auto shape = [](Vec3f d) { return 2 + d.x - 0.5f * d.y + 0.8f * d.z * d.z * d.z; };
  std::vector<Rgb> pixels;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const double longitude = 2 * M_PI * (i % kWidth + 0.5) / kWidth;
    const double colatitude = M_PI * (i / kWidth + 0.5) / kHeight;
    pixels.push_back(
        Rgb::Gray(shape({static_cast<float>(std::sin(colatitude) * std::cos(longitude)),
                         static_cast<float>(std::sin(colatitude) * std::sin(longitude)),
                         static_cast<float>(std::cos(colatitude))})));
  }
  files.WriteImage("lamp.pfm", kWidth, kHeight, pixels);
  GoniometricLightDescription lamp = Lamp("lamp.pfm");
  lamp.mapping = EnvironmentMapping::kLatLong;
  const LightScene scene = Build(lamp, files.source());
  TestRandom random(11);
  for (int i = 0; i < 5000; ++i) {
    const Vec3f d = SampleUniformSphere(random.Float2());
    // Two look-ups between pixels of at most 0.7 degrees, of a shape whose slope is below 3.
    EXPECT_NEAR(Intensity(Only<GoniometricLight>(scene), ToWorld(kTurned, {d.x, d.z, d.y})).g,
                2 * shape(d), 2 * 3 * 0.0123);
  }
}

TEST(GoniometricLights, HaveTheirPower) {
  const LightFiles files;
  TestRandom random(10);
  std::vector<Rgb> pixels;
  for (int i = 0; i < 15 * 15; ++i) pixels.push_back(Rgb::Gray(i % 3 == 0 ? 0 : random.Float()));
  files.WriteImage("lamp.pfm", 15, 15, pixels);
  const LightScene scene = Build(Lamp("lamp.pfm"), files.source());
  const double power = Power(Only<GoniometricLight>(scene), kNoScene).g;
  EXPECT_NEAR(IntegratedPower<GoniometricLight>(scene, 1e-4 * power), power, 1e-3 * power);
  GoniometricLightDescription powered = Lamp("lamp.pfm");
  powered.power = 60;
  const LightScene other = Build(powered, files.source());
  EXPECT_NEAR(Luminance(Power(Only<GoniometricLight>(other), kNoScene)), 60, 1e-3);
}

TEST(PointLights, ThatCannotBeMadeAreLocated) {
  const LightFiles files;
  files.WriteImage("wide.pfm", 2, 1, {Rgb::Gray(1), Rgb::Gray(1)});
  files.WriteImage("black.pfm", 1, 1, {Rgb{}});
  files.WriteImage("negative.pfm", 1, 1, {{1, -1, 1}});
  ProjectionLightDescription dark = Projector(50), negative = dark, sheared = dark;
  dark.path = "black.pfm";
  dark.power = 10;
  negative.path = "negative.pfm";
  sheared.path = "wide.pfm";
  sheared.to_world =
      Transform::Rotate(30, 0, 0, 1) * Transform::Scale(1, 2, 1) * Transform::Rotate(30, 0, 0, 1);
  GoniometricLightDescription black = Lamp("black.pfm");
  black.power = 10;
  struct Case {
    decltype(LightDescription::light) light;
    std::string part;
  };
  for (const Case& c : {Case{dark, "black"},
                        {negative, "negative"},
                        {sheared, "shears"},
                        {black, "black"},
                        {Lamp("wide.pfm"), "square"},
                        {Lamp("no.ies"), "no.ies"}}) {
    SceneDescription scene;
    scene.lights.push_back({{"room.pbrt", 8}, c.light});
    const auto geometry = *Geometry::Build(scene);
    const auto textures = *TextureSet::Load({}, files.source());
    const absl::Status status =
        LightSet::Build(scene, *geometry, *textures, files.source()).status();
    EXPECT_EQ(std::string(status.message()).find("room.pbrt:8: "), 0u) << status;
    EXPECT_NE(std::string(status.message()).find(c.part), std::string::npos) << status;
  }
}

// ---- the choice among them ----

TEST(PointLights, AreNotChosenWhereTheyDoNotShine) {
  SceneDescription scene;
  SpotLightDescription down;
  down.position = {0, 0, 5};
  down.direction = {0, 0, -1};
  down.cone_angle = 20;
  down.falloff_start = 15;
  down.intensity = Rgb::Gray(1000);
  scene.lights.push_back({{}, down});
  scene.lights.push_back({{}, PointLightDescription{{0, 0, 5}, Rgb::Gray(1)}});
  const LightScene built(std::move(scene));
  const auto chance = [&](Vec3f p) { return built.lights.Probability(0, {p, {0, 0, 1}, true}); };
  EXPECT_GT(chance({0, 0, 0}), 0.98);
  EXPECT_GT(chance({1.7f, 0, 0}), 0.9);   // Just within: 18.8 degrees.
  EXPECT_LT(chance({2.5f, 0, 0}), 0.01);  // One in a hundred choices is among all alike.
  EXPECT_LT(chance({5, 0, 0}), 0.01);
}

}  // namespace
}  // namespace strata
