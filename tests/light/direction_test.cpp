#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/light/lamp.h"
#include "tests/light/light_scene.h"
#include "tests/light/sources.h"
#include "tests/statistics/density_checks.h"
#include "tests/statistics/random.h"

// SampleLi of every light draws directions with the density that PdfLi claims: 50000 of each in a
// chi-square test, and by hand ten million against an error of 1 %:
//
//   test_light --gtest_also_run_disabled_tests --gtest_filter='*OnePercentOfShape*'

namespace strata {
namespace {

constexpr DensityEffort kEveryDay = {50000, {}};

using Sampler = std::function<std::optional<Vec3f>(Vec2f u)>;
using Density = std::function<float(Vec3f direction)>;

/// The sphere turned so that its pole, where the test's cells may be small, lies amid a light's
/// directions, and stretched across its longer side, so that quadrature finds the tips of a needle.
class View {
 public:
  explicit View(const std::vector<Vec3f>& directions) {
    Vec3f sum;
    for (const Vec3f w : directions) sum = sum + w;
    frame_ = Frame::FromNormal(Normalize(sum));
    float xx = 0, xy = 0, yy = 0;
    for (const Vec3f w : directions) {
      const Vec3f local = frame_.ToLocal(w);
      xx += local.x * local.x;
      xy += local.x * local.y;
      yy += local.y * local.y;
    }
    // The axes of the matrix of second moments, the longer one first.
    const float angle = 0.5f * std::atan2(2 * xy, xx - yy);
    frame_ = Frame::FromNormalAndTangent(frame_.z,
                                         frame_.x * std::cos(angle) + frame_.y * std::sin(angle));
    const float middle = 0.5f * (xx + yy), off = std::hypot(0.5f * (xx - yy), xy);
    squeeze_ = std::sqrt(std::max(middle - off, 1e-4f * middle) / (middle + off));
  }

  Vec3f FromWorld(Vec3f w) const {
    const Vec3f local = frame_.ToLocal(w);
    return Normalize(Vec3f{local.x, local.y / squeeze_, local.z});
  }
  /// The density of what FromWorld makes of directions of density `pdf`.
  float Pdf(const Density& pdf, Vec3f v) const {
    const Vec3f squeezed = {v.x, v.y * squeeze_, v.z};
    const float length = Length(squeezed);
    return pdf(frame_.ToWorld(squeezed / length)) * squeeze_ / (length * length * length);
  }

