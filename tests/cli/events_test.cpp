#include "cli/events.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

namespace strata {
namespace {

using nlohmann::json;

std::set<std::string> Keys(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

TEST(Events, TheDoneEventHasExactlyTheKeysScriptsRelyOn) {
  JobStatus status;
  status.id = "j-4";
  status.state = JobState::kDone;
  status.samples = 6144;
  status.target_met = true;
  status.mean_rgb[1] = 0.5;
  const std::string line = DoneEvent(status);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const json done = json::parse(line);
  EXPECT_EQ(Keys(done),
            (std::set<std::string>{"event", "job", "wall_s", "load_s", "render_s", "samples",
                                   "spp_mean", "rays", "mean_rgb", "rel_error", "target_met",
                                   "target_share", "rounds", "nonfinite", "flagged", "digest"}));
  EXPECT_EQ(done["event"], "done");
  EXPECT_EQ(done["job"], "j-4");
  EXPECT_EQ(done["samples"], 6144);
  EXPECT_EQ(done["mean_rgb"], json({0.0, 0.5, 0.0}));
  EXPECT_EQ(done["target_met"], true);
  EXPECT_EQ(done["digest"], "sha256:" + std::string(64, '0'));
}

TEST(Events, NoErrorIsToldWhereNoIntervalIsClaimed) {
  JobStatus status;
  status.spec.sampler = SamplerKind::kDrand48;
  status.worst_tiles = {{{0, 0, 32, 32}, 0.5}};
  EXPECT_TRUE(json::parse(DoneEvent(status))["rel_error"].is_null());
  const json progress = json::parse(ProgressEvent(status));
  EXPECT_TRUE(progress["rel_error"].is_null());
  EXPECT_TRUE(progress["worst_tiles"].at(0)["rel_error"].is_null());
}

TEST(Events, AJobThatFailedHasNotMetItsTarget) {
  JobStatus status;
  status.state = JobState::kFailed;
  status.target_met = true;
  EXPECT_EQ(json::parse(DoneEvent(status))["target_met"], false);
}

TEST(Events, ProgressHasTheFixedKeysAndNullForATimeNotKnown) {
  JobStatus status;
  status.id = "j-4";
  status.eta_s = -1;
  json progress = json::parse(ProgressEvent(status));
  for (const char* key : {"job", "fraction", "spp_mean", "rel_error", "eta_s", "workers"}) {
    EXPECT_TRUE(progress.contains(key)) << key;
  }
  EXPECT_EQ(progress["event"], "progress");
  EXPECT_TRUE(progress["eta_s"].is_null());
  status.eta_s = 2.5;
  progress = json::parse(ProgressEvent(status));
  EXPECT_EQ(progress["eta_s"], 2.5);
}

TEST(Events, ControlCommandsTellTheJobAsItStands) {
  JobStatus status;
  status.id = "j-4";
  status.state = JobState::kPaused;
  status.spec.priority = -3;
  EXPECT_EQ(ControlJson(status), R"({"job":"j-4","state":"paused","priority":-3})");
  EXPECT_EQ(DeletedJson("j-4"), R"({"job":"j-4","deleted":true})");
}

TEST(Events, NamesThatAreNoUtf8StillMakeJson) {
  JobStatus status;
  status.spec.name = "caf\xe9";
  EXPECT_TRUE(json::accept(JobsJson({status})));
}

TEST(Events, ListsAreArrays) {
  EXPECT_EQ(JobsJson({}), "[]");
  EXPECT_EQ(json::parse(WorkersJson({{.id = "w-1", .threads = 4}}))[0]["threads"], 4);
  EXPECT_EQ(json::parse(LogsJson({{1.5, "info", "hello"}}))[0]["text"], "hello");
}

}  // namespace
}  // namespace strata
