#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/statistics/chi_square.h"
#include "tests/transport/kernels.h"
#include "tests/transport/test_scene.h"
#include "worker/sampling/henyey_greenstein.h"
#include "worker/sampling/sampler.h"

// Participating media against closed forms, quadrature and each other. ExpectMean and Agree test at
// p = 1e-5 with controls of their own.

namespace strata {
namespace {

constexpr Rgb kThin = {0.3f, 0.8f, 2.0f};

MediumId AddMedium(TestScene& scene, const MediumDescription& medium) {
  scene.description.media.push_back(medium);
  return static_cast<MediumId>(scene.description.media.size()) - 1;
}

/// A ball around the origin that is nothing but the border of a medium.
void AddBall(TestScene& scene, float radius, MediumBorder border) {
  scene.Sphere({0, 0, 0}, radius, scene.Material(InterfaceMaterial{}));
  scene.description.shapes.back().border = border;
}

/// The camera in the middle of a ball of a medium under a sky of radiance `sky`.
TestScene BallOf(const MediumDescription& medium, float radius, float sky = 1) {
  TestScene scene;
  const MediumId id = AddMedium(scene, medium);
  AddBall(scene, radius, {id, kNoMedium});
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(sky)});
  scene.Camera({0, 0, 0}, {0, 0, 1}, 40);
  scene.description.camera.medium = id;
  return scene;
}

/// `detectable` is the part by which the control is too large.
void ExpectColor(const Partial& partial, std::array<double, 3> truth, double detectable = 0.01) {
  for (int channel = 0; channel < 3; ++channel) {
    const Estimate mean = FrameMean(partial, channel);
    EXPECT_TRUE(Agrees(mean, truth[channel]))
        << "channel " << channel << ": " << mean.mean << " +- " << mean.standard_error << ", not "
        << truth[channel];
    EXPECT_FALSE(Agrees(mean, truth[channel] * (1 + detectable))) << mean.standard_error;
  }
}

TEST(Media, AbsorptionFollowsBeersLaw) {
  const Partial partial =
      RenderFrame(BuildScene(BallOf({.absorption = kThin}, 1.5f)), TestSpec(8, 8, 3));
  ExpectColor(partial,
              {std::exp(-1.5 * kThin.r), std::exp(-1.5 * kThin.g), std::exp(-1.5 * kThin.b)});
}

TEST(Media, ShadowRaysFadeInEveryMediumTheyCross) {
  // A lamp outside of two nested balls lights the middle of a small plate inside both.
  TestScene scene;
  const MediumId inner = AddMedium(scene, {.absorption = {0.2f, 0.4f, 0.8f}});
  const MediumId outer = AddMedium(scene, {.absorption = {0.1f, 0.2f, 0.0f}});
  AddBall(scene, 1, {inner, outer});
  AddBall(scene, 2, {outer, kNoMedium});
  scene.Polygon({{-0.01f, 0, -0.01f}, {-0.01f, 0, 0.01f}, {0.01f, 0, 0.01f}, {0.01f, 0, -0.01f}},
                scene.Diffuse(0.5f));
  scene.Light(PointLightDescription{{0, 3, 0}, Rgb::Gray(9)});
  scene.Camera({0.5f, 0.5f, 0}, {0, 0, 0}, 0.2f);
  scene.description.camera.medium = inner;
  const Partial partial = RenderFrame(BuildScene(scene), TestSpec(4, 8, 1));
  const double to_camera = std::sqrt(0.5);
  const auto truth = [&](double in, double out) {
    return 0.5 / std::numbers::pi * std::exp(-in * (1 + to_camera) - out);
  };
  // The plate is no point: its corners lie 0.014 off its middle.
  for (int channel = 0; channel < 3; ++channel) {
    const double expected = channel == 0   ? truth(0.2, 0.1)
                            : channel == 1 ? truth(0.4, 0.2)
                                           : truth(0.8, 0.0);
    EXPECT_NEAR(FrameMean(partial, channel).mean / expected, 1, 2e-3) << channel;
  }
}

