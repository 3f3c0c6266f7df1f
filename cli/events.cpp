#include "cli/events.h"

#include "cli/json.h"

namespace strata {
namespace {

/// Names come from other people: bytes that are no UTF-8 are replaced.
std::string Dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Null where an estimate is not known.
Json KnownJson(double estimate) { return estimate < 0 ? Json(nullptr) : Json(estimate); }

/// `rel_error` is the job's or a tile's; null where no interval is claimed.
Json RelErrorJson(const JobStatus& status, double rel_error) {
  return ClaimsInterval(status.spec.sampler) ? Json(rel_error) : Json(nullptr);
}

/// Null for a job without a target.
Json TargetJson(const JobSpec& spec) {
  if (spec.target == TargetKind::kSamples) return nullptr;
  return {{"kind", std::string(ToString(spec.target))}, {"value", spec.target_value}};
}

Json MeanJson(const JobStatus& status) {
  return Json::array({status.mean_rgb[0], status.mean_rgb[1], status.mean_rgb[2]});
}

Json JobJson(const JobStatus& status) {
  return {{"job", status.id},
          {"name", status.spec.name},
          {"state", std::string(ToString(status.state))},
          {"message", status.message},
          {"priority", status.spec.priority},
          {"frame", status.spec.frame},
          {"width", status.spec.width},
          {"height", status.spec.height},
          {"crop", RectJson(status.spec.crop)},
          {"spp", status.spec.spp},
          {"allocation", std::string(ToString(status.spec.allocation))},
          {"target", TargetJson(status.spec)},
          {"fraction", status.fraction},
          {"samples", status.samples},
          {"spp_mean", status.spp_mean},
          {"rel_error", RelErrorJson(status, status.rel_error)},
          {"flagged", status.flagged},
          {"nonfinite", status.nonfinite},
          {"samples_per_s", status.samples_per_second},
          {"eta_s", KnownJson(status.eta_s)},
          {"workers", status.workers},
          {"submitted_unix_s", status.submitted_unix_s},
          {"wall_s", status.wall_s}};
}

}  // namespace

std::string ProgressEvent(const JobStatus& status) {
  Json worst = Json::array();
  for (const TileError& tile : status.worst_tiles) {
    worst.push_back(
        {{"pixels", RectJson(tile.pixels)}, {"rel_error", RelErrorJson(status, tile.rel_error)}});
  }
  return Dump({{"event", "progress"},
               {"job", status.id},
               {"fraction", status.fraction},
               {"spp_mean", status.spp_mean},
               {"rel_error", RelErrorJson(status, status.rel_error)},
               {"eta_s", KnownJson(status.eta_s)},
               {"eta_low_s", KnownJson(status.eta_low_s)},
               {"eta_high_s", KnownJson(status.eta_high_s)},
               {"samples_left", KnownJson(status.samples_left)},
               {"rounds", status.rounds},
               {"workers", status.workers},
               {"state", std::string(ToString(status.state))},
               {"samples", status.samples},
               {"samples_per_s", status.samples_per_second},
               {"flagged", status.flagged},
               {"worst_tiles", worst}});
}

std::string DoneEvent(const JobStatus& status) {
  return Dump({{"event", "done"},
               {"job", status.id},
               {"wall_s", status.wall_s},
               {"load_s", status.load_s},
               {"render_s", status.render_s},
               {"samples", status.samples},
               {"spp_mean", status.spp_mean},
               {"rays", status.rays},
               {"mean_rgb", MeanJson(status)},
               {"rel_error", RelErrorJson(status, status.rel_error)},
               {"target_met", TargetMet(status)},
               {"target_share", status.target_share},
               {"rounds", status.rounds},
               {"nonfinite", status.nonfinite},
               {"flagged", status.flagged},
               {"digest", status.result.ToString()}});
}

std::string JobsJson(const std::vector<JobStatus>& jobs) {
  Json list = Json::array();
  for (const JobStatus& job : jobs) list.push_back(JobJson(job));
  return Dump(list);
}

std::string ControlJson(const JobStatus& status) {
  return Dump({{"job", status.id},
               {"state", std::string(ToString(status.state))},
               {"priority", status.spec.priority}});
}

std::string DeletedJson(const JobId& job) { return Dump({{"job", job}, {"deleted", true}}); }

std::string WorkersJson(const std::vector<WorkerStatus>& workers) {
  Json list = Json::array();
  for (const WorkerStatus& worker : workers) {
    list.push_back({{"worker", worker.id},
                    {"name", worker.name},
                    {"state", worker.state},
                    {"tags", worker.tags},
                    {"threads", worker.threads},
                    {"leases", worker.leases},
                    {"samples", worker.samples},
                    {"connected_s", worker.connected_s},
                    {"silent_s", worker.silent_s},
                    {"build", worker.build}});
  }
  return Dump(list);
}

std::string LogsJson(const std::vector<LogLine>& lines) {
  Json list = Json::array();
  for (const LogLine& line : lines) {
    list.push_back({{"unix_s", line.unix_s}, {"level", line.level}, {"text", line.text}});
  }
  return Dump(list);
}

bool TargetMet(const JobStatus& status) {
  return status.state == JobState::kDone && status.target_met;
}

}  // namespace strata
