#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/job_options.h"
#include "common/image_file.h"
#include "common/replay_command.h"
#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"
#include "worker/integrator/render.h"

// glTF files, and what a command line may say in place of a camera and a light.

namespace strata::test {
namespace {

using nlohmann::json;

/// A triangle, its buffer a file beside it.
std::string Triangle(const SceneFolder& folder, const std::string& name) {
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  folder.Write("models/triangle.bin",
               std::string(reinterpret_cast<const char*>(positions), sizeof positions));
  return folder.Write("models/" + name, R"({"asset": {"version": "2.0"},
    "buffers": [{"uri": "triangle.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})");
}

/// A sky of one colour, `name` in the folder.
std::string Sky(const SceneFolder& folder, const std::string& name) {
  ImageLayers sky;
  sky.full_width = 4;
  sky.full_height = 2;
  sky.crop = {0, 0, 4, 2};
  sky.channels = {"R", "G", "B"};
  sky.values.assign(24, 0.25f);
  EXPECT_TRUE(WriteExr(folder.Path(name), sky).ok());
  return folder.Path(name);
}

TEST(Gltf, CheckNamesWhatIsMissingAndWhatStandsIn) {
  const SceneFolder folder;
  const std::string scene = Triangle(folder, "scene.gltf");
  const CommandResult bare = RunInProcess({"check", scene, "--json"});
  ASSERT_EQ(bare.exit_status, 0) << bare.err;
  EXPECT_EQ(json::parse(bare.out)["files"], 2);
  EXPECT_EQ(json::parse(bare.out)["warnings"].size(), 2u) << bare.out;

  const CommandResult full = RunInProcess(
      {"check", scene, "--json", "--env", Sky(folder, "sky.exr"), "--camera=0,0,5,0,0,0"});
  ASSERT_EQ(full.exit_status, 0) << full.err;
  EXPECT_EQ(json::parse(full.out)["files"], 3) << "the image joins the files";
  EXPECT_EQ(json::parse(full.out)["warnings"].size(), 0u) << full.out;
  EXPECT_EQ(json::parse(full.out)["lights"]["infinite image"], 1);
  EXPECT_NE(json::parse(full.out)["scene_digest"], json::parse(bare.out)["scene_digest"]);
}

TEST(Gltf, AnImageAndACameraOfTheCommandLineReachTheWorkers) {
  const SceneFolder folder;
  const std::string sky = Sky(folder, "sky.exr");
  const std::vector<std::string> options = {
      "--env", sky,         "--camera", "0.3,0.3,-5,0.3,0.3,0",
      "--spp", "8",         "--quiet",  "--resolution",
      "16x16", "--threads", "1"};
  // The sky's image lies outside of the folder of either scene.
  folder.Write("models/ball.pbrt",
               "Camera \"perspective\"\nWorldBegin\nShape \"disk\"\n"
               "LightSource \"infinite\" \"rgb L\" [9 9 9]\n");
  for (const std::string& scene :
       {Triangle(folder, "scene.gltf"), folder.Path("models/ball.pbrt")}) {
    std::vector<std::string> words = {"render", scene, "-o", folder.Path("out.exr")};
    words.insert(words.end(), options.begin(), options.end());
    const CommandResult render = RunInProcess(words);
    ASSERT_EQ(render.exit_status, 0) << render.err;
    const auto image = ReadExr(folder.Path("out.exr"));
    ASSERT_TRUE(image.ok()) << image.status();
    // A corner shows the sky, and nothing of the light that the file has.
    EXPECT_NEAR(image->values[0], 0.25, 1e-3) << scene;
  }
}

TEST(Gltf, OptionsThatAreNoneAreRefused) {
  const SceneFolder folder;
  const std::string scene = Triangle(folder, "scene.gltf");
  for (const auto& [words, expected] :
       std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--env", "gone.exr"}, "--env: gone.exr: there is no such file"},
           {{"--env", scene}, "not an image"},
           {{"--light-selection", "luck"}, "--light-selection: light selection \"luck\""},
           {{"--camera", "far"}, "there is no camera \"far\""},
           {{"--camera", "1,2,3,1,2,3"}, "looks at the point where it stands"},
           {{"--camera", "1,2,3,1,2,4,190"}, "between 0 and 180"}}) {
    std::vector<std::string> all = {"check", scene};
    all.insert(all.end(), words.begin(), words.end());
    const CommandResult result = RunInProcess(all);
    EXPECT_EQ(result.exit_status, 2) << expected;
    EXPECT_NE(result.err.find(expected), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  const CommandResult pbrt = RunInProcess({"check", folder.TinyScene(), "--camera", "far"});
  EXPECT_EQ(pbrt.exit_status, 2);
  EXPECT_NE(pbrt.err.find("x,y,z"), std::string::npos) << pbrt.err;
}

}  // namespace
}  // namespace strata::test
