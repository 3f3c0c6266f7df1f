#include "tests/wire/samples.h"

namespace strata {

JobSpec SampleSpec() {
  JobSpec spec;
  spec.name = "lobby";
  spec.priority = -7;
  spec.bundle.scene = "scene.pbrt";
  spec.bundle.files = {{"scene.pbrt", DigestOf("scene"), 1234},
                       {"textures/wood.png", DigestOf("wood"), uint64_t{5} << 32}};
  spec.bundle.options = {"textures/wood.png", "1,2,3,0,0,0,45", LightSelection::kIntensity};
  spec.width = 640;
  spec.height = 480;
  spec.crop = {16, 32, 200, 100};
  spec.max_depth = 12;
  spec.sampler = SamplerKind::kIndependent;
  spec.kernel = KernelKind::kReference;
  spec.strategy = DirectStrategy::kCosine;
  spec.mis_beta = 1.5;
  spec.routines = SamplingRoutines::kRejection;
  spec.roulette = RouletteKind::kEfficiency;
  spec.filter = {FilterKind::kMitchell, 2.5, 1.5, 0.75, 0.25, 0.4};
  spec.spp = 128;
  spec.allocation = AllocationKind::kRing;
  spec.target = TargetKind::kRelativeError;
  spec.target_value = 0.02;
  spec.tile = 64;
  spec.seed = 0xfedcba9876543210;
  spec.frame = 7;
  spec.channels = {true, true, true, true};
  return spec;
}

JobStatus SampleStatus() {
  JobStatus status;
  status.id = "j-12";
  status.spec = SampleSpec();
  status.state = JobState::kDone;
  status.message = "all is well";
  status.fraction = 0.5;
  status.samples = 1 << 20;
  status.rays = uint64_t{1} << 40;
  status.nonfinite = 3;
  status.spp_mean = 12.5;
  status.rel_error = 0.02;
  status.flagged = 0.01;
  status.mean_rgb[0] = 0.1;
  status.mean_rgb[1] = 0.2;
  status.mean_rgb[2] = 0.3;
  status.samples_per_second = 1e6;
  status.eta_s = 42;
  status.eta_low_s = 40;
  status.eta_high_s = 50;
  status.samples_left = 1e7;
  status.target_met = true;
  status.target_share = 0.99;
  status.rounds = 3;
  status.submitted_unix_s = 1.7e9;
  status.wall_s = 10;
  status.load_s = 1;
  status.render_s = 9;
  status.background_pixels = 123;
  status.workers = 4;
  status.worst_tiles = {{{16, 32, 48, 64}, 0.7}, {{48, 32, 80, 64}, 0.5}};
  status.result = DigestOf("film");
  return status;
}

WorkerStatus SampleWorker() {
  return {"w-3", "attic", "busy", {"big", "fast"}, 16, 2, 1 << 30, 100.5, 0.5, "0.1.0+abc"};
}

UnitResult SampleResult(int width, int height, bool varied) {
  UnitResult result{"j-1", 77, {}, 0.25};
  Partial& partial = result.partial;
  partial.unit = {1, 2, 3};
  partial.pixels = {32, 64, 32 + width, 64 + height};
  partial.layout = {3, 8};
  const auto pixels = static_cast<size_t>(partial.pixels.Pixels());
  for (size_t i = 0; i < pixels; ++i) {
    partial.samples.push_back(varied ? 1 + static_cast<uint32_t>(i % 7) : 4);
    partial.rays.push_back(varied ? i << 20 : i + 1);
    partial.nonfinite.push_back(varied && i % 11 == 0 ? 2 : 0);
  }
  const size_t doubles = pixels * static_cast<size_t>(partial.layout.Doubles());
  for (size_t i = 0; i < doubles; ++i) {
    partial.values.push_back(static_cast<double>(i) / 3 - 5e-324 * static_cast<double>(i % 2));
  }
  partial.replays = {"strata replay scene.pbrt --pixel 1,2", "strata replay b"};
  partial.render_seconds = 0.125;
  result.background_pixels = 77;
  return result;
}

std::vector<FromWorker> SampleFromWorker() {
  Hello hello;
  hello.build = "0.1.0+abc";
  hello.kernel_revision = 9;
  hello.libraries = {{"embree", "3.13.5"}, {"glibc", "2.36"}};
  hello.isa = "avx2";
  hello.traced = DigestOf("traced");
  hello.name = "attic";
  hello.tags = {"big", "fast"};
  hello.threads = 16;
  hello.memory_limit = uint64_t{64} << 30;
  return {hello,
          Heartbeat{},
          FileRequest{DigestOf("wood"), 3 << 20},
          SampleResult(3, 2, true),
          UnitFailure{"j-1", 77, {1, 2, 3}, "the unit is empty", "strata replay a", true},
          Draining{}};
}

std::vector<ToWorker> SampleToWorker() {
  WorkUnit uniform{{1, 2, 3}, {32, 64, 64, 96}, {{8, 16}}};
  WorkUnit varied{{1, 3, 1}, {0, 64, 2, 65}, {{8, 16}, {16, 16}}};
  return {Welcome{"w-3", 2000, 10000},
          Refusal{"another build", true},
          JobDescription{"j-1", SampleSpec()},
          Lease{"j-1", 77, {uniform, varied}},
          CancelJob{"j-1"},
          CancelLease{77},
          FileChunk{DigestOf("wood"), 3, 10, "seven !", "no such file"},
          Drain{}};
}

}  // namespace strata
