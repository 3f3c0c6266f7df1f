#include "cli/events.h"

#include <nlohmann/json.hpp>

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

/// Names come from other people: bytes that are no UTF-8 are replaced.
std::string Dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json RectJson(const PixelRect& rect) { return Json::array({rect.x0, rect.y0, rect.x1, rect.y1}); }

/// Null where the time left is not known.
Json EtaJson(const JobStatus& status) {
  return status.eta_s < 0 ? Json(nullptr) : Json(status.eta_s);
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
          {"fraction", status.fraction},
          {"samples", status.samples},
          {"spp_mean", status.spp_mean},
          {"rel_error", status.rel_error},
          {"flagged", status.flagged},
          {"nonfinite", status.nonfinite},
          {"samples_per_s", status.samples_per_second},
          {"eta_s", EtaJson(status)},
          {"workers", status.workers},
          {"submitted_unix_s", status.submitted_unix_s},
          {"wall_s", status.wall_s}};
}

}  // namespace

std::string ProgressEvent(const JobStatus& status) {
  Json worst = Json::array();
  for (const TileError& tile : status.worst_tiles) {
    worst.push_back({{"pixels", RectJson(tile.pixels)}, {"rel_error", tile.rel_error}});
  }
  return Dump({{"event", "progress"},
               {"job", status.id},
               {"fraction", status.fraction},
               {"spp_mean", status.spp_mean},
               {"rel_error", status.rel_error},
               {"eta_s", EtaJson(status)},
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
               {"rel_error", status.rel_error},
               {"target_met", TargetMet(status)},
               {"nonfinite", status.nonfinite},
               {"flagged", status.flagged},
               {"digest", status.result.ToString()}});
}

std::string JobsJson(const std::vector<JobStatus>& jobs) {
  Json list = Json::array();
  for (const JobStatus& job : jobs) list.push_back(JobJson(job));
  return Dump(list);
}

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

bool TargetMet(const JobStatus& status) { return status.state == JobState::kDone; }

}  // namespace strata
