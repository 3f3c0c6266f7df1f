#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"

namespace strata::test {
namespace {

/// Bad usage and bad input: status 2, nothing on stdout, one line on stderr.
void ExpectRefused(const CommandResult& result, const std::string& part) {
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
}

class EveryCommand : public testing::TestWithParam<const char*> {};

TEST_P(EveryCommand, HasHelpWithExamples) {
  const CommandResult help = RunInProcess({GetParam(), "--help"});
  EXPECT_EQ(help.exit_status, 0);
  EXPECT_EQ(help.err, "");
  const std::string command = std::string("strata ") + GetParam();
  EXPECT_NE(help.out.find("Usage: " + command), std::string::npos) << help.out;
  const size_t examples = help.out.find("Examples:");
  ASSERT_NE(examples, std::string::npos) << help.out;
  const std::string shown = help.out.substr(examples);
  const auto first = shown.find(command);
  ASSERT_NE(first, std::string::npos) << shown;
  EXPECT_NE(shown.find(command, first + 1), std::string::npos) << "fewer than two examples";
}

TEST_P(EveryCommand, SuggestsTheOptionThatWasMeant) {
  ExpectRefused(RunInProcess({GetParam(), "--hepl"}), "did you mean --help?");
}

INSTANTIATE_TEST_SUITE_P(All, EveryCommand,
                         testing::Values("render", "submit", "watch", "jobs", "workers", "logs",
                                         "fetch", "cancel", "pause", "resume", "retry", "delete",
                                         "set", "check", "diff", "replay", "health", "lab"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Usage, TheHelpListsTheCommands) {
  const CommandResult help = RunInProcess({"--help"});
  EXPECT_EQ(help.exit_status, 0);
  for (const char* command : {"render", "submit", "watch", "fetch", "check", "diff", "health"}) {
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
  }
}

TEST(Usage, TheVersionNamesTheBuild) {
  const CommandResult version = RunStrata({"--version"});
  EXPECT_EQ(version.exit_status, 0);
  EXPECT_TRUE(std::regex_match(version.out, std::regex("strata [0-9]+\\.[0-9]+\\.[0-9]+.*\n")))
      << version.out;
}

TEST(Usage, NoCommandIsBadUsage) { ExpectRefused(RunStrata({}), "strata --help"); }

TEST(Usage, AMisspeltCommandIsCorrected) {
  ExpectRefused(RunInProcess({"rendr", "scene.pbrt"}), "did you mean render?");
}

TEST(Usage, AMisspeltOptionIsCorrectedThoughItTookTheScenesPlace) {
  ExpectRefused(RunInProcess({"render", "--sppp", "64"}), "no option --sppp - did you mean --spp?");
}

TEST(Usage, AMissingArgumentIsNamed) {
  ExpectRefused(RunInProcess({"render"}), "SCENE");
  ExpectRefused(RunInProcess({"watch"}), "JOB");
  ExpectRefused(RunInProcess({"fetch", "j-1"}), "output");
  ExpectRefused(RunInProcess({"diff", "a.exr"}), "B is required");
}

TEST(Usage, ValuesOfTheWrongKindAreNamed) {
  ExpectRefused(RunInProcess({"render", "a.pbrt", "--spp", "many"}), "--spp");
  ExpectRefused(RunInProcess({"render", "a.pbrt", "--spp", "-8"}), "--spp");
  ExpectRefused(RunInProcess({"render", "a.pbrt", "--threads", "0"}), "--threads");
  ExpectRefused(RunInProcess({"render", "a.pbrt", "--resolution", "big"}), "--resolution");
  ExpectRefused(RunInProcess({"render", "a.pbrt", "--reproducible=perhaps"}), "--reproducible");
}

TEST(Usage, WhatLaterVersionsDoIsRefusedWithASentence) {
  ExpectRefused(RunInProcess({"render", "a.pbrt", "--integrator", "bdpt"}),
                "--integrator is not there yet");
}

TEST(Usage, AnImagePathThatCannotBeWrittenIsFoundBeforeTheWork) {
  const SceneFolder folder;
  const std::string scene = folder.TinyScene();
  ExpectRefused(RunInProcess({"render", scene, "-o", folder.Path("no/such/out.exr")}), "directory");
  ExpectRefused(RunInProcess({"render", scene, "-o", folder.Path("out.jpg")}), ".exr nor .png");
  ExpectRefused(RunInProcess({"render", scene, "--png"}), "-o out.exr");
  ExpectRefused(RunInProcess({"submit", scene, "-o", folder.Path("out.exr")}), "--watch");
}

TEST(Usage, ASceneThatIsNotThereIsNamed) {
  ExpectRefused(RunInProcess({"render", "missing.pbrt"}), "missing.pbrt: ");
}

TEST(Usage, AServerThatDoesNotAnswerIsStatus3WithARemedy) {
  // Port 1 of this machine: nothing of ours listens there.
  const CommandResult result = RunStrata({"health", "--server", "127.0.0.1:1"});
  EXPECT_EQ(result.exit_status, 3);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find("127.0.0.1:1"), std::string::npos);
  EXPECT_NE(result.err.find("strata-coordinator --listen"), std::string::npos) << result.err;
}

TEST(Usage, TheServerMayBeNamedByTheEnvironment) {
  // Another machine, which is refused before it is dialled.
  const CommandResult result =
      RunStrata({"jobs"}, {.environment = {{"STRATA_SERVER", "192.0.2.1:7447"}}});
  ExpectRefused(result, "192.0.2.1:7447: ");
  EXPECT_NE(result.err.find("--insecure"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace strata::test
