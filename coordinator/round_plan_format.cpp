#include "coordinator/round_plan_format.h"

#include <fmt/format.h>

#include <bit>
#include <concepts>
#include <cstring>

#include "common/digest.h"

namespace strata {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::string_view kMagic = "STRATARP";
constexpr uint32_t kVersion = 1;
constexpr size_t kChecksumBytes = 32;

template <std::integral T>
void Put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string ChecksumOf(std::string_view bytes) {
  const Digest digest = DigestOf(bytes);
  return std::string(digest.bytes.begin(), digest.bytes.end());
}

/// Takes integers off the front of a string; beyond its end they are zero and `ok` is false.
struct Reader {
  std::string_view rest;
  bool ok = true;

  template <std::integral T>
  T Get() {
    T value{};
    if (rest.size() < sizeof(T)) {
      ok = false;
      return value;
    }
    std::memcpy(&value, rest.data(), sizeof(T));
    rest.remove_prefix(sizeof(T));
    return value;
  }
  /// A count of entries that take at least `bytes` each; zero when they cannot all be there.
  size_t GetCount(size_t bytes) {
    const uint64_t count = Get<uint64_t>();
    if (count > rest.size() / bytes) ok = false;
    return ok ? static_cast<size_t>(count) : 0;
  }
  SampleRange GetRange() {
    const uint32_t begin = Get<uint32_t>();
    return {begin, Get<uint32_t>()};
  }
};

RoundPlan ReadBody(Reader& reader) {
  RoundPlan plan;
  plan.round = reader.Get<uint32_t>();
  PixelRect& crop = plan.grid.crop;
  for (int* edge : {&crop.x0, &crop.y0, &crop.x1, &crop.y1, &plan.grid.tile}) {
    *edge = reader.Get<int32_t>();
  }
  plan.classes.resize(reader.GetCount(2 * sizeof(uint32_t)));
  for (SampleClass& sample_class : plan.classes) {
    sample_class.range = reader.GetRange();
    sample_class.pieces.resize(reader.GetCount(2 * sizeof(uint32_t)));
    for (SampleRange& piece : sample_class.pieces) piece = reader.GetRange();
  }
  plan.class_of.resize(reader.GetCount(sizeof(uint32_t)));
  for (uint32_t& c : plan.class_of) c = reader.Get<uint32_t>();
  return plan;
}

}  // namespace

std::string EncodeRoundPlan(const RoundPlan& plan) {
  std::string out(kMagic);
  Put(out, kVersion);
  Put(out, plan.round);
  const PixelRect& crop = plan.grid.crop;
  for (const int32_t edge : {crop.x0, crop.y0, crop.x1, crop.y1, plan.grid.tile}) Put(out, edge);
  const auto put_range = [&](SampleRange range) {
    Put(out, range.begin);
    Put(out, range.end);
  };
  Put(out, uint64_t{plan.classes.size()});
  for (const SampleClass& sample_class : plan.classes) {
    put_range(sample_class.range);
    Put(out, uint64_t{sample_class.pieces.size()});
    for (const SampleRange& piece : sample_class.pieces) put_range(piece);
  }
  Put(out, uint64_t{plan.class_of.size()});
  for (const uint32_t c : plan.class_of) Put(out, c);
  return out + ChecksumOf(out);
}

absl::StatusOr<RoundPlan> DecodeRoundPlan(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return absl::DataLossError("round plan: these are other bytes");
  if (bytes.size() < kMagic.size() + sizeof(kVersion) + kChecksumBytes) {
    return absl::DataLossError("round plan: it ends too soon");
  }
  const std::string_view body = bytes.substr(0, bytes.size() - kChecksumBytes);
  if (bytes.substr(body.size()) != ChecksumOf(body)) {
    return absl::DataLossError("round plan: its checksum is wrong");
  }
  Reader reader{body.substr(kMagic.size())};
  if (const uint32_t version = reader.Get<uint32_t>(); version != kVersion) {
    return absl::DataLossError(
        fmt::format("round plan: version {} is not {}, the one known here", version, kVersion));
  }
  RoundPlan plan = ReadBody(reader);
  if (!reader.ok || !reader.rest.empty()) {
    return absl::DataLossError("round plan: its counts do not fit its length");
  }
  if (const absl::Status status = CheckRoundPlan(plan); !status.ok()) {
    return absl::DataLossError(status.message());
  }
  return plan;
}

}  // namespace strata
