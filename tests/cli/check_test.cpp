#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"

namespace strata::test {
namespace {

using nlohmann::json;

TEST(Check, SaysWhatASceneUsesAndHowLargeItIs) {
  const SceneFolder folder;
  const CommandResult check = RunStrata({"check", folder.TinyScene(), "--json"});
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
  const CommandResult check = RunStrata({"check", folder.TinyScene(), "--resolution", "48x32"});
  EXPECT_EQ(check.exit_status, 0);
  for (const char* part : {"48 x 32", "2 trianglemesh", "1 area", "everything is supported"}) {
    EXPECT_NE(check.out.find(part), std::string::npos) << part << " in:\n" << check.out;
  }
}

TEST(Check, WhatIsNotSupportedIsAWarningWithItsPlace) {
  const SceneFolder folder;
  const std::string scene = folder.Write("fog.pbrt", R"(Camera "perspective"
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [1 1 1]
MediumInterface "fog" ""
Shape "sphere"
)");
  const CommandResult check = RunStrata({"check", scene});
  EXPECT_EQ(check.exit_status, 0) << check.err;
  EXPECT_NE(check.err.find(scene + ":"), std::string::npos) << check.err;
  EXPECT_NE(check.err.find(": warning: "), std::string::npos) << check.err;
  EXPECT_EQ(check.out.find("everything is supported"), std::string::npos) << check.out;
}

TEST(Check, AnErrorInTheSceneIsOneLocatedLineAndStatus2) {
  const SceneFolder folder;
  const std::string scene =
      folder.Write("bad.pbrt", "Camera \"perspective\"\nWorldBegin\nShpae \"sphere\"\n");
  for (const std::string command : {"check", "render"}) {
    const CommandResult result = RunStrata({command, scene});
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
  const CommandResult refused = RunStrata({"check", scene});
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_NE(refused.err.find("--root"), std::string::npos) << refused.err;

  const CommandResult rooted = RunStrata({"check", scene, "--root", folder.Path(""), "--json"});
  ASSERT_EQ(rooted.exit_status, 0) << rooted.err;
  EXPECT_EQ(json::parse(rooted.out)["files"], 2);
  EXPECT_EQ(json::parse(rooted.out)["scene"], "room/scene.pbrt");
}

}  // namespace
}  // namespace strata::test
