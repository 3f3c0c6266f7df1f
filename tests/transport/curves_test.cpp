#include <gtest/gtest.h>

#include <cmath>

#include "tests/transport/kernels.h"
#include "tests/transport/test_scene.h"

// Curves against closed forms: what they cover of a view, and what they reflect of even light.

namespace strata {
namespace {

CurveShape Straight(CurveKind kind, Vec3f a, Vec3f b, float r0, float r1) {
  CurveShape curve;
  curve.kind = kind;
  for (int i = 0; i < 4; ++i) {
    const float t = static_cast<float>(i) / 3;
    curve.positions.push_back(a * (1 - t) + b * t);
    curve.radii.push_back(r0 * (1 - t) + r1 * t);
    if (kind == CurveKind::kRibbon) curve.normals.push_back({0, 0, -1});
  }
  curve.segments = {0};
  return curve;
}

/// An orthographic view of [-1, 1]^2 along z before an environment of radiance 1.
TestScene Backlit() {
  TestScene scene;
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(1)});
  scene.description.camera.kind = CameraKind::kOrthographic;
  scene.description.camera.camera_to_world = Transform::Translate(0, 0, -5);
  return scene;
}

void Add(TestScene& scene, CurveShape curve, MaterialId material) {
  ShapeDescription& shape = scene.description.shapes.emplace_back();
  shape.geometry = std::move(curve);
  shape.material = material;
}

constexpr CurveKind kKinds[] = {CurveKind::kFlat, CurveKind::kCylinder, CurveKind::kRibbon};

TEST(CurveTransport, AHairCoversItsLengthTimesItsMeanWidth) {
  for (const CurveKind kind : kKinds) {
    TestScene scene = Backlit();
    Add(scene, Straight(kind, {-0.8f, -0.5f, 0}, {0.7f, 0.4f, 0}, 0.03f, 0.01f),
        scene.Diffuse(0.0f));
    const double length = std::hypot(1.5, 0.9);
    for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
      JobSpec spec = TestSpec(32, 1024, 1);
      const Estimate mean = FrameMean(RenderBy(BuildScene(scene), spec, kernel, {0, 128}), 1);
      // Of a cone, seen along its side, the outline is a little wider than the radius: 1e-4.
      const double truth = 1 - length * 0.04 / 4;
      EXPECT_NEAR(mean.mean, truth, kCritical * mean.standard_error + 5e-6);
      EXPECT_LT(mean.standard_error, 1e-4);
      // The control: a width that is larger by 5 %.
      EXPECT_FALSE(Agrees(mean, 1 - length * 0.042 / 4));
    }
  }
}

/// How often light on its way to a flat curve meets it first, at most: as kMeetAnew in
/// tests/geometry/curves_test.cpp, but of directions by their cosine. With the angle theta to the
/// axis and psi around it their density is sin(theta) sin(psi) / pi. Of those with sin(theta) < a =
/// x cos(psi) / 2 <= 1/2 that is 1.09 x^3 / (48 pi) in all, as the integral of sin^2 from 0 to
/// asin(a) is at most 1.09 a^3 / 3. The mean of x^3 over the width is 1/4.
constexpr double kShadowed = 1.09 / (4 * 48 * 3.14159265358979323846);

/// A convex thing of reflectance 1/2 in even light shows half of it, whichever way its normals
/// look, unless it shadows itself.
TEST(CurveTransport, AHairInEvenLightShowsItsReflectance) {
  for (const CurveKind kind : kKinds) {
    TestScene scene = Backlit();
    Add(scene, Straight(kind, {-0.8f, -0.5f, 0}, {0.7f, 0.4f, 0}, 0.15f, 0.15f),
        scene.Diffuse(0.5f));
    for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
      JobSpec spec = TestSpec(16, 512, 3);
      spec.channels.alpha = true;
      const Partial partial = RenderBy(BuildScene(scene), spec, kernel, {0, 64});
      double difference = 0, covered_in_all = 0;
      for (int64_t pixel = 0; pixel < spec.crop.Pixels(); ++pixel) {
        const int64_t at = pixel * partial.layout.Doubles();
        const double covered = partial.values[at + partial.layout.Plain(0)];
        difference += PixelMean(partial, pixel, 1) - (1 - 0.5 * covered);
        covered_in_all += covered;
      }
      const auto pixels = static_cast<double>(spec.crop.Pixels());
      // The spread given what is covered is at most that of the frame. What shadows a flat curve
      // shines half as bright as what is behind it.
      const double slack = kCritical * FrameMean(partial, 1).standard_error;
      const double shadow = kind == CurveKind::kFlat ? 0.5 * kShadowed * 0.5 : 0;
      EXPECT_LE(difference / pixels, slack) << static_cast<int>(kind);
      EXPECT_GE(difference / pixels, -slack - shadow * covered_in_all / pixels)
          << static_cast<int>(kind);
      // The control: a reflectance that is larger by 2 %.
      EXPECT_GT(0.01 * covered_in_all / pixels, 2 * slack);
    }
  }
}

/// Random hairs, straight and bent, of every kind, lit by a lamp.
TestScene Tuft() {
  TestScene scene;
  uint64_t state = 1;
  const auto random = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<float>(state >> 40) * 0x1p-24f;
  };
  const MaterialId materials[] = {
      scene.Diffuse({0.7f, 0.5f, 0.3f}),
      scene.Material(CoatedDiffuseMaterial{.reflectance = scene.Texture(Rgb::Gray(0.4f)),
                                           .albedo = scene.Texture({})}),
      scene.Material(DielectricMaterial{})};
  for (int i = 0; i < 60; ++i) {
    const CurveKind kind = kKinds[i % 3];
    CurveShape curve = Straight(kind, {2 * random() - 1, 0, 2 * random() - 1},
                                {2 * random() - 1, 1.5f, 2 * random() - 1}, 0.04f, 0.02f);
    curve.positions[1] += Vec3f{random() - 0.5f, 0, random() - 0.5f};
    Add(scene, curve, materials[(i / 3) % 3]);
  }
  scene.Polygon({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}}, scene.Diffuse(0.5f));
  scene.Sphere({1.5f, 3, -1}, 0.4f, scene.Diffuse(0.0f), Emits(10));
  scene.Light(ConstantInfiniteLightDescription{{0.2f, 0.3f, 0.4f}});
  scene.Camera({0, 1.2f, -4}, {0, 0.7f, 0}, 40);
  return scene;
}

TEST(CurveTransport, KernelsAgreeOnNearlyEverySample) {
  EXPECT_GE(AgreeingShare(BuildScene(Tuft()), TestSpec(32, 64, 6), 1e-5), 0.99);
}

}  // namespace
}  // namespace strata
