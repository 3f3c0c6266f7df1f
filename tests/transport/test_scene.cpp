#include "tests/transport/test_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "worker/math/transform.h"

namespace strata {

TestScene::TestScene() { Diffuse(0.5f); }

TextureId TestScene::Texture(Rgb value) {
  description.textures.push_back(ConstantTexture{value});
  return static_cast<TextureId>(description.textures.size()) - 1;
}

MaterialId TestScene::Material(const MaterialDescription& material) {
  description.materials.push_back(material);
  return static_cast<MaterialId>(description.materials.size()) - 1;
}

MaterialId TestScene::Diffuse(float reflectance) { return Diffuse(Rgb::Gray(reflectance)); }
MaterialId TestScene::Diffuse(Rgb reflectance) {
  return Material(DiffuseMaterial{Texture(reflectance)});
}

void TestScene::Sphere(Vec3f center, float radius, MaterialId material,
                       std::optional<AreaEmission> emission, bool reverse) {
  ShapeDescription shape;
  shape.geometry = SphereShape{radius, -radius, radius, 360};
  shape.to_world = Transform::Translate(center.x, center.y, center.z);
  shape.material = material;
  shape.reverse_orientation = reverse;
  shape.emission = emission;
  description.shapes.push_back(shape);
}

void TestScene::Polygon(const std::vector<Vec3f>& corners, MaterialId material,
                        std::optional<AreaEmission> emission) {
  TriangleMeshShape mesh;
  mesh.positions = corners;
  for (uint32_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({0, i - 1, i});
  ShapeDescription shape;
  shape.geometry = mesh;
  shape.material = material;
  shape.emission = emission;
  description.shapes.push_back(shape);
}

void TestScene::Light(decltype(LightDescription::light) light) {
  description.lights.push_back({{"test", 1}, std::move(light)});
}

void TestScene::Camera(Vec3f eye, Vec3f look, float fov) {
  const Vec3f view = look - eye;
  const Vec3d up = view.x == 0 && view.z == 0 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
  const auto to_double = [](Vec3f v) { return Vec3d{v.x, v.y, v.z}; };
  description.camera.camera_to_world =
      *Transform::LookAt(to_double(eye), to_double(look), up)->Inverse();
  description.camera.fov = fov;
}

AreaEmission Emits(float radiance, bool two_sided) { return {Rgb::Gray(radiance), two_sided}; }

JobSpec TestSpec(int size, uint32_t spp, int max_depth) {
  JobSpec spec;
  spec.bundle.scene = "test.pbrt";
  spec.bundle.files = {{"test.pbrt", DigestOf("test"), 4}};
  spec.width = spec.height = size;
  spec.crop = {0, 0, size, size};
  spec.spp = spp;
  spec.max_depth = max_depth;
  spec.seed = 7;
  return spec;
}

std::shared_ptr<const Scene> BuildScene(const TestScene& scene, const FileSource& source,
                                        const BuildOptions& lights) {
  auto built = Scene::Build(scene.description, source, lights);
  EXPECT_TRUE(built.ok()) << built.status();
  return *built;
}

Partial RenderFrame(std::shared_ptr<const Scene> scene, JobSpec spec, DirectStrategy strategy) {
  spec.strategy = strategy;
  return RenderFrame(std::move(scene), spec);
}

Partial RenderFrame(std::shared_ptr<const Scene> scene, const JobSpec& spec) {
  auto renderer = Renderer::Create(std::move(scene), spec);
  EXPECT_TRUE(renderer.ok()) << renderer.status();
  RenderPool pool(2);
  auto partial = (*renderer)->Render({{}, spec.crop, {{0, spec.spp / kReplicates}}}, pool);
  EXPECT_TRUE(partial.ok()) << partial.status();
  return *std::move(partial);
}

Estimate FrameMean(const Partial& partial, int channel) {
  const PixelLayout& layout = partial.layout;
  double sum = 0, variance = 0;
  const int64_t pixels = partial.pixels.Pixels();
  for (int64_t pixel = 0; pixel < pixels; ++pixel) {
    const double* values = &partial.values[pixel * layout.Doubles()];
    const double mean = PixelMean(partial, pixel, channel);
    sum += mean;
    double squares = 0;
    for (int r = 0; r < kReplicates; ++r) {
      const double deviation = values[layout.Mean(r, channel)] - mean;
      squares += deviation * deviation;
    }
    variance += squares / (kReplicates - 1) / kReplicates;
  }
  const double n = static_cast<double>(pixels);
  return {sum / n, std::sqrt(variance) / n};
}

double PixelMean(const Partial& partial, int64_t pixel, int channel) {
  const double* values = &partial.values[pixel * partial.layout.Doubles()];
  double mean = 0;
  for (int r = 0; r < kReplicates; ++r)
    mean += values[partial.layout.Mean(r, channel)] / kReplicates;
  return mean;
}

bool Agrees(const Estimate& estimate, double truth) {
  return std::abs(estimate.mean - truth) <=
         kCritical * estimate.standard_error + 1e-5 * std::abs(truth);
}

bool Agree(const Estimate& a, const Estimate& b) {
  return Agrees({a.mean, std::hypot(a.standard_error, b.standard_error)}, b.mean);
}

void ExpectMean(const Partial& partial, double truth, double detectable) {
  const Estimate estimate = FrameMean(partial, 1);
  EXPECT_TRUE(Agrees(estimate, truth))
      << estimate.mean << " +- " << estimate.standard_error << ", expected " << truth;
  EXPECT_FALSE(Agrees(estimate, truth * (1 + detectable)))
      << "the control of " << 100 * detectable << " % was not found: standard error "
      << estimate.standard_error;
}

}  // namespace strata
