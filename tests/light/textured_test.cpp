#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/light/lamp.h"
#include "tests/light/light_scene.h"
#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"
#include "worker/light/emission.h"

// Lamps whose radiance is multiplied by a texture: what is sampled and what a ray meets agree, and
// both are where the texture says.

namespace strata {
namespace {

/// A folder with one image of random values in [0.1, 1.1), of no symmetry.
class ImageFolder {
 public:
  ImageFolder() {
    std::string name = ::testing::TempDir() + "/strata_lamp_XXXXXX";
    folder_ = mkdtemp(name.data());
    constexpr int kWidth = 16, kHeight = 12;
    std::ofstream file(folder_ / "image.pfm", std::ios::binary);
    file << "PF\n" << kWidth << " " << kHeight << "\n-1.0\n";
    TestRandom random(11);
    for (int i = 0; i < kWidth * kHeight * 3; ++i) {
      const float value = 0.1f + random.Float();
      file.write(reinterpret_cast<const char*>(&value), sizeof(value));
    }
  }
  ~ImageFolder() { std::filesystem::remove_all(folder_); }

  DirectorySource source() const { return DirectorySource(folder_); }
  static ImageTexture Image() { return {.path = "image.pfm", .wrap = ImageWrap::kClamp}; }

 private:
  std::filesystem::path folder_;
};

/// Meshes get (u, v) that continue from one triangle to the next.
ShapeDescription WithUv(ShapeDescription shape) {
  if (auto* mesh = std::get_if<TriangleMeshShape>(&shape.geometry)) {
    for (const Vec3f p : mesh->positions)
      mesh->uvs.push_back({0.5f + 0.4f * p.x - 0.1f * p.y, 0.5f + 0.1f * p.x + 0.4f * p.y});
  }
  return shape;
}

TEST(TexturedLamps, AreTrianglesIfTheirSurfaceIs) {
  const std::vector<LampCase> cases = AllLampCases();
  int triangles = 0, others = 0;
  for (const LampCase& c : cases) {
    SceneDescription scene;
    scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
    scene.shapes.push_back(WithUv(c.shape));
    scene.shapes[0].emission->texture = 0;
    const LightScene built(std::move(scene));
    ASSERT_TRUE(std::holds_alternative<TexturedLight>(built.lights.lights().at(0))) << c.name;
    const bool expected = c.name.rfind("triangle", 0) == 0 || c.name.rfind("sliver", 0) == 0;
    EXPECT_EQ(built.lights.IsTriangle(0), expected) << c.name;
    ++(expected ? triangles : others);
  }
  EXPECT_GT(triangles, 3);
  EXPECT_GT(others, 3);
}

/// The part of the samples whose radiance is what a ray to `seen` meets at the sampled point.
double MatchingShare(const LampCase& c, const Lamp& sampled, const Lamp& seen) {
  TestRandom random(3);
  constexpr int kTries = 2000;
  int matches = 0;
  for (int i = 0; i < kTries; ++i) {
    const std::optional<LightSample> sample = sampled.Sample(c.from, random.Float2());
    if (!sample) continue;
    const float distance = Length(sample->end - c.from);
    bool found = false;
    for (const Lamp::Meeting& meeting : seen.Meetings(c.from, sample->wi)) {
      const Rgb off = meeting.radiance - sample->radiance;
      found |= std::abs(meeting.hit.distance - distance) < 1e-3f * distance &&
               std::abs(meeting.pdf - sample->pdf) < 0.01f * sample->pdf &&
               std::abs(off.r) + std::abs(off.g) + std::abs(off.b) < 0.01f;
    }
    matches += found;
  }
  return static_cast<double>(matches) / kTries;
}

TEST(TexturedLamps, LookAsTheyAreSampled) {
  const ImageFolder folder;
  const ImageTexture image = ImageFolder::Image();
  ImageTexture mirrored = image;
  mirrored.mapping = {.su = -1, .du = 1};
  for (const LampCase& c : AllLampCases()) {
    const ShapeDescription shape = WithUv(c.shape);
    const Lamp lamp(shape, image, folder.source());
    // Rays miss the very edge of a lamp, and meet its limb elsewhere.
    EXPECT_GE(MatchingShare(c, lamp, lamp), 0.995) << c.name;
    // The control: the texture mirrored.
    EXPECT_LE(MatchingShare(c, lamp, Lamp(shape, mirrored, folder.source())), 0.3) << c.name;
  }
}

constexpr Vec3f kCorner = {-1, -1, 2}, kEdge1 = {2, 0, 0}, kEdge2 = {0.3f, 2, 0};

ShapeDescription Board(float v_end = 1) {
  TriangleMeshShape mesh;
  mesh.positions = {kCorner, kCorner + kEdge1, kCorner + kEdge1 + kEdge2, kCorner + kEdge2};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, v_end}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return EmissiveShape(mesh);
}

/// Irradiance at `from`, facing up, of a board with cells of a third by a half, every other one
/// shining; by the midpoint rule within each.
double BoardIrradiance(Vec3f from, bool first_cell_shines) {
  constexpr int kGrid = 40, kColumns = 3, kRows = 2;
  const double area = Length(Cross(kEdge1, kEdge2)) / (kGrid * kGrid * kColumns * kRows);
  double sum = 0;
  for (int y = 0; y < kRows * kGrid; ++y) {
    for (int x = 0; x < kColumns * kGrid; ++x) {
      if (((x / kGrid + y / kGrid) % 2 == 0) != first_cell_shines) continue;
      const float u = (static_cast<float>(x) + 0.5f) / (kColumns * kGrid);
      const float v = (static_cast<float>(y) + 0.5f) / (kRows * kGrid);
      const Vec3f d = kCorner + kEdge1 * u + kEdge2 * v - from;
      const double distance2 = LengthSquared(d);
      sum += double{d.z} * double{d.z} / (distance2 * distance2) * area;
    }
  }
  return sum;
}

TEST(TexturedLamps, GiveTheIrradianceOfTheTexture) {
  // The board is one light, sampled by area from afar and by solid angle from near.
  const CheckerboardTexture cells = {.a = 2, .b = 3, .mapping = {3, 2}};
  SceneDescription scene;
  scene.textures = {ConstantTexture{Rgb::Gray(0.5f)}, cells, ConstantTexture{Rgb::Gray(1)},
                    ConstantTexture{}};
  scene.materials = {DiffuseMaterial{0}};
  scene.shapes = {Board()};
  scene.shapes[0].emission = AreaEmission{{1, 0.5f, 0.25f}, false, 1};
  scene.shapes[0].reverse_orientation = true;
  const DirectorySource none(".");
  const auto geometry = *Geometry::Build(scene);
  const auto textures = *TextureSet::Load(scene.textures, none);
  const LightSet lights = *LightSet::Build(scene, *geometry, *textures, none);
  ASSERT_EQ(lights.lights().size(), 1u);
  TestRandom random(8);
  for (const Vec3f from : {Vec3f{0.3f, 0.2f, 0}, Vec3f{0.3f, 0.2f, 1.2f}}) {
    MeanWithError mean;
    for (int i = 0; i < 800000; ++i) {
      const std::optional<LightSample> sample = lights.Sample(0, from, random.Float2());
      mean.Add(sample ? sample->radiance.r * std::max(0.0f, sample->wi.z) / sample->pdf : 0);
    }
    EXPECT_NEAR(mean.mean(), BoardIrradiance(from, true), 4 * mean.error());
    EXPECT_LT(mean.error(), 2e-3 * mean.mean());
    // The control: the board's negative, whose irradiance differs by 3 % or more.
    EXPECT_GT(std::abs(mean.mean() - BoardIrradiance(from, false)), 4 * mean.error());
  }
}

TEST(TexturedLamps, AreOneQuadWhereTheTextureContinues) {
  const auto count = [](const ShapeDescription& board) {
    SceneDescription scene;
    scene.textures = {ConstantTexture{Rgb::Gray(0.5f)}};
    scene.materials = {DiffuseMaterial{0}};
    scene.shapes = {board};
    scene.shapes[0].emission->texture = 0;
    const DirectorySource none(".");
    const auto geometry = *Geometry::Build(scene);
    const auto textures = *TextureSet::Load(scene.textures, none);
    return LightSet::Build(scene, *geometry, *textures, none)->lights().size();
  };
  EXPECT_EQ(count(Board()), 1u);
  EXPECT_EQ(count(Board(0.9f)), 2u);
}

TEST(TexturedLamps, HaveTheirPowerAboutWhereTheirTextureJumps) {
  // Seven cells of fifteen shine. They end between points of the grid that finds the mean.
  const auto power = [](TextureId texture) {
    SceneDescription scene;
    scene.textures = {ConstantTexture{}, ConstantTexture{Rgb::Gray(1)},
                      CheckerboardTexture{.a = 0, .b = 1, .mapping = {3, 5}}};
    scene.shapes = {Board()};
    scene.shapes[0].emission->texture = texture;
    const LightScene built(std::move(scene));
    return std::visit([](const auto& l) { return Power(l, {}); }, built.lights.lights().at(0)).g;
  };
  EXPECT_NEAR(power(2) / power(1), 7.0 / 15, 0.005);
}

TEST(TexturedLamps, AreChosenByTheMeanOfTheirTexture) {
  // Three disks at one place: plain, of a texture of mean 1/4, and one that is black.
  SceneDescription scene;
  scene.textures = {ConstantTexture{Rgb::Gray(0.5f)}, ConstantTexture{},
                    CheckerboardTexture{.a = 0, .b = 1, .mapping = {2, 2}}};
  scene.materials = {DiffuseMaterial{0}};
  for (const TextureId texture : {kNoTexture, 2, 1}) {
    scene.shapes.push_back(EmissiveShape(DiskShape{}, Transform::Translate(0, 0, 1)));
    scene.shapes.back().emission->texture = texture;
  }
  const DirectorySource none(".");
  const auto geometry = *Geometry::Build(scene);
  const auto textures = *TextureSet::Load(scene.textures, none);
  const LightSet lights = *LightSet::Build(scene, *geometry, *textures, none);
  ASSERT_EQ(lights.lights().size(), 3u);
  const LightReceiver receiver = {{0, 0, -3}, {0, 0, 1}};
  // One in a hundred choices is among all alike.
  const auto by_intensity = [&](uint32_t light) {
    return (lights.Probability(light, receiver) - 0.01 / 3) / 0.99;
  };
  EXPECT_NEAR(by_intensity(1) / by_intensity(0), 0.25, 0.01);
  EXPECT_GT(by_intensity(2), 0);
  EXPECT_LT(by_intensity(2), 1e-3);
}

}  // namespace
}  // namespace strata
