// How long the coordinator takes from a merged pilot to the next round, on a synthetic film.

#include <stdlib.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "coordinator/allocation.h"
#include "coordinator/error_target.h"
#include "coordinator/round_plan_format.h"
#include "coordinator/unit_queue.h"

namespace strata {
namespace {

constexpr uint32_t kPilot = 32, kSpp = 128;
constexpr int kTile = 64;

/// Noise over a factor of 30, brighter to the right, with rare bright samples at the bottom.
Partial PilotOf(const TileGrid& grid, uint32_t tile, const PixelLayout& layout) {
  Partial partial;
  partial.unit = {0, tile, 0};
  partial.pixels = grid.Rect(tile);
  partial.layout = layout;
  const size_t pixels = static_cast<size_t>(partial.pixels.Pixels());
  partial.samples.assign(pixels, kPilot / kReplicates);
  partial.rays.assign(pixels, uint64_t{kPilot} * 5);
  partial.nonfinite.resize(pixels);
  partial.values.resize(pixels * static_cast<size_t>(layout.Doubles()));
  std::mt19937 random(tile);
  std::normal_distribution<double> normal;
  for (size_t i = 0; i < pixels; ++i) {
    const size_t width = static_cast<size_t>(partial.pixels.Width());
    const double u = static_cast<double>(partial.pixels.x0 + static_cast<int>(i % width)) /
                     static_cast<double>(grid.crop.Width());
    const double v = static_cast<double>(partial.pixels.y0 + static_cast<int>(i / width)) /
                     static_cast<double>(grid.crop.Height());
    const double deviation = v > 0.9 ? 0.6 : 0.02 + 0.2 * u * v;
    double* values = &partial.values[i * static_cast<size_t>(layout.Doubles())];
    for (int c = 0; c < layout.estimated; ++c) {
      for (int r = 0; r < kReplicates; ++r) {
        values[layout.Mean(r, c)] = 0.1 + u + deviation * normal(random);
      }
      values[layout.M2(c)] = kPilot * deviation * deviation;
    }
  }
  return partial;
}

absl::StatusOr<std::unique_ptr<Film>> MakeFilm(const std::filesystem::path& path,
                                               const TileGrid& grid) {
  const FilmGeometry geometry{FilmLayer::kPath, grid, {kColours, 1}};
  STRATA_ASSIGN_OR_RETURN(std::unique_ptr<Film> film, Film::Create(path, geometry));
  for (uint32_t tile = 0; tile < grid.Count(); ++tile) {
    film->Merge(PilotOf(grid, tile, geometry.layout), {0, 1});
  }
  return film;
}

void Print(const char* name, int repeats, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const auto began = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    seconds.push_back(took.count());
  }
  std::sort(seconds.begin(), seconds.end());
  std::printf("%-34s %.3f (%.3f..%.3f)\n", name, seconds[seconds.size() / 2], seconds.front(),
              seconds.back());
}

int Main(int argc, char** argv) {
  CLI::App app("Seconds from a merged pilot to the next round: medians (least..greatest)");
  int width = 3840, height = 2160, repeats = 5;
  app.add_option("--width", width)->check(CLI::Range(32, 1 << 14));
  app.add_option("--height", height)->check(CLI::Range(32, 1 << 14));
  app.add_option("--repeats", repeats)->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);

  const TileGrid grid{{0, 0, width, height}, kTile};
  std::string folder = (std::filesystem::temp_directory_path() / "strata-planning-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 1;
  const auto film = MakeFilm(std::filesystem::path(folder) / "pilot.film", grid);
  if (!film.ok()) {
    std::filesystem::remove_all(folder);
    std::fprintf(stderr, "%s\n", std::string(film.status().message()).c_str());
    return 1;
  }
  sync();  // The film's pages are written now, and not while the first figure is measured.
  PixelStatistics now;
  std::vector<uint32_t> ends;
  std::shared_ptr<const RoundPlan> plan;
  std::string bytes;
  std::printf("%dx%d pixels, seconds: median of %d (least..greatest)\n", width, height, repeats);
  Print("gather statistics", repeats, [&] { now = GatherPixelStatistics(**film); });
  Print("ring allocation", repeats, [&] { ends = AllocateByRing(now, kSpp); });
  Print("--error 0.05", repeats, [&] { PlanForRelativeError(now, 0.05, 1 << 16); });
  Print("--rmse 0.005", repeats, [&] { PlanForRmse(now, 0.005, 1 << 16); });
  for (size_t i = 0; i < ends.size(); ++i) ends[i] = std::max(ends[i], now.samples[i]);
  Print("cut into pieces", repeats,
        [&] { plan = std::make_shared<const RoundPlan>(PlanCounts(1, grid, now.samples, ends)); });
  Print("encode, with SHA-256", repeats, [&] { bytes = EncodeRoundPlan(*plan); });
  Print("count samples, units; make the queue", repeats, [&] {
    const uint64_t all = plan->Samples() + plan->Units();
    if (all == 0 || UnitQueue(plan, 4).Pending() == 0) std::printf("nothing to do\n");
  });
  std::filesystem::remove_all(folder);
  std::printf("the plan: %zu classes, %.1f MB\n", plan->classes.size(),
              static_cast<double>(bytes.size()) / 1e6);
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Main(argc, argv); }
