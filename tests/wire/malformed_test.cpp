#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "common/net_address.h"
#include "common/wire/channel.h"
#include "common/wire/field.h"
#include "common/wire/job.h"
#include "common/wire/report.h"
#include "common/wire/worker_messages.h"
#include "tests/wire/samples.h"

namespace strata {
namespace {

/// A change that breaks a good message, and what the error must name.
template <class Message>
struct Fault {
  std::string names;
  std::function<void(Message&)> apply;
};

template <class Result>
void ExpectNamed(const absl::StatusOr<Result>& result, const std::string& names) {
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument) << names;
  EXPECT_NE(result.status().message().find(names), std::string::npos)
      << "\"" << result.status().message() << "\" does not name " << names;
}

TEST(Malformed, JobSpecs) {
  const Fault<v1::JobSpec> faults[] = {
      {"spec.name", [](auto& m) { m.set_name(std::string(1025, 'x')); }},
      {"spec.bundle.files[1].digest",
       [](auto& m) { m.mutable_bundle()->mutable_files(1)->set_digest("short"); }},
      {"spec.sampler", [](auto& m) { m.clear_sampler(); }},
      {"spec.sampler", [](auto& m) { m.set_sampler(static_cast<v1::SamplerKind>(99)); }},
      {"spec.strategy", [](auto& m) { m.set_strategy(static_cast<v1::DirectStrategy>(99)); }},
      {"spec.roulette", [](auto& m) { m.set_roulette(static_cast<v1::RouletteKind>(99)); }},
      {"spec.kernel", [](auto& m) { m.clear_kernel(); }},
      {"spec.kernel", [](auto& m) { m.set_kernel(static_cast<v1::KernelKind>(99)); }},
      {"spec.filter.kind", [](auto& m) { m.clear_filter(); }},
      {"spec.filter.kind",
       [](auto& m) { m.mutable_filter()->set_kind(static_cast<v1::FilterKind>(-1)); }},
  };
  for (const auto& fault : faults) {
    v1::JobSpec message;
    wire::ToWire(SampleSpec(), &message);
    ASSERT_TRUE(wire::FromWire(message).ok());
    fault.apply(message);
    ExpectNamed(wire::FromWire(message), fault.names);
  }
}

TEST(Malformed, JobStatuses) {
  const Fault<v1::JobStatus> faults[] = {
      {"state", [](auto& m) { m.clear_state(); }},
      {"mean_rgb", [](auto& m) { m.add_mean_rgb(1); }},
      {"result", [](auto& m) { m.set_result("short"); }},
      {"spec.sampler", [](auto& m) { m.clear_spec(); }},
  };
  for (const auto& fault : faults) {
    v1::JobStatus message;
    wire::ToWire(SampleStatus(), &message, true);
    fault.apply(message);
    ExpectNamed(wire::FromWire(message), fault.names);
  }
}

/// The wire message of the alternative T of a worker's messages.
template <class T>
v1::WorkerMessage WorkerSample() {
  v1::WorkerMessage message;
  for (const FromWorker& sample : SampleFromWorker()) {
    if (std::holds_alternative<T>(sample)) wire::WorkerMessageWriter(sample).Next(&message);
  }
  return message;
}

template <class T>
void ExpectRefused(const std::vector<Fault<v1::WorkerMessage>>& faults) {
  for (const auto& fault : faults) {
    v1::WorkerMessage message = WorkerSample<T>();
    ASSERT_TRUE(wire::WorkerMessageReader().Add(message).ok());
    fault.apply(message);
    ExpectNamed(wire::WorkerMessageReader().Add(message), fault.names);
  }
}

TEST(Malformed, Hellos) {
  ExpectRefused<Hello>({
      {"hello.build", [](auto& m) { m.mutable_hello()->clear_build(); }},
      {"hello.isa", [](auto& m) { m.mutable_hello()->set_isa(std::string(65, 'x')); }},
      {"hello.traced", [](auto& m) { m.mutable_hello()->set_traced("short"); }},
      {"hello.threads", [](auto& m) { m.mutable_hello()->set_threads(0); }},
      {"hello.threads", [](auto& m) { m.mutable_hello()->set_threads(4097); }},
      {"hello.name", [](auto& m) { m.mutable_hello()->set_name(std::string(257, 'x')); }},
      {"hello.tags", [](auto& m) { m.mutable_hello()->add_tags(""); }},
      {"hello.tags",
       [](auto& m) {
         for (int i = 0; i < 64; ++i) m.mutable_hello()->add_tags("t");
       }},
      {"hello.libraries",
       [](auto& m) { (*m.mutable_hello()->mutable_libraries())["x"] = std::string(257, 'x'); }},
  });
}

TEST(Malformed, HelloOfAnotherProtocolIsReadForItsNumberAlone) {
  v1::WorkerMessage message;
  message.mutable_hello()->set_protocol(2);
  const auto hello = wire::WorkerMessageReader().Add(message);
  ASSERT_TRUE(hello.ok());
  EXPECT_EQ(std::get<Hello>(**hello).protocol, 2u);
}

TEST(Malformed, FailuresRequestsAndUnknownMessages) {
  ExpectRefused<UnitFailure>({
      {"failure.job", [](auto& m) { m.mutable_failure()->set_job("a b"); }},
      {"failure.reason", [](auto& m) { m.mutable_failure()->clear_reason(); }},
      {"failure.replay", [](auto& m) { m.mutable_failure()->set_replay(std::string(4097, 'x')); }},
  });
  ExpectRefused<FileRequest>({
      {"file_request.digest", [](auto& m) { m.mutable_file_request()->clear_digest(); }},
  });
  ExpectNamed(wire::WorkerMessageReader().Add(v1::WorkerMessage()), "message");
  ExpectNamed(wire::FromWire(v1::CoordinatorMessage()), "message");
}

TEST(Malformed, Partials) {
  const auto header = [](v1::WorkerMessage& m) { return m.mutable_partial()->mutable_header(); };
  const double infinity = std::numeric_limits<double>::infinity();
  ExpectRefused<UnitResult>({
      {"partial.header", [](auto& m) { m.mutable_partial()->clear_header(); }},
      {"partial.header.job", [&](auto& m) { header(m)->clear_job(); }},
      {"partial.header.layer", [&](auto& m) { header(m)->set_layer(1); }},
      {"partial.header.replicates", [&](auto& m) { header(m)->set_replicates(16); }},
      {"partial.header.pixels", [&](auto& m) { header(m)->clear_pixels(); }},
      {"partial.header.pixels", [&](auto& m) { header(m)->mutable_pixels()->set_x0(-1); }},
      {"partial.header.pixels", [&](auto& m) { header(m)->mutable_pixels()->set_x1(1 << 30); }},
      {"partial.header.pixels",
       [&](auto& m) {
         // 1024 x 1024 pixels of the widest layout: 1.8 GB.
         header(m)->mutable_pixels()->set_x1(header(m)->pixels().x0() + 1024);
         header(m)->mutable_pixels()->set_y1(header(m)->pixels().y0() + 1024);
         header(m)->mutable_layout()->set_estimated(16);
         header(m)->mutable_layout()->set_plain(64);
       }},
      {"partial.header.layout.estimated",
       [&](auto& m) { header(m)->mutable_layout()->set_estimated(0); }},
      {"partial.header.layout.estimated",
       [&](auto& m) { header(m)->mutable_layout()->set_estimated(~0u); }},
      {"partial.header.layout.plain",
       [&](auto& m) { header(m)->mutable_layout()->set_plain(~0u); }},
      {"partial.header.replays",
       [&](auto& m) {
         for (int i = 0; i < 16; ++i) header(m)->add_replays("x");
       }},
      {"partial.header.render_seconds", [&](auto& m) { header(m)->set_render_seconds(-1); }},
      {"partial.header.render_seconds", [&](auto& m) { header(m)->set_load_seconds(infinity); }},
      {"partial.header.background_pixels", [&](auto& m) { header(m)->set_background_pixels(-1); }},
      {"partial.first_pixel", [](auto& m) { m.mutable_partial()->set_first_pixel(1); }},
      {"partial.pixel_count", [](auto& m) { m.mutable_partial()->set_pixel_count(0); }},
      {"partial.pixel_count", [](auto& m) { m.mutable_partial()->set_pixel_count(7); }},
      {"partial.samples", [](auto& m) { m.mutable_partial()->clear_samples(); }},
      {"partial.samples", [](auto& m) { m.mutable_partial()->add_samples(1); }},
      {"partial.values", [](auto& m) { m.mutable_partial()->add_values(1); }},
      {"partial.values", [&](auto& m) { m.mutable_partial()->set_values(5, infinity); }},
      {"partial.rays", [](auto& m) { m.mutable_partial()->clear_rays(); }},
      {"partial.nonfinite", [](auto& m) { m.mutable_partial()->add_nonfinite(1); }},
  });
}

TEST(Malformed, ChunksOutOfTheirOrder) {
  wire::PartialChunker chunker(SampleResult(200, 200, true));
  v1::PartialChunk first, second, third;
  chunker.Next(&first);
  chunker.Next(&second);
  chunker.Next(&third);
  wire::PartialAssembler assembler;
  ExpectNamed(wire::PartialAssembler().Add(second), "partial.header");
  ASSERT_TRUE(assembler.Add(first).ok());
  ExpectNamed(wire::PartialAssembler(assembler).Add(first), "partial.header");
  ExpectNamed(wire::PartialAssembler(assembler).Add(third), "partial.first_pixel");
  EXPECT_TRUE(wire::PartialAssembler(assembler).Add(second).ok());
}

TEST(Malformed, MessagesOfACoordinator) {
  const auto unit = [](v1::CoordinatorMessage& m) { return m.mutable_lease()->mutable_units(0); };
  const std::pair<size_t, Fault<v1::CoordinatorMessage>> faults[] = {
      {2, {"job.job", [](auto& m) { m.mutable_job()->clear_job(); }}},
      {2, {"spec.sampler", [](auto& m) { m.mutable_job()->clear_spec(); }}},
      {2, {"spp", [](auto& m) { m.mutable_job()->mutable_spec()->set_spp(7); }}},
      {3, {"lease.job", [](auto& m) { m.mutable_lease()->clear_job(); }}},
      {3, {"lease.units", [](auto& m) { m.mutable_lease()->clear_units(); }}},
      {3, {"lease.units.pixels", [&](auto& m) { unit(m)->clear_pixels(); }}},
      {3, {"lease.units.range_begin", [&](auto& m) { unit(m)->add_range_begin(1); }}},
      {3, {"lease.units.range_begin", [&](auto& m) { unit(m)->clear_range_end(); }}},
      {3, {"lease.units.range_end", [&](auto& m) { unit(m)->set_range_end(0, 0); }}},
      {6, {"file_chunk.digest", [](auto& m) { m.mutable_file_chunk()->clear_digest(); }}},
      {6, {"file_chunk.offset", [](auto& m) { m.mutable_file_chunk()->set_offset(~0ull); }}},
      {6,
       {"file_chunk.data",
        [](auto& m) { m.mutable_file_chunk()->set_data(std::string((1 << 20) + 1, 'x')); }}},
  };
  for (const auto& [sample, fault] : faults) {
    v1::CoordinatorMessage message;
    wire::ToWire(SampleToWorker()[sample], &message);
    fault.apply(message);
    ExpectNamed(wire::FromWire(message), fault.names);
  }
}

TEST(Malformed, Images) {
  v1::FetchImageResponse rows, header;
  rows.mutable_rows()->add_values(1);
  EXPECT_EQ(wire::ImageReader().Add(rows).message(), "header: must come first");
  header.mutable_header();
  EXPECT_EQ(wire::ImageReader().Add(header).code(), absl::StatusCode::kInvalidArgument);
}

TEST(Addresses, AreTakenApart) {
  EXPECT_EQ(ParseNetAddress("127.0.0.1:80")->host, "127.0.0.1");
  EXPECT_EQ(ParseNetAddress("[::1]:80")->host, "::1");
  EXPECT_EQ(ParseNetAddress("farm.example:65535")->port, 65535);
  for (const char* text : {"", "a", "a:", ":80", "a:b", "a:65536", "a:-1", "a:8 0", "::1:80"}) {
    EXPECT_FALSE(ParseNetAddress(text).ok()) << text;
  }
  for (const char* host : {"localhost", "127.0.0.1", "127.8.9.1", "::1"}) {
    EXPECT_TRUE(IsLoopback(host)) << host;
  }
  for (const char* host : {"0.0.0.0", "127.evil.example", "::", "10.0.0.1", "localhost.evil"}) {
    EXPECT_FALSE(IsLoopback(host)) << host;
  }
  EXPECT_EQ(wire::Dial("10.0.0.1:80", false).status().code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(wire::Dial("10.0.0.1:80", true).ok());
}

/// One to eight random edits of `bytes`: flips, overwrites, insertions, deletions, repetitions.
std::string Mutate(std::string bytes, std::mt19937& random) {
  const auto below = [&](size_t n) { return static_cast<size_t>(random()) % n; };
  for (size_t edits = 1 + below(8); edits > 0 && !bytes.empty(); --edits) {
    const size_t at = below(bytes.size());
    switch (below(5)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random());
        break;
      case 2:
        bytes.insert(at, 1, static_cast<char>(random()));
        break;
      case 3:
        bytes.erase(at, 1 + below(4));
        break;
      case 4:
        bytes.insert(at, bytes.substr(below(bytes.size()), below(32)));
        break;
    }
  }
  return bytes;
}

// Whatever the bytes, reading ends with a value that can be sent on or an error that says why.
TEST(Fuzz, MutatedMessagesOfWorkers) {
  std::mt19937 random(1);
  int accepted = 0, refused = 0;
  for (const FromWorker& sample : SampleFromWorker()) {
    v1::WorkerMessage message;
    wire::WorkerMessageWriter(sample).Next(&message);
    const std::string bytes = message.SerializeAsString();
    for (int i = 0; i < 4000; ++i) {
      v1::WorkerMessage mutated;
      if (!mutated.ParseFromString(Mutate(bytes, random))) continue;
      const auto read = wire::WorkerMessageReader().Add(mutated);
      if (!read.ok()) {
        EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument);
        EXPECT_FALSE(read.status().message().empty());
        ++refused;
      } else if (read->has_value()) {
        wire::WorkerMessageWriter(**read).Next(&message);
        ++accepted;
      }
    }
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(Fuzz, MutatedMessagesOfCoordinators) {
  std::mt19937 random(2);
  int accepted = 0, refused = 0;
  for (const ToWorker& sample : SampleToWorker()) {
    v1::CoordinatorMessage message;
    wire::ToWire(sample, &message);
    const std::string bytes = message.SerializeAsString();
    for (int i = 0; i < 4000; ++i) {
      v1::CoordinatorMessage mutated;
      if (!mutated.ParseFromString(Mutate(bytes, random))) continue;
      const absl::StatusOr<ToWorker> read = wire::FromWire(mutated);
      if (read.ok()) wire::ToWire(*read, &message);
      ++(read.ok() ? accepted : refused);
    }
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(Fuzz, MutatedStatuses) {
  std::mt19937 random(3);
  v1::JobStatus message;
  wire::ToWire(SampleStatus(), &message, true);
  const std::string bytes = message.SerializeAsString();
  int accepted = 0, refused = 0;
  for (int i = 0; i < 8000; ++i) {
    v1::JobStatus mutated;
    if (!mutated.ParseFromString(Mutate(bytes, random))) continue;
    const absl::StatusOr<JobStatus> read = wire::FromWire(mutated);
    if (read.ok()) wire::ToWire(*read, &message, true);
    ++(read.ok() ? accepted : refused);
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace strata
