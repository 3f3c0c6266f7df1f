#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <sstream>
#include <thread>

#include "common/image_file.h"
#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"

// The client commands against a real coordinator and a real worker on loopback.

namespace strata::test {
namespace {

using nlohmann::json;

/// A coordinator on a free port, and workers as they are asked for.
class Farm {
 public:
  Farm()
      : coordinator_({"strata-coordinator", "--listen", "127.0.0.1:0", "--state",
                      folder_.Path("state"), "--port-file", folder_.Path("port")}) {
    // The file appears by rename, with the port in it, once the coordinator listens.
    while (!std::filesystem::exists(folder_.Path("port"))) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    server_ = "127.0.0.1:" + std::to_string(std::stoi(ReadFile(folder_.Path("port"))));
  }

  const SceneFolder& folder() const { return folder_; }
  const std::string& server() const { return server_; }

  void StartWorker() {
    worker_.emplace(std::vector<std::string>{"strata-worker", "--server", server_, "--cache",
                                             folder_.Path("cache"), "--threads", "1", "--name",
                                             "only one"});
  }

  CommandResult Strata(const std::vector<std::string>& arguments) const {
    return RunStrata(arguments, {.environment = {{"STRATA_SERVER", server_}}});
  }
  json StrataJson(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const CommandResult result = Strata(arguments);
    EXPECT_EQ(result.exit_status, 0) << result.err;
    return json::parse(result.out, nullptr, /*allow_exceptions=*/false);
  }
  /// Submits and returns the id printed.
  std::string Submit(const std::string& scene) const {
    const CommandResult submit = Strata({"submit", scene});
    EXPECT_EQ(submit.exit_status, 0) << submit.err;
    return submit.out.substr(0, submit.out.find('\n'));
  }

