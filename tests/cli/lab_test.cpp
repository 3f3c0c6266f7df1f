#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "cli/lab/experiment.h"
#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"

namespace strata::test {
namespace {

TEST(Lab, TheListSaysWhatEachExperimentDoes) {
  const CommandResult list = RunInProcess({"lab", "list"});
  EXPECT_EQ(list.exit_status, 0);
  for (const lab::Experiment& experiment : lab::Experiments()) {
    EXPECT_NE(list.out.find(experiment.name), std::string::npos);
    EXPECT_NE(list.out.find(experiment.sentence), std::string::npos);
  }
}

TEST(Lab, AnExperimentPrintsATableOrCommaSeparatedValues) {
  const CommandResult text = RunInProcess({"lab", "importance", "--samples", "1000"});
  EXPECT_EQ(text.exit_status, 0) << text.err;
  EXPECT_NE(text.out.find("V in theory"), std::string::npos);
  EXPECT_NE(text.out.find("1.286"), std::string::npos) << "16 / 7 - 1";
  const CommandResult csv =
      RunInProcess({"lab", "importance", "--samples", "1000", "--seed", "3", "--csv"});
  EXPECT_EQ(csv.out.find("n,mean,standard error,V,"), 0u) << csv.out;
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 12);
}

TEST(Lab, APictureIsWrittenWhereItIsAskedFor) {
  const SceneFolder folder;
  const CommandResult result =
      RunInProcess({"lab", "area-light", "--samples", "2", "--out", folder.Path("light.png")});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder.Path("light.png")));
}

TEST(Lab, WhatIsWrongWithTheRequestIsSaidWithARemedy) {
  const auto expect_refused = [](const std::vector<std::string>& arguments, const char* part) {
    const CommandResult result = RunInProcess(arguments);
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  expect_refused({"lab"}, "NAME");
  expect_refused({"lab", "importence"}, "did you mean importance?");
  expect_refused({"lab", "unheard-of"}, "strata lab list");
  expect_refused({"lab", "importance", "--samples", "1"}, "--samples");
  expect_refused({"lab", "importance", "--csv", "--markdown"}, "exclude");
  expect_refused({"lab", "mis", "--out", "plates.jpg"}, ".png nor .exr");
  expect_refused({"lab", "all", "--out", "no/such/folder"}, "is no folder");
}

}  // namespace
}  // namespace strata::test