TEST(Media, SurfacesPartMediaWhereLightGoesThrough) {
  // Glass of index 1 reflects nothing: a ball of it is a ball of its medium.
  TestScene scene;
  const MediumId inside = AddMedium(scene, {.absorption = kThin});
  scene.Sphere({0, 0, 3}, 1, scene.Material(DielectricMaterial{.eta = 1}));
  scene.description.shapes.back().border = MediumBorder{inside, kNoMedium};
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(1)});
  scene.Camera({0, 0, 0}, {0, 0, 1}, 0.1f);
  ExpectColor(RenderFrame(BuildScene(scene), TestSpec(4, 8, 5)),
              {std::exp(-2 * kThin.r), std::exp(-2 * kThin.g), std::exp(-2 * kThin.b)});
}

TEST(Media, AnOrientationTurnedRoundExchangesTheSides) {
  TestScene scene;
  const MediumId inside = AddMedium(scene, {.absorption = kThin});
  AddBall(scene, 1, {kNoMedium, inside});
  scene.description.shapes.back().reverse_orientation = true;
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(1)});
  scene.Camera({0, 0, -3}, {0, 0, 0}, 0.1f);
  ExpectColor(RenderFrame(BuildScene(scene), TestSpec(4, 8, 5)),
              {std::exp(-2 * kThin.r), std::exp(-2 * kThin.g), std::exp(-2 * kThin.b)});
}

TEST(Media, WhatScattersAndAbsorbsNothingIsSeenByNobody) {
  // The furnace of media, of another density in each channel.
  for (const float g : {-0.6f, 0.0f, 0.9f}) {
    SCOPED_TRACE(g);
    const TestScene scene = BallOf({.scattering = {0.5f, 1.5f, 4}, .g = g}, 1);
    ExpectColor(RenderFrame(BuildScene(scene), TestSpec(16, 1024, 2000)), {1, 1, 1}, 0.02);
  }
}

TEST(Media, WhatEmitsAsMuchAsItAbsorbsIsSeenByNobody) {
  const TestScene scene = BallOf({.absorption = {0.4f, 1, 2},
                                  .scattering = {1.5f, 0.8f, 0.5f},
                                  .emission = {1, 1, 1},
                                  .g = 0.3f},
                                 1);
  ExpectColor(RenderFrame(BuildScene(scene), TestSpec(16, 1024, 2000)), {1, 1, 1});
}

TEST(Media, ABallGlowsByTheLengthOfItsRays) {
  const TestScene scene = BallOf({.absorption = kThin, .emission = {3, 2, 1}}, 1.5f, 0);
  ExpectColor(RenderFrame(BuildScene(scene), TestSpec(4, 8, 3)),
              {3 * -std::expm1(-1.5 * kThin.r), 2 * -std::expm1(-1.5 * kThin.g),
               -std::expm1(-1.5 * kThin.b)});
}

/// What the camera in the middle of a ball of radius 1 sees of light that was scattered at most
/// once: by the midpoint rule in distance and in the cosine of the angle that light was turned by.
double OnceScattered(double absorption, double scattering, float g) {
  const double extinction = absorption + scattering;
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) / kSteps;
    double arriving = 0;
    for (int j = 0; j < kSteps; ++j) {
      const double cosine = 2 * (j + 0.5) / kSteps - 1;  // To the way on, away from the camera.
      // From a distance s off the middle to the ball.
      const double way = -s * cosine + std::sqrt(1 - s * s * (1 - cosine * cosine));
      const Vec3f w = {static_cast<float>(std::sqrt(1 - cosine * cosine)), 0,
                       static_cast<float>(cosine)};
      arriving +=
          HenyeyGreensteinPdf(w, g) * 4 * std::numbers::pi / kSteps * std::exp(-extinction * way);
    }
    sum += scattering * std::exp(-extinction * s) * arriving / kSteps;
  }
  return std::exp(-extinction) + sum;
}

TEST(Media, SingleScatteringIsThatOfQuadrature) {
  const MediumDescription medium = {
      .absorption = {0.5f, 0.2f, 0}, .scattering = {0.4f, 1.5f, 3}, .g = 0.5f};
  const Partial partial = RenderFrame(BuildScene(BallOf(medium, 1)), TestSpec(16, 2048, 1));
  const auto truth = [&](float a, float s) { return OnceScattered(a, s, medium.g); };
  ExpectColor(partial, {truth(0.5f, 0.4f), truth(0.2f, 1.5f), truth(0, 3)});
}