 private:
  Frame frame_;
  float squeeze_;
};

void ExpectDensity(DensityChecks* checks, const std::string& name, const Sampler& sample,
                   const Density& pdf, uint64_t seed) {
  TestRandom random(seed);
  std::vector<Vec3f> some;
  while (some.size() < 256) {
    if (const std::optional<Vec3f> w = sample(random.Float2())) some.push_back(*w);
  }
  const View view(some);
  const DirectionTestResult result = checks->ExpectDirections(
      name,
      [&]() -> std::optional<Vec3f> {
        const std::optional<Vec3f> w = sample(random.Float2());
        return w ? std::optional(view.FromWorld(*w)) : std::nullopt;
      },
      [&](Vec3f v) { return view.Pdf(pdf, v); });
  EXPECT_NEAR(result.integral, 1, 1e-3) << name;
}

void ExpectDensitiesOfLamps(const DensityEffort& effort) {
  const std::vector<LampCase> cases = AllLampCases();
  DensityChecks checks(cases.size(), effort);
  uint64_t seed = 1;
  for (const LampCase& c : cases) {
    const Lamp lamp(c.shape);
    ExpectDensity(
        &checks, c.name,
        [&](Vec2f u) {
          const std::optional<LightSample> sample = lamp.Sample(c.from, u);
          return sample ? std::optional(sample->wi) : std::nullopt;
        },
        [&](Vec3f w) { return lamp.Pdf(c.from, w); }, seed++);
  }
}
TEST(LampDirections, FollowTheDensity) { ExpectDensitiesOfLamps(kEveryDay); }
TEST(LampDirections, DISABLED_AreToldFromOnePercentOfShape) { ExpectDensitiesOfLamps(kByHand); }

TEST(LampDirections, LeadToThePointThatWasChosen) {
  TestRandom random(3);
  for (const LampCase& c : AllLampCases()) {
    const Lamp lamp(c.shape);
    constexpr int kTries = 5000;
    int off = 0;
    for (int i = 0; i < kTries; ++i) {
      const std::optional<LightSample> sample = lamp.Sample(c.from, random.Float2());
      ASSERT_TRUE(sample) << c.name;
      EXPECT_FALSE(sample->delta || sample->infinite) << c.name;
      const float distance = Length(sample->end - c.from);
      bool found = false;
      for (const Lamp::Meeting& meeting : lamp.Meetings(c.from, sample->wi)) {
        found |= std::abs(meeting.hit.distance - distance) < 1e-3f * distance &&
                 std::abs(meeting.pdf - sample->pdf) < 0.01f * sample->pdf &&
                 meeting.radiance == sample->radiance;
      }
      off += !found;
    }
    // Rays miss the very edge of a lamp, and meet its limb elsewhere.
    EXPECT_LE(off, kTries / 200) << c.name;
  }
}

TEST(LampDirections, AreNotHiddenByAFlatLampItself) {
  TestRandom random(5);
  int asked = 0;
  for (const LampCase& c : AllLampCases()) {
    const bool mesh = std::holds_alternative<TriangleMeshShape>(c.shape.geometry);
    const bool disk = std::holds_alternative<DiskShape>(c.shape.geometry);
    if (!mesh && !disk) continue;
    const Lamp lamp(c.shape);
    for (int i = 0; i < 5000; ++i) {
      const std::optional<LightSample> sample = lamp.Sample(c.from, random.Float2());
      ASSERT_TRUE(sample) << c.name;
      EXPECT_FALSE(lamp.IsHidden(c.from, *sample)) << c.name;
      ++asked;
      // The control: a point behind the lamp is hidden.
      LightSample behind = *sample;
      behind.end = c.from + (sample->end - c.from) * 1.1f;
      EXPECT_TRUE(lamp.IsHidden(c.from, behind) || i % 10 != 0) << c.name;
    }
  }
  EXPECT_GE(asked, 50000);
}

TEST(LampDirections, AreNoneTowardsADarkSide) {
  TestRandom random(4);
  for (const LampCase& c : AllLampCases()) {
    ShapeDescription shape = c.shape;
    shape.emission->two_sided = false;
    int lit = 0;
    for (const bool reverse : {false, true}) {
      shape.reverse_orientation = reverse;
      const Lamp lamp(shape);
      const std::optional<LightSample> sample = lamp.Sample(c.from, random.Float2());
      // A twisted patch may show both sides.
      lit += sample.has_value();
      if (sample) {
        EXPECT_GT(lamp.Pdf(c.from, sample->wi), 0) << c.name;
      }
    }
    EXPECT_GE(lit, 1) << c.name;
  }
}

TEST(DeltaLights, HaveNoDensityEvenWhereTheyAre) {
  const LightFiles files;
  int deltas = 0, others = 0;
  for (const Source& source : Sources(files)) {
    SceneDescription description;
    source.add(&description);
    const LightScene scene(std::move(description), files.source());
    TestRandom random(6);
    std::visit(
        [&]<typename X>(const X& light) {
          // Not all of them shine everywhere.
          Vec3f from;
          std::optional<LightSample> sample;
          for (int i = 0; i < 100 && !sample; ++i) {
            from = {4 * random.Float() - 2, 4 * random.Float() - 2, random.Float()};
            sample = SampleLi(light, from, random.Float2());
          }
          ASSERT_TRUE(sample) << source.name;
          EXPECT_EQ(sample->delta, DeltaLight<X>) << source.name;
          if constexpr (DeltaLight<X>) {
            ++deltas;
            EXPECT_EQ(sample->pdf, 1) << source.name;
            EXPECT_EQ(PdfLi(light, from, sample->wi), 0) << source.name;
          } else {
            ++others;
          }
        },
        scene.lights.lights().at(0));
  }
  EXPECT_EQ(deltas, 6);
  EXPECT_GT(others, 10);
}

// ---- skies ----

/// A dark sky with black parts and a sun, which has about half of all power.
std::vector<Rgb> Sunny(int width, int height) {
  std::vector<Rgb> pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float value = (x / 3 + y / 2) % 3 == 0 ? 0 : 0.2f + 0.1f * static_cast<float>(x % 5);
      pixels.push_back({value, 0.8f * value, 0.5f * value});
    }
  }
  pixels[static_cast<size_t>(height / 3 * width + width / 4)] =
      Rgb::Gray(0.2f * static_cast<float>(width * height));
  return pixels;
}

