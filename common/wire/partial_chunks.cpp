#include "common/wire/partial_chunks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/wire/field.h"
#include "common/wire/job.h"

namespace strata::wire {
namespace {

/// Layer 0 of worker.proto: paths, summed by tiles.
constexpr uint32_t kPathLayer = 0;
constexpr uint32_t kMaxEstimated = 16, kMaxPlain = 64;
/// What a chunk holds beside its pixels: header, replay commands, field tags.
constexpr size_t kHeaderBytes = kMaxReplays * (kMaxCommandBytes + 8) + 1024;

size_t Doubles(const PixelLayout& layout) { return static_cast<size_t>(layout.Doubles()); }

template <class Source, class Field>
void CopyRange(const Source& source, size_t begin, size_t count, Field* field) {
  field->Add(source.begin() + static_cast<ptrdiff_t>(begin),
             source.begin() + static_cast<ptrdiff_t>(begin + count));
}

/// One number for all pixels, or one for each.
absl::Status AppendPerPixel(const google::protobuf::RepeatedField<uint32_t>& field, size_t pixels,
                            std::string_view name, std::vector<uint32_t>* values) {
  const auto size = static_cast<size_t>(field.size());
  if (size == 1) {
    values->insert(values->end(), pixels, field[0]);
  } else if (size == pixels) {
    values->insert(values->end(), field.begin(), field.end());
  } else {
    return FieldError(name, absl::StrCat("has ", size, " numbers for ", pixels, " pixels"));
  }
  return absl::OkStatus();
}

absl::StatusOr<PixelLayout> LayoutFromWire(const v1::PixelLayout& message) {
  if (message.estimated() < 1 || message.estimated() > kMaxEstimated) {
    return FieldError("partial.header.layout.estimated", "must be 1 to 16");
  }
  if (message.plain() > kMaxPlain) {
    return FieldError("partial.header.layout.plain", "must be 0 to 64");
  }
  return PixelLayout{static_cast<int>(message.estimated()), static_cast<int>(message.plain())};
}

}  // namespace

PartialChunker::PartialChunker(UnitResult result)
    : result_(std::move(result)), pixels_(static_cast<size_t>(result_.partial.pixels.Pixels())) {
  // Varints: at most 5 bytes of samples, 10 of rays, 5 of non-finite samples.
  const size_t pixel_bytes = Doubles(result_.partial.layout) * sizeof(double) + 20;
  pixels_in_chunk_ = (kPartialChunkBytes - kHeaderBytes) / pixel_bytes;
}

void PartialChunker::Next(v1::PartialChunk* chunk) {
  const Partial& partial = result_.partial;
  chunk->Clear();
  if (next_pixel_ == 0) {
    v1::PartialHeader* header = chunk->mutable_header();
    header->set_job(result_.job);
    header->set_lease(result_.lease);
    header->mutable_unit()->set_round(partial.unit.round);
    header->mutable_unit()->set_tile(partial.unit.tile);
    header->mutable_unit()->set_piece(partial.unit.piece);
    header->set_layer(kPathLayer);
    ToWire(partial.pixels, header->mutable_pixels());
    header->mutable_layout()->set_estimated(static_cast<uint32_t>(partial.layout.estimated));
    header->mutable_layout()->set_plain(static_cast<uint32_t>(partial.layout.plain));
    header->set_replicates(kReplicates);
    header->set_render_seconds(partial.render_seconds);
    header->set_load_seconds(result_.load_seconds);
    header->set_background_pixels(result_.background_pixels);
    for (size_t i = 0; i < std::min(partial.replays.size(), kMaxReplays); ++i) {
      if (partial.replays[i].size() <= kMaxCommandBytes) header->add_replays(partial.replays[i]);
    }
  }
  const size_t begin = next_pixel_;
  const size_t count = std::min(pixels_in_chunk_, pixels_ - begin);
  next_pixel_ += count;
  chunk->set_first_pixel(static_cast<uint32_t>(begin));
  chunk->set_pixel_count(static_cast<uint32_t>(count));
  const auto samples = partial.samples.begin() + static_cast<ptrdiff_t>(begin);
  const bool uniform = std::all_of(samples, samples + static_cast<ptrdiff_t>(count),
                                   [first = *samples](uint32_t n) { return n == first; });
  CopyRange(partial.samples, begin, uniform ? 1 : count, chunk->mutable_samples());
  const size_t doubles = Doubles(partial.layout);
  CopyRange(partial.values, begin * doubles, count * doubles, chunk->mutable_values());
  CopyRange(partial.rays, begin, count, chunk->mutable_rays());
  const auto bad = partial.nonfinite.begin() + static_cast<ptrdiff_t>(begin);
  if (std::any_of(bad, bad + static_cast<ptrdiff_t>(count), [](uint32_t n) { return n > 0; })) {
    CopyRange(partial.nonfinite, begin, count, chunk->mutable_nonfinite());
  }
}

absl::Status PartialAssembler::Begin(const v1::PartialHeader& header) {
  STRATA_RETURN_IF_ERROR(CheckJobId(header.job(), "partial.header.job"));
  if (header.layer() != kPathLayer) {
    return FieldError("partial.header.layer",
                      absl::StrCat("layer ", header.layer(), " is unknown, 0 is the only one"));
  }
  if (header.replicates() != kReplicates) {
    return FieldError("partial.header.replicates",
                      absl::StrCat("must be ", kReplicates, ", not ", header.replicates()));
  }
  const PixelRect rect = FromWire(header.pixels());
  if (rect.x0 < 0 || rect.y0 < 0 || rect.x1 > 65536 || rect.y1 > 65536 || rect.x1 <= rect.x0 ||
      rect.y1 <= rect.y0 || rect.Width() > kMaxTile || rect.Height() > kMaxTile) {
    return FieldError("partial.header.pixels",
                      "must be a rectangle of 1 to 1024 x 1024 pixels in the frame");
  }
  STRATA_ASSIGN_OR_RETURN(const PixelLayout layout, LayoutFromWire(header.layout()));
  const uint64_t bytes = static_cast<uint64_t>(rect.Pixels()) * (Doubles(layout) * 8 + 16);
  if (bytes > kMaxPartialBytes) {
    return FieldError("partial.header.pixels",
                      absl::StrCat("makes a partial of ", bytes, " bytes, at most ",
                                   kMaxPartialBytes, " are allowed; use smaller tiles"));
  }
  if (static_cast<size_t>(header.replays_size()) > kMaxReplays) {
    return FieldError("partial.header.replays", "at most 16 commands are allowed");
  }
  for (const std::string& replay : header.replays()) {
    STRATA_RETURN_IF_ERROR(CheckText(replay, kMaxCommandBytes, true, "partial.header.replays"));
  }
  for (const double seconds : {header.render_seconds(), header.load_seconds()}) {
    if (!(seconds >= 0) || !std::isfinite(seconds)) {
      return FieldError("partial.header.render_seconds", "must be finite and not negative");
    }
  }
  if (header.background_pixels() < 0) {
    return FieldError("partial.header.background_pixels", "must not be negative");
  }
  const v1::UnitId& unit = header.unit();
  result_ = UnitResult{
      header.job(), header.lease(), {}, header.load_seconds(), header.background_pixels()};
  result_.partial.unit = {unit.round(), unit.tile(), unit.piece()};
  result_.partial.pixels = rect;
  result_.partial.layout = layout;
  result_.partial.replays.assign(header.replays().begin(), header.replays().end());
  result_.partial.render_seconds = header.render_seconds();
  pixels_ = static_cast<size_t>(rect.Pixels());
  open_ = true;
  return absl::OkStatus();
}

absl::StatusOr<std::optional<UnitResult>> PartialAssembler::Add(const v1::PartialChunk& chunk) {
  if (chunk.has_header() == open_) {
    return FieldError("partial.header", open_ ? "a partial is still open" : "no partial is open");
  }
  if (!open_) STRATA_RETURN_IF_ERROR(Begin(chunk.header()));
  Partial& partial = result_.partial;
  const size_t have = partial.rays.size();
  const size_t count = chunk.pixel_count();
  if (chunk.first_pixel() != have) {
    return FieldError("partial.first_pixel",
                      absl::StrCat("must be ", have, ", not ", chunk.first_pixel()));
  }
  if (count == 0 || count > pixels_ - have) {
    return FieldError("partial.pixel_count", absl::StrCat("must be 1 to ", pixels_ - have));
  }
  const size_t doubles = Doubles(partial.layout);
  if (static_cast<size_t>(chunk.values_size()) != count * doubles) {
    return FieldError("partial.values", absl::StrCat("must hold ", count * doubles,
                                                     " numbers, not ", chunk.values_size()));
  }
  if (static_cast<size_t>(chunk.rays_size()) != count) {
    return FieldError("partial.rays", absl::StrCat("must hold ", count, " numbers"));
  }
  if (!std::all_of(chunk.values().begin(), chunk.values().end(),
                   [](double x) { return std::isfinite(x); })) {
    return FieldError("partial.values", "must be finite");
  }
  STRATA_RETURN_IF_ERROR(
      AppendPerPixel(chunk.samples(), count, "partial.samples", &partial.samples));
  if (chunk.nonfinite().empty()) {
    partial.nonfinite.resize(have + count, 0);
  } else {
    STRATA_RETURN_IF_ERROR(
        AppendPerPixel(chunk.nonfinite(), count, "partial.nonfinite", &partial.nonfinite));
  }
  partial.values.insert(partial.values.end(), chunk.values().begin(), chunk.values().end());
  partial.rays.insert(partial.rays.end(), chunk.rays().begin(), chunk.rays().end());
  if (have + count < pixels_) return std::nullopt;
  open_ = false;
  return std::exchange(result_, {});
}

}  // namespace strata::wire
