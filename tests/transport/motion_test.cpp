#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "tests/statistics/chi_square.h"
#include "tests/transport/kernels.h"
#include "tests/transport/test_scene.h"

// Motion blur against closed forms: black things that move before an environment of radiance 1 take
// from each pixel the part of the time, and of its area, that they cover.

namespace strata {
namespace {

constexpr int kSize = 16;

/// An orthographic view of [-1, 1]^2 along z, from z = -5.
TestScene Backlit() {
  TestScene scene;
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(1)});
  scene.description.camera.kind = CameraKind::kOrthographic;
  scene.description.camera.camera_to_world = Transform::Translate(0, 0, -5);
  return scene;
}

ShapeDescription BlackRectangle(TestScene& scene, float x0, float x1, float y0, float y1) {
  TriangleMeshShape mesh;
  mesh.positions = {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  ShapeDescription shape;
  shape.geometry = mesh;
  shape.material = scene.Diffuse(0.0f);
  return shape;
}

void AddMoving(TestScene& scene, ShapeDescription shape, const Transform& start,
               const Transform& end) {
  InstanceDescription instance;
  instance.object = static_cast<int32_t>(scene.description.objects.size());
  instance.to_world = start;
  instance.to_world_at_end = end;
  scene.description.objects.push_back({"moving", {std::move(shape)}});
  scene.description.instances.push_back(instance);
}

/// Independent samples: each is 0 or 1, so that a pixel's mean has the variance q (1 - q) / n
/// around its truth q, and no tolerance is needed.
constexpr uint32_t kSamples = 16384;
JobSpec IndependentSpec() {
  JobSpec spec = TestSpec(kSize, kSamples, 1);
  spec.sampler = SamplerKind::kIndependent;
  return spec;
}

/// The mean over a pixel of what is left of the light at the point (x, y) of the view. Exact for
/// what is linear in x between multiples of a tenth, and constant in y between those of an eighth:
/// cells have their borders there.
double PixelOf(const std::function<double(double, double)>& light, int64_t pixel) {
  constexpr int kGrid = 40;
  double sum = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const double px = static_cast<double>(pixel % kSize) + (i % kGrid + 0.5) / kGrid;
    const double py = static_cast<double>(pixel / kSize) + (i / kGrid + 0.5) / kGrid;
    sum += light(2 * px / kSize - 1, 1 - 2 * py / kSize);
  }
  return sum / (kGrid * kGrid);
}

/// The probability of a frame at least as far from the closed form, if that is true: chi-square
/// over its pixels. Those too sure for a normal distribution of their means count as one.
double Probability(const Partial& partial, const std::function<double(double, double)>& light) {
  double statistic = 0, rest = 0, rest_variance = 0;
  int degrees = 0;
  for (int64_t pixel = 0; pixel < kSize * kSize; ++pixel) {
    const double truth = PixelOf(light, pixel), off = PixelMean(partial, pixel, 1) - truth;
    const double variance = std::max(truth * (1 - truth), 0.0) / kSamples;
    constexpr double kEnough = 25;
    if (variance * kSamples * kSamples < kEnough) {
      rest += off;
      rest_variance += variance;
      continue;
    }
    statistic += off * off / variance;
    ++degrees;
  }
  // Rounding of the truth's sum makes a variance of some 1e-19 out of none.
  if (rest_variance < 1e-15) return std::abs(rest) < 1e-9 ? ChiSquareTail(statistic, degrees) : 0;
  return ChiSquareTail(statistic + rest * rest / rest_variance, degrees + 1);
}

/// Of each test; of each control a smaller probability is asked.
constexpr double kSignificance = 1e-5;

/// How much of the times [t0, t1] the interval [x0, x1] that moves by `by` in unit time does not
/// cover x.
std::function<double(double, double)> Passing(double x0, double x1, double by, double t0,
                                              double t1) {
  return [=](double x, double y) {
    if (std::abs(y) > 0.5) return 1.0;
    const double enter = (x - x1) / by, leave = (x - x0) / by;
    const double first = std::min(enter, leave), last = std::max(enter, leave);
    const double covered = std::min(last, t1) - std::max(first, t0);
    return 1 - std::max(covered, 0.0) / (t1 - t0);
  };
}

TEST(MotionBlur, AMovingSquareCoversItsAnalyticProfile) {
  TestScene scene = Backlit();
  AddMoving(scene, BlackRectangle(scene, -0.7f, -0.1f, -0.5f, 0.5f), {},
            Transform::Translate(0.8, 0, 0));
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    const Partial partial =
        RenderBy(BuildScene(scene), IndependentSpec(), kernel, {0, kSamples / kReplicates});
    EXPECT_GT(Probability(partial, Passing(-0.7, -0.1, 0.8, 0, 1)), kSignificance);
    // The control: the way is 5 % longer.
    EXPECT_LT(Probability(partial, Passing(-0.7, -0.1, 0.84, 0, 1)), kSignificance);
  }
}