void ExpectDensitiesOfSkies(const DensityEffort& effort) {
  const Frame turned = Frame::FromNormal(Normalize(Vec3f{1, 2, 3}));
  const Frame mirrored = {turned.y, turned.x, turned.z};
  struct Case {
    std::string name;
    int width, height;
    EnvironmentMapping mapping;
    Frame axes;
    bool compensated = false;
  };
  const std::vector<Case> cases = {
      {"equal-area", 16, 16, EnvironmentMapping::kEqualArea, turned},
      {"mirrored equal-area", 15, 15, EnvironmentMapping::kEqualArea, mirrored},
      {"lat-long", 24, 12, EnvironmentMapping::kLatLong, turned},
      {"mirrored lat-long", 20, 9, EnvironmentMapping::kLatLong, mirrored},
      {"compensated", 16, 16, EnvironmentMapping::kEqualArea, turned, true},
      {"compensated lat-long", 24, 12, EnvironmentMapping::kLatLong, turned, true}};
  DensityChecks checks(cases.size() + 1, effort);
  uint64_t seed = 100;
  for (const Case& c : cases) {
    const EnvironmentImage image(c.width, c.height, Sunny(c.width, c.height), c.mapping, c.axes,
                                 c.compensated);
    const ImageEnvironment sky = {&image};
    ExpectDensity(
        &checks, c.name,
        [&](Vec2f u) {
          const std::optional<LightSample> sample = SampleLi(sky, {}, u);
          return sample ? std::optional(sample->wi) : std::nullopt;
        },
        [&](Vec3f w) { return PdfLi(sky, w); }, seed++);
  }
  const ConstantEnvironment sky = {Rgb::Gray(2)};
  ExpectDensity(
      &checks, "constant", [&](Vec2f u) { return std::optional(SampleLi(sky, {}, u)->wi); },
      [&](Vec3f w) { return PdfLi(sky, w); }, seed++);
}
TEST(SkyDirections, FollowTheDensity) { ExpectDensitiesOfSkies(kEveryDay); }
TEST(SkyDirections, DISABLED_AreToldFromOnePercentOfShape) { ExpectDensitiesOfSkies(kByHand); }

// ---- portals ----

/// A portal of 2 by 1, outwards along x, in a sunny sky.
ImageInfiniteLightDescription PortalTo(const std::string& path) {
  ImageInfiniteLightDescription light;
  light.path = path;
  light.to_world = Transform::Rotate(40, 1, 2, 3);
  light.portal = {Vec3d{1, 0, 0}, {1, 0, 1}, {1, 2, 1}, {1, 2, 0}};
  return light;
}