/// Fog between walls with a lamp, a glass ball of another medium, a ball in the fog that is nothing
/// but a border, and a sky behind.
TestScene FoggyRoom() {
  TestScene scene;
  const MediumId fog =
      AddMedium(scene, {.absorption = {0.02f, 0.05f, 0.1f}, .scattering = kThin * 0.3f, .g = 0.4f});
  const MediumId juice = AddMedium(scene, {.absorption = {0.1f, 1, 2}, .scattering = {1, 1, 1}});
  const MediumId glow = AddMedium(
      scene, {.absorption = {1, 1, 1}, .scattering = {2, 0, 1}, .emission = {0.5f, 0.2f, 0.1f}});
  const MaterialId black = scene.Diffuse(0.0f);
  scene.Polygon({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}}, scene.Diffuse(0.5f));
  scene.Polygon({{-3, 0, 3}, {-3, 4, 3}, {3, 4, 3}, {3, 0, 3}}, scene.Diffuse({0.7f, 0.5f, 0.3f}));
  scene.Polygon({{-1, 3, 1}, {1, 3, 1}, {0, 3, 2.5f}}, black, Emits(9, true));
  scene.Sphere({-1, 0.8f, 1}, 0.7f, scene.Material(DielectricMaterial{.eta = 1.4f}));
  scene.description.shapes.back().border = MediumBorder{juice, fog};
  scene.Sphere({1.2f, 0.8f, 1}, 0.7f, scene.Material(InterfaceMaterial{}));
  scene.description.shapes.back().border = MediumBorder{glow, fog};
  AddBall(scene, 8, {fog, kNoMedium});
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(0.4f)});
  scene.Camera({0, 2, -4}, {0, 0.8f, 1}, 45);
  scene.description.camera.medium = fog;
  return scene;
}

TEST(Media, StrategiesAgree) {
  const auto scene = BuildScene(FoggyRoom());
  JobSpec spec = TestSpec(24, 1024, 6);
  const Estimate mis = FrameMean(RenderFrame(scene, spec), 1);
  for (const DirectStrategy strategy : {DirectStrategy::kLightOnly, DirectStrategy::kBsdfOnly,
                                        DirectStrategy::kCosine, DirectStrategy::kUniform}) {
    ++spec.seed;
    const Estimate single = FrameMean(RenderFrame(scene, spec, strategy), 1);
    EXPECT_TRUE(Agree(mis, single))
        << mis.mean << " +- " << mis.standard_error << ", " << ToString(strategy) << " "
        << single.mean << " +- " << single.standard_error;
    EXPECT_FALSE(Agree({mis.mean * 1.06, mis.standard_error}, single))
        << ToString(strategy) << ": " << single.standard_error;
  }
}

TEST(Media, KernelsTraceTheSamePaths) {
  JobSpec spec = TestSpec(32, 64, 20);
  spec.channels = {.alpha = true, .albedo = true, .normal = true, .depth = true};
  const TestScene room = FoggyRoom();
  EXPECT_GE(AgreeingShare(BuildScene(room), spec, 1e-5), 0.999);
  // With an object of which one copy moves.
  constexpr size_t kGlow = 4;
  TestScene moving = room;
  ObjectDescription object = {"ball", {moving.description.shapes[kGlow]}};
  moving.description.shapes.erase(moving.description.shapes.begin() + kGlow);
  moving.description.objects.push_back(object);
  moving.description.instances.push_back({{"test", 1}, 0, Transform(), std::nullopt});
  moving.description.instances.push_back(
      {{"test", 1}, 0, Transform::Translate(0, 1, 0), Transform::Translate(0.5, 1.5, 0)});
  EXPECT_GE(AgreeingShare(BuildScene(moving), spec, 1e-5), 0.999);
  // Without borders that are no surfaces, in unbounded fog.
  TestScene unbounded = room;
  std::erase_if(unbounded.description.shapes, [&](const ShapeDescription& shape) {
    return std::holds_alternative<InterfaceMaterial>(
        unbounded.description.materials[shape.material]);
  });
  const auto built = BuildScene(unbounded);
  EXPECT_EQ(built->media().borders(), nullptr);
  EXPECT_FALSE(built->media().only_absorbs());
  EXPECT_GE(AgreeingShare(built, spec, 1e-5), 0.999);
  // Where media only absorb, which the fast kernel does side by side.
  for (MediumDescription& medium : unbounded.description.media)
    medium.scattering = medium.emission = {};
  const auto clear = BuildScene(unbounded);
  EXPECT_TRUE(clear->media().only_absorbs());
  EXPECT_GE(AgreeingShare(clear, spec, 1e-5), 0.999);
}

