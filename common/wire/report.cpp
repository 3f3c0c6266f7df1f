#include "common/wire/report.h"

#include <algorithm>

#include "common/wire/field.h"
#include "common/wire/job.h"

namespace strata::wire {
namespace {

constexpr std::pair<JobState, v1::JobState> kStates[] = {
    {JobState::kQueued, v1::JOB_STATE_QUEUED}, {JobState::kRunning, v1::JOB_STATE_RUNNING},
    {JobState::kPaused, v1::JOB_STATE_PAUSED}, {JobState::kDone, v1::JOB_STATE_DONE},
    {JobState::kFailed, v1::JOB_STATE_FAILED}, {JobState::kCancelled, v1::JOB_STATE_CANCELLED},
};

}  // namespace

void ToWire(const JobStatus& status, v1::JobStatus* message, bool with_files) {
  message->set_id(status.id);
  ToWire(status.spec, message->mutable_spec(), with_files);
  for (const auto& [plain, wire] : kStates) {
    if (plain == status.state) message->set_state(wire);
  }
  message->set_message(status.message);
  message->set_fraction(status.fraction);
  message->set_samples(status.samples);
  message->set_rays(status.rays);
  message->set_nonfinite(status.nonfinite);
  message->set_spp_mean(status.spp_mean);
  message->set_rel_error(status.rel_error);
  message->set_flagged(status.flagged);
  for (const double mean : status.mean_rgb) message->add_mean_rgb(mean);
  message->set_samples_per_second(status.samples_per_second);
  message->set_eta_s(status.eta_s);
  message->set_eta_low_s(status.eta_low_s);
  message->set_eta_high_s(status.eta_high_s);
  message->set_samples_left(status.samples_left);
  message->set_target_met(status.target_met);
  message->set_target_share(status.target_share);
  message->set_rounds(status.rounds);
  message->set_submitted_unix_s(status.submitted_unix_s);
  message->set_wall_s(status.wall_s);
  message->set_load_s(status.load_s);
  message->set_render_s(status.render_s);
  message->set_background_pixels(status.background_pixels);
  message->set_workers(status.workers);
  for (const TileError& tile : status.worst_tiles) {
    v1::TileError* out = message->add_worst_tiles();
    ToWire(tile.pixels, out->mutable_pixels());
    out->set_rel_error(tile.rel_error);
  }
  if (status.state == JobState::kDone) message->set_result(DigestBytes(status.result));
}

absl::StatusOr<JobStatus> FromWire(const v1::JobStatus& message) {
  JobStatus status;
  status.id = message.id();
  STRATA_ASSIGN_OR_RETURN(status.spec, FromWire(message.spec()));
  const auto state = std::find_if(std::begin(kStates), std::end(kStates),
                                  [&](const auto& s) { return s.second == message.state(); });
  if (state == std::end(kStates)) {
    return FieldError("state", absl::StrCat("unknown value ", static_cast<int>(message.state())));
  }
  status.state = state->first;
  status.message = message.message();
  status.fraction = message.fraction();
  status.samples = message.samples();
  status.rays = message.rays();
  status.nonfinite = message.nonfinite();
  status.spp_mean = message.spp_mean();
  status.rel_error = message.rel_error();
  status.flagged = message.flagged();
  if (message.mean_rgb_size() != 3) return FieldError("mean_rgb", "must hold three numbers");
  std::copy(message.mean_rgb().begin(), message.mean_rgb().end(), status.mean_rgb);
  status.samples_per_second = message.samples_per_second();
  status.eta_s = message.eta_s();
  status.eta_low_s = message.eta_low_s();
  status.eta_high_s = message.eta_high_s();
  status.samples_left = message.samples_left();
  status.target_met = message.target_met();
  status.target_share = message.target_share();
  status.rounds = message.rounds();
  status.submitted_unix_s = message.submitted_unix_s();
  status.wall_s = message.wall_s();
  status.load_s = message.load_s();
  status.render_s = message.render_s();
  status.background_pixels = message.background_pixels();
  status.workers = message.workers();
  for (const v1::TileError& tile : message.worst_tiles()) {
    status.worst_tiles.push_back({FromWire(tile.pixels()), tile.rel_error()});
  }
  if (!message.result().empty()) {
    STRATA_ASSIGN_OR_RETURN(status.result, ReadDigest(message.result(), "result"));
  }
  return status;
}

void ToWire(const WorkerStatus& status, v1::WorkerStatus* message) {
  message->set_id(status.id);
  message->set_name(status.name);
  message->set_state(status.state);
  for (const std::string& tag : status.tags) message->add_tags(tag);
  message->set_threads(status.threads);
  message->set_leases(status.leases);
  message->set_samples(status.samples);
  message->set_connected_s(status.connected_s);
  message->set_silent_s(status.silent_s);
  message->set_build(status.build);
}

WorkerStatus FromWire(const v1::WorkerStatus& message) {
  WorkerStatus status;
  status.id = message.id();
  status.name = message.name();
  status.state = message.state();
  status.tags.assign(message.tags().begin(), message.tags().end());
  status.threads = message.threads();
  status.leases = message.leases();
  status.samples = message.samples();
  status.connected_s = message.connected_s();
  status.silent_s = message.silent_s();
  status.build = message.build();
  return status;
}

void ToWire(const LogLine& line, v1::LogLine* message) {
  message->set_unix_s(line.unix_s);
  message->set_level(line.level);
  message->set_text(line.text);
}

LogLine FromWire(const v1::LogLine& message) {
  return {message.unix_s(), message.level(), message.text()};
}

void ToWire(const ImageLayers& image, v1::ImageHeader* message) {
  message->set_full_width(image.full_width);
  message->set_full_height(image.full_height);
  ToWire(image.crop, message->mutable_crop());
  for (const std::string& channel : image.channels) message->add_channels(channel);
  for (const auto& [name, value] : image.metadata) {
    v1::ImageMetadata* out = message->add_metadata();
    out->set_name(name);
    out->set_value(value);
  }
}

absl::Status ImageReader::Add(const v1::FetchImageResponse& message) {
  if (message.has_header()) {
    if (has_header_) return FieldError("header", "sent twice");
    const v1::ImageHeader& header = message.header();
    image_.full_width = header.full_width();
    image_.full_height = header.full_height();
    image_.crop = FromWire(header.crop());
    const PixelRect& crop = image_.crop;
    if (crop.x0 < 0 || crop.y0 < 0 || crop.x1 <= crop.x0 || crop.y1 <= crop.y0 || crop.x1 > 65536 ||
        crop.y1 > 65536) {
      return FieldError("header.crop", "must be a rectangle within 65536 x 65536 pixels");
    }
    image_.channels.assign(header.channels().begin(), header.channels().end());
    for (const v1::ImageMetadata& entry : header.metadata()) {
      image_.metadata.emplace_back(entry.name(), entry.value());
    }
    expected_ = static_cast<size_t>(crop.Pixels()) * image_.channels.size();
    has_header_ = true;
    return absl::OkStatus();
  }
  if (!has_header_) return FieldError("header", "must come first");
  const auto& values = message.rows().values();
  if (values.empty()) return FieldError("rows.values", "must not be empty");
  if (static_cast<size_t>(values.size()) > expected_ - image_.values.size()) {
    return FieldError("rows.values", "more values than the header promised");
  }
  // Reserved with the first values that arrive, so that a header alone takes no memory.
  if (image_.values.empty()) image_.values.reserve(expected_);
  image_.values.insert(image_.values.end(), values.begin(), values.end());
  return absl::OkStatus();
}

absl::StatusOr<ImageLayers> ImageReader::Finish() && {
  if (!has_header_ || image_.values.size() != expected_) {
    return absl::DataLossError(absl::StrCat("the image ended after ", image_.values.size(), " of ",
                                            expected_, " values; fetch it again"));
  }
  return std::move(image_);
}

}  // namespace strata::wire
