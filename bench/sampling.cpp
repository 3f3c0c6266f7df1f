// Nanoseconds of the kernel's inner functions: sample points, warps, BSDFs. Google Benchmark's
// options apply, e.g. --benchmark_filter=Get2D.

#include <benchmark/benchmark.h>

#include <string>
#include <utility>
#include <vector>

#include "worker/bsdf/bsdf.h"
#include "worker/math/elementary.h"
#include "worker/sampling/distribution.h"
#include "worker/sampling/filter.h"
#include "worker/sampling/sampler.h"

namespace strata {
namespace {

/// As a path of five bounces asks for them: all pairs of each sample in order.
template <typename Sampler>
void Get2D(benchmark::State& state) {
  constexpr uint32_t kPairs = kPairFirstBounce + 5 * kPairsPerBounce;
  constexpr uint32_t kSamples = 8;
  uint32_t pixel = 0;
  for (auto _ : state) {
    Sampler sampler(SampleKey{.seed = 1, .x = pixel++});
    for (uint32_t sample = 0; sample < kSamples; ++sample) {
      sampler.StartSample(sample);
      for (uint32_t pair = 0; pair < kPairs; ++pair) benchmark::DoNotOptimize(sampler.Get2D(pair));
    }
  }
  state.counters["per_pair"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kPairs * kSamples,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(Get2D<SobolSampler>);
BENCHMARK(Get2D<IndependentSampler>);

void FilterSampling(benchmark::State& state, FilterSpec spec) {
  const FilterSampler filter(spec);
  IndependentSampler sampler(SampleKey{});
  uint32_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(filter.Sample(sampler.Get2D(i++)));
}
BENCHMARK_CAPTURE(FilterSampling, Box, FilterSpec{});
BENCHMARK_CAPTURE(FilterSampling, Gaussian,
                  FilterSpec{.kind = FilterKind::kGaussian, .radius_x = 1.5, .radius_y = 1.5});

void EnvironmentSampling(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0)), height = width / 2;
  std::vector<float> weights(static_cast<size_t>(width) * height);
  for (size_t i = 0; i < weights.size(); ++i) {
    weights[i] = static_cast<float>(MixBits(i) >> 40) * 0x1p-24f;
  }
  const PiecewiseConstant2D distribution(weights, width, height);
  IndependentSampler sampler(SampleKey{});
  uint32_t i = 0;
  for (auto _ : state) {
    float pdf;
    benchmark::DoNotOptimize(distribution.Sample(sampler.Get2D(i++), &pdf));
  }
}
BENCHMARK(EnvironmentSampling)->Arg(512)->Arg(4096);

const CoatInterface& BenchCoatInterface() {
  static const CoatInterface interface(1.5f);
  return interface;
}
const AlbedoTable* BenchTrappedLight() {
  static const AlbedoTable table = TabulateTrappedLight(1.5f);
  return &table;
}

struct Named {
  std::string name;
  Bsdf bsdf;
};
std::vector<Named> Bsdfs() {
  const Rgb color = {0.8f, 0.5f, 0.2f}, eta = {0.25f, 1.04f, 1.16f}, k = {3.3f, 2.6f, 2.4f};
  const Ggx rough = {0.2f, 0.2f};
  const Rgb depth = Rgb::Gray(0.01f);
  const Coat smooth_coat = {&BenchCoatInterface(), {}, depth};
  const Coat rough_coat = {&BenchCoatInterface(), rough, depth};
  return {{"Diffuse", DiffuseBsdf{color}},
          {"Conductor", ConductorBsdf{eta, k, {}}},
          {"RoughConductor", ConductorBsdf{eta, k, rough}},
          {"Dielectric", DielectricBsdf{1.5f, {}}},
          {"RoughDielectric", DielectricBsdf{1.5f, rough}},
          {"ThinDielectric", ThinDielectricBsdf{1.5f}},
          {"CoatedDiffuse", CoatedDiffuseBsdf(smooth_coat, color)},
          {"RoughCoatedDiffuse", CoatedDiffuseBsdf(rough_coat, color)},
          {"CoatedConductor", CoatedConductorBsdf(smooth_coat, BenchTrappedLight(), eta, k, rough)},
          {"DiffuseTransmission", DiffuseTransmissionBsdf{color * 0.5f, color * 0.5f}}};
}

void SampleBsdf(benchmark::State& state, const Bsdf& bsdf) {
  IndependentSampler sampler(SampleKey{});
  const Vec3f wo = {0.48f, 0.36f, 0.8f};
  uint32_t i = 0;
  for (auto _ : state) {
    const float u_lobe = sampler.Get2D(i++).x;
    benchmark::DoNotOptimize(Sample(bsdf, wo, u_lobe, sampler.Get2D(i++)));
  }
}

/// Both, as light sampling does.
void EvalAndPdf(benchmark::State& state, const Bsdf& bsdf) {
  const Vec3f wo = {0.48f, 0.36f, 0.8f};
  Vec3f wi = {-0.36f, -0.48f, 0.8f};
  for (auto _ : state) {
    benchmark::DoNotOptimize(wi);
    benchmark::DoNotOptimize(Eval(bsdf, wo, wi));
    benchmark::DoNotOptimize(Pdf(bsdf, wo, wi));
  }
}

void RegisterBsdfs() {
  for (const auto& [name, bsdf] : Bsdfs()) {
    benchmark::RegisterBenchmark(("Sample/" + name).c_str(), SampleBsdf, bsdf);
    if (IsDelta(bsdf)) continue;
    benchmark::RegisterBenchmark(("EvalAndPdf/" + name).c_str(), EvalAndPdf, bsdf);
  }
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  strata::RegisterBsdfs();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
