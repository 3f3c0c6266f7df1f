#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/scene_summary.h"
#include "common/image_file.h"
#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"

namespace strata::test {
namespace {

using nlohmann::json;

TEST(Check, SaysWhatASceneUsesAndHowLargeItIs) {
  const SceneFolder folder;
  const CommandResult check = RunInProcess({"check", folder.TinyScene(), "--json"});
  ASSERT_EQ(check.exit_status, 0) << check.err;
  const json result = json::parse(check.out);
  EXPECT_EQ(result["scene"], "tiny.pbrt");
  EXPECT_EQ(result["width"], 24);
  EXPECT_EQ(result["height"], 16);
  EXPECT_EQ(result["spp"], 16);
  EXPECT_EQ(result["max_depth"], 4);
  EXPECT_EQ(result["sampler"], "independent");
  EXPECT_EQ(result["shapes"], json({{"sphere", 1}, {"trianglemesh", 2}}));
  EXPECT_EQ(result["triangles"], 4);
  EXPECT_EQ(result["lights"], json({{"area", 1}}));
  EXPECT_EQ(result["materials"]["conductor"], 1);
  EXPECT_EQ(result["files"], 1);
  EXPECT_EQ(result["file_bytes"], ReadFile(folder.Path("tiny.pbrt")).size());
  // 30 doubles and 16 bytes of counts for each pixel.
  EXPECT_EQ(result["film_bytes"], 24 * 16 * 256);
  EXPECT_EQ(result["warnings"], json::array());
}

TEST(Check, TellsPeopleTheSameInWords) {
  const SceneFolder folder;
  const CommandResult check = RunInProcess({"check", folder.TinyScene(), "--resolution", "48x32"});
  EXPECT_EQ(check.exit_status, 0);
  for (const char* part : {"48 x 32", "2 trianglemesh", "1 area", "everything is supported"}) {
    EXPECT_NE(check.out.find(part), std::string::npos) << part << " in:\n" << check.out;
  }
}

TEST(Check, PixelsThatSeeTheBackgroundOnlyAreCounted) {
  const SceneFolder folder;
  const std::string scene = folder.Write("ball.pbrt", R"(Film "rgb" "integer xresolution" 40
  "integer yresolution" 40
LookAt 0 0 -9  0 0 0  0 1 0
Camera "perspective" "float fov" 45
WorldBegin
LightSource "distant" "point3 from" [0 1 -1]
Shape "sphere"
)");
  const CommandResult check = RunInProcess({"check", scene, "--json"});
  ASSERT_EQ(check.exit_status, 0) << check.err;
  // The ball takes a third of the width.
  EXPECT_GT(json::parse(check.out)["background_pixels"], 40 * 40 / 2);
  EXPECT_LT(json::parse(check.out)["background_pixels"], 40 * 40 * 8 / 9);
  const std::string line =
      BackgroundLine(json::parse(check.out)["background_pixels"].get<int64_t>(), 40 * 40);
  EXPECT_NE(RunInProcess({"check", scene}).err.find(line), std::string::npos);
  // The report of a job has it from a worker.
  const CommandResult render =
      RunStrata({"render", scene, "--spp", "8", "-o", folder.Path("ball.exr")});
  EXPECT_NE(render.out.find(line), std::string::npos) << render.out << render.err;
}

TEST(Check, WhatIsNotSupportedIsAWarningWithItsPlace) {
  const SceneFolder folder;
  const std::string scene = folder.Write("fog.pbrt", R"(Camera "perspective"
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
MakeNamedMedium "fog" "string type" "cloud"
MediumInterface "fog" ""
Shape "sphere"
)");
  const CommandResult check = RunInProcess({"check", scene});
  EXPECT_EQ(check.exit_status, 0) << check.err;
  EXPECT_NE(check.err.find(scene + ":"), std::string::npos) << check.err;
  EXPECT_NE(check.err.find(": warning: "), std::string::npos) << check.err;
  EXPECT_EQ(check.out.find("everything is supported"), std::string::npos) << check.out;
}

TEST(Check, ACoatOverMetalOfAnotherThicknessIsWarnedOf) {
  const SceneFolder folder;
  for (const auto& [thickness, warned] : {std::pair{"0.01", false}, {"0.2", true}}) {
    const std::string scene = folder.Write(
        "coat.pbrt", std::string("WorldBegin\nMaterial \"coatedconductor\" \"float thickness\" [") +
                         thickness + "]\nShape \"sphere\"\n");
    const CommandResult check = RunInProcess({"check", scene});
    EXPECT_EQ(check.exit_status, 0) << check.err;
    EXPECT_EQ(check.err.find(scene + ":2: warning: the \"thickness\"") == 0, warned) << check.err;
  }
}

TEST(Check, AnErrorInTheSceneIsOneLocatedLineAndStatus2) {
  const SceneFolder folder;
  const std::string scene =
      folder.Write("bad.pbrt", "Camera \"perspective\"\nWorldBegin\nShpae \"sphere\"\n");
  for (const std::string command : {"check", "render"}) {
    const CommandResult result = RunInProcess({command, scene});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.find(scene + ":3: "), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

TEST(Check, ErrorsNameFilesAsTheyWereTyped) {
  const SceneFolder folder;
  folder.Write("room/bad.pbrt", "WorldBegin\nShpae \"sphere\"\n");
  const CommandResult result =
      RunStrata({"check", "room/bad.pbrt"}, {.directory = folder.Path("")});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_EQ(result.err.find("room/bad.pbrt:2: "), 0u) << result.err;
}

TEST(Check, FilesOutsideTheScenesFolderNeedARoot) {
  const SceneFolder folder;
  folder.Write("shared/ball.pbrt", "Shape \"sphere\"\n");
  const std::string scene = folder.Write("room/scene.pbrt",
                                         "Camera \"perspective\"\nWorldBegin\n"
                                         "LightSource \"infinite\" \"rgb L\" [1 1 1]\n"
                                         "Include \"../shared/ball.pbrt\"\n");
  const CommandResult refused = RunInProcess({"check", scene});
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_NE(refused.err.find("--root"), std::string::npos) << refused.err;

  const CommandResult rooted = RunInProcess({"check", scene, "--root", folder.Path(""), "--json"});
  ASSERT_EQ(rooted.exit_status, 0) << rooted.err;
  EXPECT_EQ(json::parse(rooted.out)["files"], 2);
  EXPECT_EQ(json::parse(rooted.out)["scene"], "room/scene.pbrt");
}

/// The bytes of a PNG image of 16x16 pixels, of many colours, so that half of them is not enough.
std::string WholePng(const SceneFolder& folder) {
  ImageLayers image;
  image.full_width = image.full_height = 16;
  image.crop = {0, 0, 16, 16};
  image.channels = {"R", "G", "B"};
  for (int i = 0; i < 16 * 16 * 3; ++i)
    image.values.push_back(static_cast<float>(i * i % 255) / 255);
  EXPECT_TRUE(WritePng(folder.Path("whole.png"), image).ok());
  return ReadFile(folder.Path("whole.png"));
}

/// A scene whose only use of image.png is `user`.
std::string SceneWithImage(const std::string& user) {
  return "Camera \"perspective\"\nWorldBegin\n" + user + "\nShape \"sphere\"\n";
}

class BrokenImage : public testing::TestWithParam<const char*> {};

TEST_P(BrokenImage, IsBadInputBeforeAnythingIsSubmitted) {
  const SceneFolder folder;
  const std::string scene = folder.Write("scene.pbrt", SceneWithImage(GetParam()));
  const std::string whole = WholePng(folder);
  // The control: nothing but the image is wrong with this scene.
  const std::string image = folder.Write("image.png", whole);
  const CommandResult good = RunInProcess({"check", scene});
  EXPECT_EQ(good.exit_status, 0) << good.err;
  for (const std::string& content :
       {whole.substr(0, whole.size() / 2), std::string("no image"), std::string()}) {
    folder.Write("image.png", content);
    // Nobody answers at port 1: had anything been sent, the exit status would be 3.
    for (const std::vector<std::string>& words : {std::vector<std::string>{"render", scene},
                                                  {"submit", scene, "--server", "127.0.0.1:1"},
                                                  {"check", scene}}) {
      const CommandResult result = RunInProcess(words);
      EXPECT_EQ(result.exit_status, 2) << words[0];
      EXPECT_EQ(result.out, "");
      EXPECT_EQ(result.err.find(image + ": "), 0u) << result.err;
      EXPECT_NE(result.err.find("replace it with a whole image"), std::string::npos) << result.err;
    }
  }
}

constexpr const char* kImageUses[] = {"Texture", "Environment", "Projection", "Diagram",
                                      "AreaLight"};

INSTANTIATE_TEST_SUITE_P(
    All, BrokenImage,
    testing::Values("Texture \"paint\" \"spectrum\" \"imagemap\" \"string filename\" \"image.png\" "
                    "Material \"diffuse\" \"texture reflectance\" \"paint\"",
                    "LightSource \"infinite\" \"string filename\" \"image.png\"",
                    "LightSource \"projection\" \"string filename\" \"image.png\"",
                    "LightSource \"goniometric\" \"string filename\" \"image.png\"",
                    "AreaLightSource \"diffuse\" \"string filename\" \"image.png\" "
                    "Shape \"sphere\""),
    [](const auto& info) { return std::string(kImageUses[info.index]); });

TEST(Check, ABrokenImageIsOneLineWhateverItsReaderSays) {
  const SceneFolder folder;
  const std::string whole = WholePng(folder);
  folder.Write("room/image.png", whole.substr(0, whole.size() / 2));
  folder.Write("room/scene.pbrt",
               SceneWithImage("LightSource \"infinite\" \"string filename\" \"image.png\""));
  const CommandResult result =
      RunStrata({"render", "room/scene.pbrt"}, {.directory = folder.Path("")});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_EQ(result.err.find("room/image.png: "), 0u) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST(Check, WhatNothingUsesIsNotedAndNeedNotExist) {
  const SceneFolder folder;
  const std::string scene = folder.Write(
      "scene.pbrt",
      SceneWithImage("Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"gone.png\" "
                     "MakeNamedMaterial \"idle\" \"string type\" \"diffuse\" "
                     "\"texture reflectance\" \"a\""));
  const CommandResult lines = RunInProcess({"check", scene});
  EXPECT_EQ(lines.exit_status, 0) << lines.err;
  EXPECT_NE(lines.err.find("not used, so neither sent nor built: 1 material, 1 texture (1 image)"),
            std::string::npos)
      << lines.err;
  const CommandResult json = RunInProcess({"check", scene, "--json"});
  EXPECT_NE(json.out.find("\"unused\":{\"objects\":0,\"materials\":1,\"textures\":1,\"images\":1}"),
            std::string::npos)
      << json.out;
}

TEST(Check, AnImageWithATexelThatIsNotFiniteIsRefused) {
  const SceneFolder folder;
  std::string pixels;
  for (const float value : {1.0f, std::nanf("")}) {
    for (int channel = 0; channel < 3; ++channel) {
      pixels.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  const std::string image = folder.Write("paint.pfm", "PF\n2 1\n-1.0\n" + pixels);
  const std::string scene = folder.Write(
      "scene.pbrt",
      SceneWithImage("Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"paint.pfm\" "
                     "Material \"diffuse\" \"texture reflectance\" \"a\""));
  for (const char* command : {"render", "check"}) {
    const CommandResult result = RunInProcess({command, scene});
    EXPECT_EQ(result.exit_status, 2) << command;
    EXPECT_EQ(result.err.find(image + ": the image's texel (1, 0) is NaN"), 0u) << result.err;
  }
}

TEST(Check, ABrokenIesFileIsLocatedAtTheLightAndInTheFile) {
  const SceneFolder folder;
  folder.Write("lamp.ies", "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 2 2 0 0 0\n");
  const std::string scene = folder.Write(
      "scene.pbrt", SceneWithImage("LightSource \"goniometric\" \"string filename\" \"lamp.ies\""));
  for (const char* command : {"render", "check"}) {
    const CommandResult result = RunInProcess({command, scene});
    EXPECT_EQ(result.exit_status, 2) << command;
    EXPECT_EQ(result.err.find(scene + ":3: lamp.ies:3: "), 0u) << result.err;
    EXPECT_NE(result.err.find("type C"), std::string::npos) << result.err;
  }
}

TEST(Check, AnImageThatIsNoEnvironmentIsLocatedAtTheLight) {
  const SceneFolder folder;
  folder.Write("wide.pfm", std::string("PF\n2 1\n-1.0\n") + std::string(24, '\0'));
  const std::string scene = folder.Write(
      "scene.pbrt", SceneWithImage("LightSource \"infinite\" \"string filename\" \"wide.pfm\""));
  const CommandResult result = RunInProcess({"render", scene});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_EQ(result.err.find(scene + ":3: wide.pfm: "), 0u) << result.err;
}

}  // namespace
}  // namespace strata::test
