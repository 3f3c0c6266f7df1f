#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/image_file.h"
#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"

namespace strata::test {
namespace {

using nlohmann::json;

/// Renders the scene and returns the image's path.
std::string Render(const SceneFolder& folder, const std::string& scene, const std::string& name,
                   const std::vector<std::string>& options) {
  std::vector<std::string> arguments = {"render", scene, "-o", folder.Path(name), "--quiet"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const CommandResult render = RunStrata(arguments);
  EXPECT_EQ(render.exit_status, 0) << render.err;
  return folder.Path(name);
}

/// The tiny scene with a lamp that is 3 % brighter.
std::string BrighterScene(const SceneFolder& folder) {
  std::string text = ReadFile(folder.TinyScene());
  const std::string lamp = "[8 7 6]";
  return folder.Write("brighter.pbrt",
                      text.replace(text.find(lamp), lamp.size(), "[8.24 7.21 6.18]"));
}

const std::vector<std::string> kLarger = {"--resolution", "72x48", "--spp", "256"};

std::vector<std::string> Larger(const std::string& seed) {
  std::vector<std::string> options = kLarger;
  options.insert(options.end(), {"--seed", seed});
  return options;
}

void ExpectRefused(const CommandResult& result, const std::string& because) {
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(because), std::string::npos) << result.err;
}

TEST(Diff, RendersUnderTwoSeedsAgree) {
  const SceneFolder folder;
  const std::string scene = folder.TinyScene();
  const std::string a = Render(folder, scene, "a.exr", Larger("1"));
  const std::string b = Render(folder, scene, "b.exr", Larger("2"));
  const CommandResult diff = RunInProcess({"diff", a, b, "--json"});
  EXPECT_EQ(diff.exit_status, 0) << diff.out;
  EXPECT_EQ(diff.err, "");
  const json event = json::parse(diff.out);
  EXPECT_EQ(event["event"], "diff");
  EXPECT_EQ(event["verdict"], "agree");
  EXPECT_EQ(event["pixels"], 72 * 48);
  EXPECT_EQ(event["excluded"], 0);
  EXPECT_EQ(event["warnings"], json::array());
  for (const char* figure : {"mse", "rel_mse", "mrse"}) EXPECT_GT(event[figure], 0) << figure;
  const json& tests = event["tests"];
  EXPECT_EQ(tests["tests"].get<int>() + tests["constant_equal"].get<int>(), 5 * 3 * 3);
  for (const char* p : {"bias_p", "uniformity_p", "smallest_p"}) EXPECT_GT(tests[p], 0.001) << p;
  EXPECT_EQ(tests["bias_stderr_rgb"].size(), 3u);
}

TEST(Diff, ALampThreePerCentBrighterDisagrees) {
  const SceneFolder folder;
  const std::string a = Render(folder, BrighterScene(folder), "a.exr", Larger("1"));
  const std::string b = Render(folder, folder.TinyScene(), "b.exr", Larger("2"));
  const CommandResult diff = RunInProcess({"diff", a, b, "--json"});
  EXPECT_EQ(diff.exit_status, 1) << diff.out;
  const json event = json::parse(diff.out);
  EXPECT_EQ(event["verdict"], "disagree");
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(event["bias_rgb"][c], event["tests"]["detectable_bias_rgb"][c]);
  }

  const CommandResult told = RunInProcess({"diff", a, b});
  EXPECT_EQ(told.exit_status, 1);
  for (const char* part :
       {"a.exr: 72 x 48 pixels, 256 samples per pixel, seed 1", "(the reference)", "relMSE",
        "detectable bias", "Sidak", "they disagree"}) {
    EXPECT_NE(told.out.find(part), std::string::npos) << part << " in:\n" << told.out;
  }
}

TEST(Diff, TheSameJobIsAnIdenticalResult) {
  const SceneFolder folder;
  const std::string a = Render(folder, folder.TinyScene(), "a.exr", {"--tile", "8"});
  const std::string b = Render(folder, folder.TinyScene(), "b.exr", {"--tile", "16"});
  const CommandResult diff = RunInProcess({"diff", a, b});
  EXPECT_EQ(diff.exit_status, 0);
  EXPECT_EQ(diff.err, "");
  EXPECT_NE(diff.out.find("identical result: sha256:"), std::string::npos) << diff.out;
}

TEST(Diff, SharedRandomNumbersAreWarnedOfAndProveNothing) {
  const SceneFolder folder;
  const std::string a = Render(folder, folder.TinyScene(), "a.exr", {"--spp", "16"});
  const std::string b = Render(folder, folder.TinyScene(), "b.exr", {"--spp", "32"});
  const CommandResult diff = RunInProcess({"diff", a, b});
  EXPECT_EQ(diff.exit_status, 0) << diff.out;
  EXPECT_NE(diff.err.find("same random numbers (seed 0, frame 0)"), std::string::npos) << diff.err;
  EXPECT_NE(diff.err.find("sample counts differ"), std::string::npos) << diff.err;
  EXPECT_NE(diff.out.find("agreement is not tested"), std::string::npos) << diff.out;
}

TEST(Diff, ImagesWithoutErrorsGetFiguresAlone) {
  const SceneFolder folder;
  const std::string a = Render(folder, folder.TinyScene(), "a.exr", {});
  ImageLayers image = *ReadExr(a);
  ImageLayers plain = image;
  plain.channels = {"R", "G", "B"};
  plain.metadata.clear();
  plain.values.assign(24 * 16 * 3, 1.0f);
  const std::string b = folder.Path("b.exr");
  ASSERT_TRUE(WriteExr(b, plain).ok());
  const CommandResult diff = RunInProcess({"diff", a, b, "--json"});
  EXPECT_EQ(diff.exit_status, 0) << diff.err;
  EXPECT_NE(diff.err.find("standard errors"), std::string::npos) << diff.err;
  const json event = json::parse(diff.out);
  EXPECT_GT(event["mse"], 0);
  EXPECT_EQ(event["tests"], json(nullptr));
  EXPECT_EQ(event["verdict"], "not tested");
  EXPECT_EQ(event["warnings"].size(), 1u);
}

TEST(Diff, WhatCannotBeComparedIsOneSentenceAndStatus2) {
  const SceneFolder folder;
  const std::string whole = Render(folder, folder.TinyScene(), "whole.exr", {"--png"});
  const std::string part = Render(folder, folder.TinyScene(), "part.exr", {"--crop", "0,0,8,8"});
  ExpectRefused(RunInProcess({"diff", whole, part}), "part.exr: 8 x 8 pixels, but ");
  ExpectRefused(RunInProcess({"diff", whole, folder.Path("no.exr")}), "no.exr: there is no such");
  ExpectRefused(RunInProcess({"diff", folder.Path("whole.png"), whole}),
                "whole.png: not an OpenEXR file");
  ExpectRefused(RunInProcess({"diff", folder.Write("bad.exr", "text"), whole}), "bad.exr: ");

  ImageLayers depth = *ReadExr(part);
  depth.channels = {"Z"};
  depth.values.resize(64);
  ASSERT_TRUE(WriteExr(folder.Path("depth.exr"), depth).ok());
  ExpectRefused(RunInProcess({"diff", folder.Path("depth.exr"), part}),
                "depth.exr: there is no channel R");
}

}  // namespace
}  // namespace strata::test