void ExpectDensitiesOfAPortal(const DensityEffort& effort) {
  const LightFiles files;
  files.WriteImage("sky.pfm", 32, 32, Sunny(32, 32));
  const auto portal = PortalImage::Load(PortalTo("sky.pfm"), files.source());
  ASSERT_TRUE(portal.ok()) << portal.status();
  const PortalEnvironment light = {&*portal};
  struct Case {
    std::string name;
    Vec3f from;
  };
  const std::vector<Case> cases = {{"before the middle", {0, 1, 0.5f}},
                                   {"far", {-6, 3, -2}},
                                   {"aside", {0.5f, 6, 4}},
                                   {"near", {0.97f, 0.3f, 0.4f}}};
  DensityChecks checks(cases.size(), effort);
  uint64_t seed = 200;
  for (const Case& c : cases) {
    ExpectDensity(
        &checks, c.name,
        [&](Vec2f u) {
          const std::optional<LightSample> sample = SampleLi(light, c.from, u);
          return sample ? std::optional(sample->wi) : std::nullopt;
        },
        [&](Vec3f w) { return PdfLi(light, c.from, w); }, seed++);
  }
}
TEST(PortalDirections, FollowTheDensity) { ExpectDensitiesOfAPortal(kEveryDay); }
TEST(PortalDirections, DISABLED_AreToldFromOnePercentOfShape) { ExpectDensitiesOfAPortal(kByHand); }

TEST(PortalDirections, GoThroughThePortal) {
  const LightFiles files;
  files.WriteImage("sky.pfm", 32, 32, Sunny(32, 32));
  const auto portal = PortalImage::Load(PortalTo("sky.pfm"), files.source());
  ASSERT_TRUE(portal.ok()) << portal.status();
  const PortalEnvironment light = {&*portal};
  TestRandom random(12);
  int through = 0, past = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f from = {4 * random.Float() - 2, 4 * random.Float() - 1, 3 * random.Float() - 1};
    const std::optional<LightSample> sample = SampleLi(light, from, random.Float2());
    EXPECT_EQ(sample.has_value(), from.x < 1);
    const Vec3f w = SampleUniformSphere(random.Float2());
    const float t = (1 - from.x) / w.x;
    const Vec3f at = from + w * t;
    const auto beyond = [](float x, float end) { return std::max(-x, x - end); };
    const float outside = std::max(beyond(at.y, 2), beyond(at.z, 1));
    if (from.x < 1 && w.x > 0 && outside < -1e-4f) {
      ++through;
      EXPECT_EQ(Le(light, from, w), Le(ImageEnvironment{&portal->sky}, w));
      EXPECT_GT(PdfLi(light, from, w), 0);
    } else if (!(from.x < 1 && w.x > 0 && outside < 1e-4f)) {
      ++past;
      EXPECT_TRUE(IsBlack(Le(light, from, w)));
      EXPECT_EQ(PdfLi(light, from, w), 0);
    }
    if (!sample) continue;
    const Vec3f hit = from + sample->wi * ((1 - from.x) / sample->wi.x);
    EXPECT_LT(std::max(beyond(hit.y, 2), beyond(hit.z, 1)), 1e-4f);
  }
  EXPECT_GT(through, 500);
  EXPECT_GT(past, 5000);
}

// By 1 - x^2 nothing would be left of it in floats.
TEST(PortalDirections, HaveADensityAlongThePortal) {
  for (const double y : {0.0, 2e-5, 0.5}) {
    for (const double z : {1e-3, 1e-5, 1e-9}) {
      const double x = std::sqrt(1 - y * y - z * z);
      const double density = M_PI * M_PI * (y * y + z * z) * (x * x + z * z) / z;
      const Vec3f local = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
      EXPECT_NEAR(PortalImage::Density(local), density, 1e-6 * density) << y << " " << z;
    }
  }
  EXPECT_EQ(PortalImage::PerSolidAngle(0, {1, 0, 1e-30f}), 0) << "where even that is 0";
}

TEST(PortalDirections, NeedARectangle) {
  const LightFiles files;
  files.WriteImage("sky.pfm", 1, 1, {Rgb::Gray(1)});
  ImageInfiniteLightDescription light = PortalTo("sky.pfm");
  std::swap((*light.portal)[1], (*light.portal)[2]);
  EXPECT_FALSE(PortalImage::Load(light, files.source()).ok());
  light = PortalTo("sky.pfm");
  for (Vec3d& corner : *light.portal) corner.y += 0.2 * corner.z;
  EXPECT_FALSE(PortalImage::Load(light, files.source()).ok());
}

}  // namespace
}  // namespace strata