TEST(MotionBlur, TheShutterTakesItsPartOfTheMotion) {
  TestScene scene = Backlit();
  AddMoving(scene, BlackRectangle(scene, -0.7f, -0.1f, -0.5f, 0.5f), {},
            Transform::Translate(0.8, 0, 0));
  scene.description.camera.shutter_open = 0.25f;
  scene.description.camera.shutter_close = 0.75f;
  const Partial half = RenderFrame(BuildScene(scene), IndependentSpec());
  EXPECT_GT(Probability(half, Passing(-0.7, -0.1, 0.8, 0.25, 0.75)), kSignificance);
  EXPECT_LT(Probability(half, Passing(-0.7, -0.1, 0.8, 0, 1)), kSignificance);
  // A shutter that opens for no time shows one moment.
  scene.description.camera.shutter_close = 0.25f;
  const Partial moment = RenderFrame(BuildScene(scene), IndependentSpec());
  EXPECT_GT(Probability(moment, Passing(-0.7, -0.1, 0.8, 0.25 - 1e-9, 0.25 + 1e-9)), kSignificance);
  EXPECT_LT(Probability(moment, Passing(-0.7, -0.1, 0.8, 0.27, 0.28)), kSignificance);
}

TEST(MotionBlur, BeforeAndAfterTheMotionThingsRest) {
  TestScene scene = Backlit();
  AddMoving(scene, BlackRectangle(scene, -0.7f, -0.1f, -0.5f, 0.5f), {},
            Transform::Translate(0.8, 0, 0));
  scene.description.camera.shutter_open = -1;
  scene.description.camera.shutter_close = 1;
  const auto rests = Passing(-0.7, -0.1, 0.8, -1e-9, 1e-9), moves = Passing(-0.7, -0.1, 0.8, 0, 1);
  const Partial partial = RenderFrame(BuildScene(scene), IndependentSpec());
  const auto both = [&](double x, double y) { return (rests(x, y) + moves(x, y)) / 2; };
  EXPECT_GT(Probability(partial, both), kSignificance);
  EXPECT_LT(Probability(partial, moves), kSignificance);
}

TEST(MotionBlur, ACameraThatMovesSeesThingsMoveTheOtherWay) {
  TestScene scene = Backlit();
  scene.description.shapes.push_back(BlackRectangle(scene, -0.7f, -0.1f, -0.5f, 0.5f));
  scene.description.camera.camera_to_world_at_end =
      Transform::Translate(-0.8, 0, 0) * scene.description.camera.camera_to_world;
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    const Partial partial =
        RenderBy(BuildScene(scene), IndependentSpec(), kernel, {0, kSamples / kReplicates});
    EXPECT_GT(Probability(partial, Passing(-0.7, -0.1, 0.8, 0, 1)), kSignificance);
  }
}

/// What moves with the camera looks still.
TEST(MotionBlur, ThingsThatMoveWithTheCameraAreSharp) {
  TestScene scene = Backlit();
  const Transform end = Transform::Translate(0.3, -0.2, 0.1) * Transform::Rotate(40, 0, 0, 1);
  AddMoving(scene, BlackRectangle(scene, -0.75f, -0.25f, -0.5f, 0.5f), {}, end);
  scene.description.camera.camera_to_world_at_end = end * scene.description.camera.camera_to_world;
  const Partial partial = RenderFrame(BuildScene(scene), TestSpec(kSize, 512, 1));
  // The edges lie between pixels.
  for (int64_t pixel = 0; pixel < kSize * kSize; ++pixel) {
    const int64_t x = pixel % kSize, y = pixel / kSize;
    const bool covered = x >= 2 && x < 6 && y >= 4 && y < 12;
    EXPECT_LT(std::abs(PixelMean(partial, pixel, 1) - (covered ? 0 : 1)), 1.0 / 512) << pixel;
  }
}

/// A half plane that turns by a right angle about the view's axis.
TEST(MotionBlur, ATurningHalfPlaneCoversEachAngleForItsTime) {
  TestScene scene = Backlit();
  AddMoving(scene, BlackRectangle(scene, 0, 4, -4, 4), {}, Transform::Rotate(90, 0, 0, 1));
  const Partial partial = RenderFrame(BuildScene(scene), IndependentSpec());
  const auto light = [](double speed) {
    return [speed](double x, double y) {
      // It covers the angles within 90 degrees of its normal's, which goes from 0 to 90.
      const double angle = std::atan2(y, x) * 180 / M_PI;
      const auto covered_from = [&](double a) {  // The times that have 90 t in [a - 90, a + 90].
        const double last = std::min(1.0, (a + 90) / speed),
                     first = std::max(0.0, (a - 90) / speed);
        return std::max(0.0, last - first);
      };
      return 1 - covered_from(angle) - covered_from(angle + 360);
    };
  };
  // The closed form's grid errs by a fifth of a standard error in the four pixels around the axis,
  // and far less elsewhere.
  EXPECT_GT(Probability(partial, light(90)), kSignificance);
  EXPECT_LT(Probability(partial, light(88)), kSignificance);
}