TEST(Media, InstancesOfBordersAreWhereTheyArePlaced) {
  TestScene scene = BallOf({.absorption = kThin}, 0.75f);
  scene.description.objects.push_back({"ball", {scene.description.shapes[0]}});
  scene.description.shapes.clear();
  scene.description.instances.push_back(
      {{"test", 1}, 0, Transform::Translate(5, 1, 2) * Transform::Scale(-2, 2, 2), std::nullopt});
  scene.Camera({5, 1, 2}, {5, 1, 7}, 40);
  ExpectColor(RenderFrame(BuildScene(scene), TestSpec(8, 8, 3)),
              {std::exp(-1.5 * kThin.r), std::exp(-1.5 * kThin.g), std::exp(-1.5 * kThin.b)});
}

TEST(Media, AllOfAShadowRaysWayFades) {
  // Thirty optical depths above a plate: a part of 1e-4 of the way would be seen.
  TestScene scene;
  const MediumId dense = AddMedium(scene, {.absorption = {10, 10, 10}});
  scene.Polygon({{-0.01f, 0, -0.01f}, {-0.01f, 0, 0.01f}, {0.01f, 0, 0.01f}, {0.01f, 0, -0.01f}},
                scene.Diffuse(1.0f));
  scene.Light(PointLightDescription{{0, 3, 0}, Rgb::Gray(1e10f)});
  scene.Camera({0, 0.1f, 0}, {0, 0, 0}, 0.001f);
  scene.description.camera.medium = dense;
  const double truth = 1e10 / 9 / std::numbers::pi * std::exp(-30.0 - 1.0);
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    JobSpec spec = TestSpec(2, 8, 1);
    spec.kernel = kernel;
    EXPECT_NEAR(FrameMean(RenderFrame(BuildScene(scene), spec), 1).mean / truth, 1, 2e-5);
  }
}

TEST(Media, TracesOfAMediumAreNothing) {
  // Free paths beyond floats: the environment is seen as it is.
  for (const Rgb scattering : {Rgb{1e-19f, 1e-19f, 1e-19f}, Rgb{1e-40f, 1e-15f, 0}}) {
    TestScene scene;
    scene.description.camera.medium = AddMedium(scene, {.scattering = scattering});
    scene.Sphere({0, 0, 5}, 0.1f, scene.Diffuse(1.0f));
    scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(1)});
    scene.Camera({0, 0, 0}, {0, 0, 1}, 40);
    for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
      JobSpec spec = TestSpec(8, 64, 5);
      spec.kernel = kernel;
      EXPECT_TRUE(Agrees(FrameMean(RenderFrame(BuildScene(scene), spec), 0), 1));
    }
  }
}

TEST(Media, LampsBesideARayAreChosenAsThoseBehindIt) {
  // Fog before a near lamp at the side, and another that is far away: at the other side, or behind.
  const auto spread = [](Vec3d far) {
    TestScene scene;
    const MediumId fog = AddMedium(scene, {.scattering = Rgb::Gray(0.2f)});
    scene.description.camera.medium = fog;
    AddBall(scene, 2, {fog, kNoMedium});
    scene.Light(PointLightDescription{{3, 0, 0.5f}, Rgb::Gray(10)});
    scene.Light(PointLightDescription{far, Rgb::Gray(10)});
    scene.Camera({0, 0, 0}, {0, 0, 1}, 2);
    const Estimate mean = FrameMean(RenderFrame(BuildScene(scene), TestSpec(16, 256, 1)), 1);
    return mean.standard_error / mean.mean;
  };
  EXPECT_LT(spread({0, 0, -13}), 1.3 * spread({-13, 0, 0}));
}

