#pragma once

#include <cmath>
#include <cstdint>

#include "common/moments.h"
#include "common/unit.h"

namespace strata {

/// A uniform number in [0, 1) from a hash of everything a sample depends on (the finalizer of
/// SplitMix64: Steele, Lea, Flood 2014).
inline double FakeUniform(uint64_t seed, int x, int y, int replicate, uint32_t index, int channel) {
  uint64_t h = seed;
  for (const uint64_t word :
       {static_cast<uint64_t>(x), static_cast<uint64_t>(y), static_cast<uint64_t>(replicate),
        static_cast<uint64_t>(index), static_cast<uint64_t>(channel)}) {
    h += word + 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    h ^= h >> 31;
  }
  return static_cast<double>(h >> 11) * 0x1p-53;
}

/// One sample of a picture without a scene: a smooth gradient with noise, brighter to the right.
inline double FakeSample(const JobSpec& spec, int x, int y, int replicate, uint32_t index,
                         int channel) {
  const double u = FakeUniform(spec.seed + spec.frame, x, y, replicate, index, channel);
  return (0.2 + 0.01 * x + 0.1 * channel) * (0.5 + u);
}

/// Renders a unit as a worker would, from `sample(spec, x, y, replicate, index, channel)`; plain
/// channels follow the estimated ones. A pure function of its arguments.
template <typename Sample>
Partial FakeRender(const JobSpec& spec, const WorkUnit& unit, Sample sample) {
  const PixelLayout layout = LayoutOf(spec);
  Partial partial;
  partial.unit = unit.id;
  partial.pixels = unit.pixels;
  partial.layout = layout;
  const size_t pixels = static_cast<size_t>(unit.pixels.Pixels());
  partial.samples.resize(pixels);
  partial.rays.resize(pixels);
  partial.nonfinite.resize(pixels);
  partial.values.resize(pixels * static_cast<size_t>(layout.Doubles()));
  for (size_t i = 0; i < pixels; ++i) {
    const int width = unit.pixels.Width();
    const int x = unit.pixels.x0 + static_cast<int>(i) % width;
    const int y = unit.pixels.y0 + static_cast<int>(i) / width;
    const SampleRange range = unit.RangeOf(static_cast<int64_t>(i));
    double* values = &partial.values[i * static_cast<size_t>(layout.Doubles())];
    for (int c = 0; c < layout.estimated + layout.plain; ++c) {
      Moments all;
      for (int r = 0; r < kReplicates; ++r) {
        Moments replicate;
        for (uint32_t s = range.begin; s < range.end; ++s) {
          double value = sample(spec, x, y, r, s, c);
          if (!std::isfinite(value)) {
            value = 0;
            partial.nonfinite[i] += c == 0;
          }
          all.Add(value);
          replicate.Add(value);
        }
        if (c < layout.estimated) values[layout.Mean(r, c)] = replicate.mean;
      }
      if (c < layout.estimated) {
        values[layout.M2(c)] = all.m2;
        values[layout.M3(c)] = all.m3;
      } else {
        values[layout.Plain(c - layout.estimated)] = all.mean;
      }
    }
    partial.samples[i] = range.Count();
    partial.rays[i] =
        uint64_t{kReplicates} * range.Count() * (2 + static_cast<unsigned>(x + y) % 3);
  }
  return partial;
}

inline Partial FakeRender(const JobSpec& spec, const WorkUnit& unit) {
  return FakeRender(spec, unit, FakeSample);
}

}  // namespace strata
