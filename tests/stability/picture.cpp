#include "tests/stability/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "coordinator/next_round.h"
#include "coordinator/ordered_merge.h"
#include "coordinator/partial_check.h"
#include "worker/scene/scene.h"

namespace strata {
namespace {

/// Two-sided p = 1e-5.
constexpr double kCritical = 4.417;

JobSpec SpecOf(const RenderOptions& options) {
  JobSpec spec;
  spec.bundle.scene = "scene.pbrt";
  spec.bundle.files = {{"scene.pbrt", DigestOf("scene"), 5}};
  spec.width = spec.height = options.size;
  spec.crop = {0, 0, options.size, options.size};
  spec.spp = options.spp;
  spec.max_depth = options.max_depth;
  spec.seed = options.seed;
  spec.channels.depth = true;
  spec.strategy = options.direct;
  return spec;
}

bool Agrees(const FrameMean& estimate, double truth, double rounding) {
  return std::abs(estimate.mean - truth) <=
         kCritical * estimate.standard_error + rounding * std::abs(truth);
}

}  // namespace

std::shared_ptr<const Scene> LoadFolder(const SceneFolder& folder) {
  auto scene = LoadScene(DirectorySource(folder.root()), "scene.pbrt");
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *scene : nullptr;
}

Picture Render(std::shared_ptr<const Scene> scene, const RenderOptions& options) {
  Picture picture;
  if (!scene) return picture;
  const JobSpec spec = SpecOf(options);
  const auto renderer = Renderer::Create(std::move(scene), spec);
  EXPECT_TRUE(renderer.ok()) << renderer.status();
  if (!renderer.ok()) return picture;
  const auto plan = std::make_shared<const RoundPlan>(PlanFirstRound(spec));
  const SceneFolder film_folder;
  const auto film =
      Film::Create(film_folder.root() / "film", {FilmLayer::kPath, plan->grid, LayoutOf(spec)});
  EXPECT_TRUE(film.ok()) << film.status();
  OrderedMerge merge(**film, plan);
  RenderPool pool(2);
  for (uint32_t tile = 0; tile < plan->grid.Count(); ++tile) {
    for (uint32_t piece = 0; piece < plan->Pieces(tile); ++piece) {
      const WorkUnit unit = *plan->Unit({0, tile, piece});
      auto partial = (*renderer)->Render(unit, pool);
      EXPECT_TRUE(partial.ok()) << partial.status();
      const absl::Status check = CheckPartial(*partial, unit, LayoutOf(spec));
      EXPECT_TRUE(check.ok()) << check;
      for (const std::string& replay : partial->replays) ADD_FAILURE() << replay;
      const MergedCounts merged = merge.Add(*std::move(partial), 1).merged;
      picture.samples += merged.samples;
      picture.rays += merged.rays;
      picture.nonfinite += merged.nonfinite;
    }
  }
  picture.pixels = Estimate(GatherEstimateInput(**film, spec.crop));
  for (int y = 0; y < options.size; ++y)
    for (int x = 0; x < options.size; ++x)
      picture.depth.push_back((*film)->At(x, y).values[LayoutOf(spec).Plain(0)]);
  return picture;
}

Picture Render(const std::string& text, const RenderOptions& options) {
  const SceneFolder folder;
  folder.Write("scene.pbrt", text);
  return Render(LoadFolder(folder), options);
}

std::string SceneText(const std::string& eye, const std::string& look, double fov,
                      const std::string& world) {
  return absl::StrFormat(
      "LookAt %s  %s  0 0 1\nCamera \"perspective\" \"float fov\" %.17g\n"
      "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\nWorldBegin\n%s\n",
      eye, look, fov, world);
}

std::string Triangles(const std::vector<double>& corners) {
  std::string text = "Shape \"trianglemesh\" \"point3 P\" [";
  for (const double x : corners) absl::StrAppendFormat(&text, " %.9g", x);
  absl::StrAppend(&text, " ] \"integer indices\" [");
  for (size_t i = 0; i < corners.size() / 3; ++i) absl::StrAppend(&text, " ", i);
  return text + " ]\n";
}

FrameMean MeanOf(const Picture& picture, int channel) {
  FrameMean frame;
  double variance = 0;
  for (const PixelEstimate& pixel : picture.pixels) {
    frame.mean += pixel.mean[channel];
    variance += pixel.standard_error[channel] * pixel.standard_error[channel];
  }
  const double n = static_cast<double>(picture.pixels.size());
  return {frame.mean / n, std::sqrt(variance) / n};
}

void ExpectMean(const std::string& name, const Picture& picture, double truth, double rounding,
                double detectable) {
  const FrameMean frame = MeanOf(picture);
  Report(name + ", relative error", frame.mean / truth - 1);
  EXPECT_EQ(picture.nonfinite, 0u) << name;
  EXPECT_TRUE(Agrees(frame, truth, rounding))
      << name << ": " << frame.mean << " +- " << frame.standard_error << ", expected " << truth;
  EXPECT_FALSE(Agrees(frame, truth * (1 + detectable), rounding))
      << name << ": the control of " << detectable << " was not found: standard error "
      << frame.standard_error;
}

void ExpectSameMean(const std::string& name, const Picture& a, const Picture& b, double rounding,
                    double detectable) {
  const FrameMean of_a = MeanOf(a), of_b = MeanOf(b);
  const FrameMean both = {of_a.mean, std::hypot(of_a.standard_error, of_b.standard_error)};
  Report(name + ", relative difference", of_a.mean / of_b.mean - 1);
  EXPECT_EQ(a.nonfinite + b.nonfinite, 0u) << name;
  EXPECT_TRUE(Agrees(both, of_b.mean, rounding))
      << name << ": " << of_a.mean << " and " << of_b.mean << ", +- " << both.standard_error;
  EXPECT_FALSE(Agrees(both, of_b.mean * (1 + detectable), rounding))
      << name << ": the control of " << detectable << " was not found: standard error "
      << both.standard_error;
}

void ExpectEveryPixel(const std::string& name, const Picture& picture, double truth,
                      double rounding) {
  double worst = 0;
  for (const PixelEstimate& pixel : picture.pixels)
    worst = std::max(worst, std::abs(pixel.mean[1] / truth - 1));
  Report(name + ", largest relative error of a pixel", worst);
  EXPECT_EQ(picture.nonfinite, 0u) << name;
  EXPECT_LE(worst, rounding) << name;
}

void Report(const std::string& name, double figure) {
  const std::string text = absl::StrFormat("%.3g", figure);
  std::printf("    %s: %s\n", name.c_str(), text.c_str());
  testing::Test::RecordProperty(name, text);
}

}  // namespace strata
