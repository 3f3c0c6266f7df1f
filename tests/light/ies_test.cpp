#include "worker/light/ies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/light/light_scene.h"
#include "worker/light/goniometric_light.h"

// IES files: what they mean, and what is said of broken ones.

namespace strata {
namespace {

/// Towards `vertical` degrees from straight down at the `horizontal` angle.
Vec3f Towards(double vertical, double horizontal) {
  const double v = vertical * M_PI / 180, h = horizontal * M_PI / 180;
  return {static_cast<float>(std::sin(v) * std::cos(h)),
          static_cast<float>(std::sin(v) * std::sin(h)), static_cast<float>(-std::cos(v))};
}

std::string File(const std::string& verticals, const std::string& horizontals,
                 const std::string& candelas, const std::string& multiplier = "1",
                 const std::string& factors = "1 1 100") {
  const auto count = [](const std::string& list) {
    return std::to_string(std::count(list.begin(), list.end(), ' ') + 1);
  };
  return "IESNA:LM-63-1995\r\n[TEST] none\r\n[MANUFAC] TILT of the roof\r\nTILT=NONE\r\n1 1000 " +
         multiplier + " " + count(verticals) + " " + count(horizontals) + " 1 2 0 0 0\r\n" +
         factors + "\r\n" + verticals + "\r\n" + horizontals + "\r\n" + candelas + "\r\n";
}

IesProfile Parse(const std::string& text) {
  auto profile = IesProfile::Parse(text, "lamp.ies");
  EXPECT_TRUE(profile.ok()) << profile.status();
  return profile.ok() ? *std::move(profile) : IesProfile();
}

TEST(IesFiles, OfOneHorizontalAngleAreAlikeAllAround) {
  const IesProfile lamp = Parse(File("0 45 90", "0", "100 80 20", "2", "0.5 1.5 60"));
  for (const double around : {0.0, 77.0, 200.0, 359.0}) {
    EXPECT_NEAR(lamp.Candelas(Towards(0, around)), 150, 1e-2);
    EXPECT_NEAR(lamp.Candelas(Towards(45, around)), 120, 1e-2);
    EXPECT_NEAR(lamp.Candelas(Towards(22.5, around)), 135, 1e-2);
    EXPECT_NEAR(lamp.Candelas(Towards(67.5, around)), 75, 1e-2);
    EXPECT_EQ(lamp.Candelas(Towards(91, around)), 0);
  }
}

TEST(IesFiles, AreWrittenOutBySymmetry) {
  // Candelas at 90 degrees from straight down, by the file's horizontal angles.
  const auto at = [](const IesProfile& lamp, double around) {
    return lamp.Candelas(Towards(90, around));
  };
  const IesProfile quadrant = Parse(File("0 90", "0 45 90", "0 10 0 20 0 30"));
  const IesProfile half = Parse(File("0 90", "0 90 180", "0 10 0 20 0 30"));
  const IesProfile turned = Parse(File("0 90", "90 180 270", "0 10 0 20 0 30"));
  const IesProfile whole = Parse(File("0 90", "0 90 180 270 360", "0 10 0 20 0 30 0 40 0 10"));
  const IesProfile open = Parse(File("0 90", "0 90 180 270", "0 10 0 20 0 30 0 40"));
  struct Case {
    const IesProfile& lamp;
    double around, candelas;
  };
  for (const Case& c :
       {Case{quadrant, 0, 10}, {quadrant, 45, 20},  {quadrant, 90, 30},  {quadrant, 135, 20},
        {quadrant, 180, 10},   {quadrant, 225, 20}, {quadrant, 270, 30}, {quadrant, 337.5, 15},
        {half, 0, 10},         {half, 90, 20},      {half, 180, 30},     {half, 225, 25},
        {half, 270, 20},       {half, 315, 15},     {turned, 90, 10},    {turned, 135, 15},
        {turned, 180, 20},     {turned, 225, 25},   {turned, 270, 30},   {turned, 315, 25},
        {turned, 0, 20},       {turned, 45, 15},    {whole, 45, 15},     {whole, 180, 30},
        {whole, 315, 25},      {open, 225, 35},     {open, 315, 25}}) {
    EXPECT_NEAR(at(c.lamp, c.around), c.candelas, 1e-3) << c.around;
  }
}

TEST(IesFiles, MaySayMoreOfTiltedLamps) {
  std::string text = File("0 90", "0", "7 7");
  text.replace(text.find("TILT=NONE"), 9, "TILT=INCLUDE\n1\n3\n0 45 90\n1.0 0.9, 0.8");
  EXPECT_NEAR(Parse(text).Candelas(Towards(30, 0)), 7, 1e-4);
}

TEST(IesFiles, ThatAreBrokenAreLocated) {
  const std::string good = File("0 45 90", "0 90", "1 2 3 4 5 6");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  struct Case {
    std::string text, start, part;
  };
  for (const Case& c : {
           Case{"", "lamp.ies:1: ", "no IES file"},
           {"#?RADIANCE\n\n-Y 1 +X 1\n", "lamp.ies:3: ", "TILT"},
           {with("TILT=NONE", "TILT=lamp.tlt"), "lamp.ies:4: ", "TILT=NONE"},
           {with("1 1000", "1 many"), "lamp.ies:5: ", "lumens"},
           {with("1 2 0 0 0", "2 2 0 0 0"), "lamp.ies:5: ", "type C"},
           {with("3 2 1 2", "1 2 1 2"), "lamp.ies:5: ", "angles"},
           {with("3 2 1 2", "3.5 2 1 2"), "lamp.ies:5: ", "angles"},
           {with("1 1 100", "0 1 100"), "lamp.ies:6: ", "more than 0"},
           {with("0 45 90", "0 95 90"), "lamp.ies:7: ", "increase"},
           {with("0 45 90", "0 45 190"), "lamp.ies:7: ", "180"},
           {with("\n0 90\r", "\n0 70\r"), "lamp.ies:8: ", "horizontal"},
           {with("4 5 6", "4 -5 6"), "lamp.ies:9: ", "below 0"},
           {with("4 5 6", "4 x 6"), "lamp.ies:9: ", "candela value 5 of 6"},
           {with("4 5 6", "4 5"), "lamp.ies:10: ", "cut short"},
       }) {
    const absl::Status status = IesProfile::Parse(c.text, "lamp.ies").status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << c.part;
    EXPECT_EQ(std::string(status.message()).find(c.start), 0u) << status;
    EXPECT_NE(std::string(status.message()).find(c.part), std::string::npos) << status;
  }
}

TEST(IesFiles, BecomeDiagrams) {
  const LightFiles files;
  files.Write("lamp.IES", File("0 45 90", "0 90 180", "100 80 20 100 60 20 100 40 20"));
  const absl::StatusOr<Diagram> diagram =
      Diagram::Load("lamp.IES", EnvironmentMapping::kEqualArea, files.source());
  ASSERT_TRUE(diagram.ok()) << diagram.status();
  const IesProfile lamp = Parse(File("0 45 90", "0 90 180", "100 80 20 100 60 20 100 40 20"));
  for (double v = 1; v < 89; v += 3.7) {
    for (double h = 0; h < 360; h += 17) {
      const Vec3f w = Towards(v, h);
      EXPECT_NEAR(diagram->At(w), lamp.Candelas(w), 0.6) << v << " " << h;
    }
  }
  files.Write("bad.ies", "TILT=NONE\n1 2");
  const absl::Status status =
      Diagram::Load("bad.ies", EnvironmentMapping::kEqualArea, files.source()).status();
  EXPECT_EQ(std::string(status.message()).find("bad.ies:2: "), 0u) << status;
}

}  // namespace
}  // namespace strata
