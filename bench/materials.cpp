// What single scattering loses in the white furnace, and what a sum of lobes saves against one
// chosen at random.

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "worker/bsdf/bsdf.h"
#include "worker/integrator/render.h"
#include "worker/scene/scene.h"

namespace strata {
namespace {

// ---- the white furnace ----

/// The part of light from `degrees` that comes back, each facet reflecting all it gets.
double WhiteAlbedo(const Bsdf& bsdf, double degrees, int samples) {
  std::mt19937_64 random(1);
  const auto number = [&] { return static_cast<float>(random() >> 40) * 0x1p-24f; };
  const SinCosResult<double> theta = SinCos(Radians(degrees));
  const Vec3f wo = {static_cast<float>(theta.sin * 0.8), static_cast<float>(theta.sin * 0.6),
                    static_cast<float>(theta.cos)};
  double sum = 0;
  for (int i = 0; i < samples; ++i) {
    const float u_lobe = number(), u = number();
    const std::optional<BsdfSample> s = Sample(bsdf, wo, u_lobe, {u, number()});
    // Power, not radiance: refraction concentrates the latter.
    if (s) sum += s->weight.g * s->eta * s->eta;
  }
  return sum / samples;
}

void PrintFurnace(int samples) {
  const Rgb white = Rgb::Gray(1), mirror = Rgb::Gray(1e4f);
  struct Row {
    std::string name;
    Bsdf bsdf;
  };
  std::vector<Row> rows = {{"diffuse", DiffuseBsdf{white}}};
  for (const float alpha : {0.1f, 0.3f, 0.5f, 1.0f}) {
    const Ggx ggx = Ggx::FromAlpha(alpha, alpha);
    char name[64];
    std::snprintf(name, sizeof name, "conductor, alpha %g", static_cast<double>(alpha));
    rows.push_back({name, ConductorBsdf{white, mirror, ggx}});
    std::snprintf(name, sizeof name, "dielectric 1.5, alpha %g", static_cast<double>(alpha));
    rows.push_back({name, DielectricBsdf{1.5f, ggx}});
  }
  for (const float n : {1.0f, 10.0f, 100.0f, 1000.0f}) {
    char name[64];
    std::snprintf(name, sizeof name, "blinn, exponent %g", static_cast<double>(n));
    rows.push_back({name, BlinnBsdf{white, mirror, n}});
    for (const float rs : {0.05f, 1.0f}) {
      std::snprintf(name, sizeof name, "ashikhminshirley, exponent %g, Rs %g, Rd 1",
                    static_cast<double>(n), static_cast<double>(rs));
      rows.push_back({name, AshikhminShirleyBsdf{white, Rgb::Gray(rs), {n, n}}});
    }
  }
  std::printf("| Material | 0 degrees | 45 | 75 |\n|---|---|---|---|\n");
  for (const Row& row : rows) {
    std::printf("| %s |", row.name.c_str());
    for (const double angle : {0.0, 45.0, 75.0})
      std::printf(" %.3f |", WhiteAlbedo(row.bsdf, angle, samples));
    std::printf("\n");
  }
}

// ---- sums of lobes ----

/// A ball on a floor under a lamp and a sky, of half paint and half glossy metal.
SceneDescription Ball(bool sum, float roughness) {
  SceneDescription scene;
  const auto number = [&](float value) {
    scene.textures.push_back(ConstantTexture{Rgb::Gray(value)});
    return static_cast<TextureId>(scene.textures.size()) - 1;
  };
  const TextureId rough = number(roughness);
  scene.materials = {DiffuseMaterial{number(0.5f)},
                     ConductorMaterial{.reflectance = number(0.8f),
                                       .roughness = {.u = rough, .v = rough, .remap = false}},
                     MixMaterial{.a = 0, .b = 1, .amount = number(0.5f), .sum = sum}};
  const auto add = [&](ShapeGeometry geometry, Vec3f at, MaterialId material) -> ShapeDescription& {
    ShapeDescription& shape = scene.shapes.emplace_back();
    shape.geometry = std::move(geometry);
    shape.to_world = Transform::Translate(at.x, at.y, at.z);
    shape.material = material;
    return shape;
  };
  add(DiskShape{.radius = 20}, {0, 0, -1}, 0);
  add(SphereShape{.radius = 1, .z_min = -1, .z_max = 1}, {}, 2);
  add(SphereShape{.radius = 0.8f, .z_min = -0.8f, .z_max = 0.8f}, {2, -2, 3}, 0).emission =
      AreaEmission{Rgb::Gray(10)};
  scene.lights.push_back({{"bench", 1}, ConstantInfiniteLightDescription{Rgb::Gray(0.3f)}});
  scene.camera.camera_to_world = *Transform::LookAt({0, -5, 0.8}, {0, 0, 0}, {0, 0, 1})->Inverse();
  scene.camera.fov = 25;
  return scene;
}

struct Measured {
  double mean = 0, variance = 0, seconds = 0;  ///< Variance of a sample, mean over pixels.
};
Measured Measure(const SceneDescription& description, int size, uint32_t spp, int threads) {
  const auto scene = Scene::Build(description, DirectorySource("."));
  JobSpec spec;
  spec.bundle.scene = "ball";
  spec.bundle.files = {{spec.bundle.scene, {}, 0}};
  spec.width = spec.height = size;
  spec.crop = {0, 0, size, size};
  spec.max_depth = 4;
  spec.sampler = SamplerKind::kIndependent;
  const auto renderer = Renderer::Create(*scene, spec);
  RenderPool pool(threads);
  const auto start = std::chrono::steady_clock::now();
  const auto partial = (*renderer)->Render({{}, spec.crop, {{0, spp / kReplicates}}}, pool);
  Measured measured;
  measured.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const PixelLayout& layout = partial->layout;
  const int64_t pixels = partial->pixels.Pixels();
  for (int64_t pixel = 0; pixel < pixels; ++pixel) {
    const double* values = &partial->values[pixel * layout.Doubles()];
    double mean = 0, squares = 0;
    for (int r = 0; r < kReplicates; ++r) mean += values[layout.Mean(r, 1)] / kReplicates;
    for (int r = 0; r < kReplicates; ++r) {
      const double off = values[layout.Mean(r, 1)] - mean;
      squares += off * off;
    }
    measured.mean += mean / pixels;
    measured.variance += squares / (kReplicates - 1) * (spp / kReplicates) / pixels;
  }
  return measured;
}

void PrintMixtures(int size, uint32_t spp, int threads) {
  std::printf(
      "\n| alpha | mean, chosen | mean, sum | variance, sum over chosen | time | efficiency |\n"
      "|---|---|---|---|---|---|\n");
  for (const float alpha : {0.05f, 0.1f, 0.3f, 0.6f}) {
    const Measured chosen = Measure(Ball(false, alpha), size, spp, threads);
    const Measured sum = Measure(Ball(true, alpha), size, spp, threads);
    const double variance = sum.variance / chosen.variance, time = sum.seconds / chosen.seconds;
    std::printf("| %g | %.4f | %.4f | %.3f | %.2f | %.2f |\n", static_cast<double>(alpha),
                chosen.mean, sum.mean, variance, time, 1 / (variance * time));
  }
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  CLI::App app("White furnaces and sums of lobes");
  int samples = 1000000, size = 96, threads = 2;
  uint32_t spp = 512;
  app.add_option("--samples", samples, "samples of each albedo");
  app.add_option("--size", size, "pixels on an edge of the pictures of sums");
  app.add_option("--spp", spp, "their samples per pixel, a multiple of 8");
  app.add_option("--threads", threads);
  CLI11_PARSE(app, argc, argv);
  strata::PrintFurnace(samples);
  strata::PrintMixtures(size, spp, threads);
  return 0;
}