 private:
  SceneFolder folder_;
  RunningCommand coordinator_;
  std::optional<RunningCommand> worker_;
  std::string server_;
};

TEST(FarmCommands, AJobGoesFromSubmissionToAnImageWithTheDigestOfALocalRender) {
  Farm farm;
  farm.StartWorker();
  const std::string scene = farm.folder().TinyScene();
  EXPECT_EQ(farm.Strata({"health"}).exit_status, 0);

  const std::string out = farm.folder().Path("farm.exr");
  const CommandResult submit = farm.Strata({"submit", scene, "--watch", "-o", out, "--png"});
  ASSERT_EQ(submit.exit_status, 0) << submit.err;
  const std::string job = submit.out.substr(0, submit.out.find('\n'));
  EXPECT_TRUE(std::filesystem::exists(farm.folder().Path("farm.png")));
  ASSERT_TRUE(ReadExr(out).ok());

  const CommandResult local = RunStrata({"render", scene});
  const std::string digest = local.out.substr(local.out.find("sha256:"));
  EXPECT_NE(submit.out.find(digest), std::string::npos) << submit.out << local.out;

  const json jobs = farm.StrataJson({"jobs"});
  ASSERT_EQ(jobs.size(), 1u);
  EXPECT_EQ(jobs[0]["job"], job);
  EXPECT_EQ(jobs[0]["state"], "done");
  EXPECT_EQ(jobs[0]["name"], "tiny");
  const json workers = farm.StrataJson({"workers"});
  ASSERT_EQ(workers.size(), 1u);
  EXPECT_EQ(workers[0]["name"], "only one");
  EXPECT_FALSE(farm.StrataJson({"logs", job}).empty());

  const std::string fetched = farm.folder().Path("again.exr");
  const CommandResult fetch = farm.Strata({"fetch", job, "-o", fetched});
  EXPECT_EQ(fetch.exit_status, 0) << fetch.err;
  EXPECT_EQ(fetch.out, fetched + "\n");
  EXPECT_EQ(fetch.err, "");
  EXPECT_EQ(ReadExr(fetched)->values, ReadExr(out)->values);

  // A job that has ended can still be watched: its end is told at once.
  const CommandResult watch = farm.Strata({"watch", job, "--json"});
  EXPECT_EQ(watch.exit_status, 0) << watch.err;
  EXPECT_NE(watch.out.find("\"event\":\"done\""), std::string::npos) << watch.out;

  EXPECT_EQ(farm.Strata({"delete", job}).exit_status, 0);
  EXPECT_EQ(farm.Strata({"watch", job}).exit_status, 2);
  EXPECT_EQ(farm.Strata({"jobs"}).out.find(job), std::string::npos);
}

TEST(FarmCommands, AJobIsPausedResumedReorderedCancelledAndRetried) {
  Farm farm;
  const std::string job = farm.Submit(farm.folder().LongScene());
  const auto state = [&] { return farm.StrataJson({"jobs"})[0]["state"]; };
  EXPECT_EQ(farm.Strata({"pause", job}).exit_status, 0);
  EXPECT_EQ(state(), "paused");
  EXPECT_EQ(farm.Strata({"resume", job}).exit_status, 0);
  EXPECT_NE(state(), "paused");
  EXPECT_EQ(farm.Strata({"set", job, "--priority", "-7"}).exit_status, 0);
  EXPECT_EQ(farm.StrataJson({"jobs"})[0]["priority"], -7);
  EXPECT_EQ(farm.Strata({"set", job, "--priority", "1000"}).exit_status, 2);
  EXPECT_EQ(farm.Strata({"delete", job}).exit_status, 2) << "only jobs that have ended";
  EXPECT_EQ(farm.Strata({"cancel", job}).exit_status, 0);
  EXPECT_EQ(state(), "cancelled");
  EXPECT_EQ(farm.Strata({"watch", job}).exit_status, 1);
  EXPECT_EQ(farm.Strata({"retry", job}).exit_status, 0);
  EXPECT_NE(state(), "cancelled");
}

TEST(FarmCommands, ControlsTellScriptsTheJobAsItStands) {
  Farm farm;
  const std::string job = farm.Submit(farm.folder().LongScene());
  EXPECT_EQ(farm.StrataJson({"pause", job}),
            json({{"job", job}, {"state", "paused"}, {"priority", 0}}));
  EXPECT_EQ(farm.StrataJson({"set", job, "--priority", "9"})["priority"], 9);
  EXPECT_EQ(farm.StrataJson({"resume", job})["state"], "queued");
  EXPECT_EQ(farm.StrataJson({"cancel", job})["state"], "cancelled");
  EXPECT_EQ(farm.StrataJson({"retry", job})["state"], "queued");
  EXPECT_EQ(farm.StrataJson({"cancel", job})["state"], "cancelled");
  EXPECT_EQ(farm.StrataJson({"delete", job}), json({{"job", job}, {"deleted", true}}));
}

TEST(FarmCommands, CtrlCLeavesAWatchedJobAloneAndSaysHowToGoOn) {
  Farm farm;
  const std::string job = farm.Submit(farm.folder().LongScene());
  RunningCommand watch({"strata", "watch", job, "--server", farm.server()});
  EXPECT_TRUE(watch.WaitForError("waiting for a worker"));
  watch.Signal(SIGINT);
  const CommandResult result = watch.Wait();
  EXPECT_EQ(result.exit_status, 130);
  EXPECT_NE(result.err.find("strata cancel " + job), std::string::npos) << result.err;
  EXPECT_NE(farm.StrataJson({"jobs"})[0]["state"], "cancelled");
}

TEST(FarmCommands, AnImageFetchedEarlySaysHowMuchOfItIsThere) {
  Farm farm;
  farm.StartWorker();
  const std::string job = farm.Submit(farm.folder().LongScene());
  RunningCommand watch({"strata", "watch", job, "--server", farm.server(), "--json"});
  ASSERT_TRUE(watch.WaitForOutput("\"samples\":[1-9]"));
  const std::string out = farm.folder().Path("early.exr");
  const CommandResult fetch = farm.Strata({"fetch", job, "-o", out, "--png"});
  EXPECT_EQ(fetch.exit_status, 0);
  EXPECT_EQ(fetch.out, out + "\n" + farm.folder().Path("early.png") + "\n");
  EXPECT_TRUE(std::regex_match(fetch.err, std::regex("image so far: .* % of the samples\n")))
      << fetch.err;
}

TEST(FarmCommands, AJobThatIsNotThereIsBadInput) {
  Farm farm;
  for (const char* command : {"watch", "logs", "cancel", "pause", "resume", "retry", "delete"}) {
    const CommandResult result = farm.Strata({command, "j-999"});
    EXPECT_EQ(result.exit_status, 2) << command;
    EXPECT_NE(result.err.find("j-999"), std::string::npos) << result.err;
  }
}

TEST(FarmCommands, TablesAreAlignedUnderTheirTitles) {
  Farm farm;
  farm.Submit(farm.folder().LongScene());
  std::istringstream lines(farm.Strata({"jobs"}).out);
  std::string title, row;
  std::getline(lines, title);
  std::getline(lines, row);
  EXPECT_EQ(title.find("NAME"), row.find("long"));
}

}  // namespace
}  // namespace strata::test