/// A lamp that rests, and a floor whose shadow, of a blocker that moves, is lighter by the time
/// that it is elsewhere: shadow rays carry their sample's time.
TEST(MotionBlur, ShadowsAreOfTheSampleOwnTime) {
  TestScene scene;
  scene.Polygon({{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}, scene.Diffuse(0.5f));
  scene.Light(PointLightDescription{{0, 0, -100}, Rgb::Gray(1e4f)});
  // Behind the camera.
  AddMoving(scene, BlackRectangle(scene, -4, 0, -4, 4), Transform::Translate(0, 0, -50),
            Transform::Translate(-8, 0, -50));
  scene.description.camera.kind = CameraKind::kOrthographic;
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    const auto mean = [&](float open, float close) {
      scene.description.camera.shutter_open = open;
      scene.description.camera.shutter_close = close;
      const Partial partial =
          RenderBy(BuildScene(scene), TestSpec(kSize, 1024, 1), kernel, {0, 128});
      return FrameMean(partial, 1).mean;
    };
    const double lit = mean(1, 1);
    EXPECT_GT(lit, 0.1);
    EXPECT_NEAR(mean(0, 0), lit / 2, 0.02 * lit);  // The left half is in shadow.
    // The shadow's edge goes from x = 0 to -8 t 101 / 50: half the floor at first, none from
    // t = 50 / 808 on.
    const double mean_share = 0.5 * (50.0 / 808) * 0.5 / 0.25;
    EXPECT_NEAR(mean(0, 0.25f), lit * (1 - mean_share), 0.01 * lit);
  }
}

TestScene Busy() {
  TestScene scene;
  scene.Polygon({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}},
                scene.Diffuse({0.8f, 0.5f, 0.2f}));
  scene.Sphere({1.5f, 2, -1}, 0.3f, scene.Diffuse(0.0f), Emits(10));
  scene.Light(ConstantInfiniteLightDescription{{0.1f, 0.2f, 0.3f}});
  ShapeDescription ball;
  ball.geometry = SphereShape{0.5f, -0.5f, 0.5f, 360};
  ball.material = scene.Material(DielectricMaterial{});
  AddMoving(scene, ball, Transform::Translate(-1, 0.6, 0), Transform::Translate(0.5, 1, 0.2));
  AddMoving(scene, BlackRectangle(scene, -0.3f, 0.3f, 0, 1.5f), Transform::Translate(1, 0.1, 0.3),
            Transform::Translate(1, 0.1, 0.3) * Transform::Rotate(70, 0, 1, 0));
  scene.description.objects.back().shapes[0].material = scene.Diffuse(0.7f);
  scene.Camera({0, 1.5f, -5}, {0, 0.8f, 0}, 40);
  return scene;
}

TEST(MotionBlur, KernelsAgreeOnNearlyEverySample) {
  TestScene scene = Busy();
  EXPECT_GE(AgreeingShare(BuildScene(scene), TestSpec(32, 64, 6), 1e-5), 0.998);
  scene.description.camera.camera_to_world_at_end =
      scene.description.camera.camera_to_world * Transform::Rotate(3, 0, 1, 0);
  scene.description.camera.lens_radius = 0.05f;
  scene.description.camera.focal_distance = 5;
  EXPECT_GE(AgreeingShare(BuildScene(scene), TestSpec(32, 64, 6), 1e-5), 0.998);
}

TEST(MotionBlur, SameBitsHoweverTheFrameIsCut) {
  JobSpec spec = TestSpec(24, 32, 6);
  spec.channels = {.alpha = true, .depth = true};
  TestScene scene = Busy();
  scene.description.camera.camera_to_world_at_end =
      scene.description.camera.camera_to_world * Transform::Translate(0.2, 0, 0.3);
  const auto renderer = *Renderer::Create(BuildScene(scene), spec);
  RenderPool one(1), three(3);
  const auto whole = renderer->Render({{}, spec.crop, {{0, 4}}}, one);
  ASSERT_TRUE(whole.ok());
  const int doubles = whole->layout.Doubles();
  for (int y = 0; y < 24; y += 7) {
    for (int x = 0; x < 24; x += 5) {
      const PixelRect rect = {x, y, std::min(x + 5, 24), std::min(y + 7, 24)};
      const auto part = renderer->Render({{}, rect, {{0, 4}}}, three);
      ASSERT_TRUE(part.ok());
      for (int64_t i = 0; i < rect.Pixels(); ++i) {
        const int64_t at = (rect.y0 + i / rect.Width()) * 24 + rect.x0 + i % rect.Width();
        EXPECT_EQ(std::memcmp(&part->values[i * doubles], &whole->values[at * doubles],
                              doubles * sizeof(double)),
                  0);
      }
    }
  }
}

}  // namespace
}  // namespace strata