/// Ten million flights through a medium of three rates, two units long, beside the lamps.
void ExpectDensityOfDistances(const LampPlaces& lamps) {
  SceneDescription scene;
  scene.materials.push_back(DiffuseMaterial{});
  scene.media.push_back({.absorption = {0.3f, 0.1f, 0}, .scattering = {0.2f, 0.9f, 2.5f}});
  const auto media = *MediumSet::Build(&scene);
  media->SetLamps(lamps);
  const Rgb beta = {0.9f, 0.4f, 0.2f};
  const double rates[] = {0.5, 1.0, 2.5}, shares[] = {0.6, 0.4 / 1.5, 0.2 / 1.5};
  constexpr int kBins = 50, kDraws = 10'000'000;
  constexpr double kEnd = 2;
  const Ray ray = {.origin = {}, .direction = {0, 0, 1}, .t_max = kEnd};
  std::vector<double> observed(kBins + 1), expected(kBins + 1), control(kBins + 1);
  IndependentSampler sampler({.seed = 5});
  for (uint32_t i = 0; i < kDraws; ++i) {
    sampler.StartSample(i);
    const Flight flight = media->Fly(ray, 0, beta, sampler.Get2D(kPairFirstFlight));
    ++observed[flight.scattered
                   ? std::min(static_cast<size_t>(flight.t * kBins / kEnd), size_t{kBins - 1})
                   : kBins];
  }
  const NearLamps near(lamps, ray.origin, ray.direction, kEnd, 4.0f / 3);
  const double part = near.part();
  const auto density = [&](double t, double error) {
    double p = 0;
    for (int c = 0; c < 3; ++c) {
      const double rate = rates[c] * (1 + error);
      p += shares[c] * (1 - part) * rate * std::exp(-rate * t);
      if (part > 0)
        p += shares[c] * part * -std::expm1(-rate * kEnd) * near.Pdf(static_cast<float>(t));
    }
    return p;
  };
  const auto fill = [&](double error, std::vector<double>* bins) {
    constexpr int kSteps = 200;
    constexpr double kWidth = kEnd / (kBins * kSteps);
    (*bins)[kBins] = kDraws;
    for (int i = 0; i < kBins * kSteps; ++i) {
      const double mass = kDraws * kWidth * density((i + 0.5) * kWidth, error);
      (*bins)[static_cast<size_t>(i / kSteps)] += mass;
      (*bins)[kBins] -= mass;
    }
  };
  fill(0, &expected);
  fill(0.01, &control);
  EXPECT_GT(ChiSquareTest(observed, expected).p, 1e-5);
  EXPECT_LT(ChiSquareTest(observed, control).p, 1e-9);
}
TEST(Media, DistancesHaveTheDensityThatWeighsThem) { ExpectDensityOfDistances({}); }
TEST(Media, DistancesNearLampsHaveTheDensityThatWeighsThem) {
  const auto lamp = [](Vec3f p, float size, float intensity) {
    LightBounds bounds = {p, p + Vec3f{size, 0, 0}};
    bounds.intensity = intensity;
    return bounds;
  };
  ExpectDensityOfDistances(
      LampPlaces({lamp({0.3f, 0, 0.7f}, 0.1f, 1), lamp({0, -1, 1.9f}, 0, 0.3f)}));
}

TEST(Media, WhatIsOutOfItsRangeIsRefused) {
  const auto error = [](const MediumDescription& medium) {
    TestScene scene = BallOf(medium, 1);
    scene.description.media[0].where = {"fog.pbrt", 7};
    const auto built = Scene::Build(scene.description, DirectorySource("."));
    return built.ok() ? std::string() : std::string(built.status().message());
  };
  EXPECT_EQ(error({.scattering = {1, -1, 1}}),
            "fog.pbrt:7: a coefficient of the medium is negative or not finite");
  EXPECT_EQ(error({.scattering = {1, 1, 1}, .g = 1}),
            "fog.pbrt:7: the medium's g is 1, it must lie in (-1, 1)");
  EXPECT_EQ(error({.scattering = {1, 1, 1}}), "");
}

TEST(Media, ClearOnesCostNothing) {
  EXPECT_TRUE(BuildScene(BallOf({}, 1))->media().empty());
  EXPECT_EQ(BuildScene(BallOf({}, 1))->features() & kMedia, 0u);
  EXPECT_EQ(BuildScene(BallOf({.absorption = {1, 0, 0}}, 1))->features() & kMedia, kMedia);
  // Glass that would part them is as glass that parts nothing.
  const auto glass = [](bool border) {
    TestScene scene;
    const MediumId clear = AddMedium(scene, {});
    scene.Sphere({0, 0, 3}, 1, scene.Material(DielectricMaterial{.eta = 1.5f}));
    if (border) scene.description.shapes.back().border = MediumBorder{clear, kNoMedium};
    scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(1)});
    scene.Camera({0, 0, 0}, {0, 0, 1}, 30);
    JobSpec spec = TestSpec(8, 8, 5);
    spec.kernel = KernelKind::kReference;
    return RenderFrame(BuildScene(scene), spec).values;
  };
  EXPECT_EQ(glass(true), glass(false));
}

}  // namespace
}  // namespace strata
