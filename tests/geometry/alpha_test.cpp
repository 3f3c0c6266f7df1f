#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/geometry/scene_builder.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/geometry/texture.h"

// Alpha masks: what is there of a surface for which ray, asked alone and eight at once.

namespace strata::testing {
namespace {

/// These scenes have no image files.
class NoImages : public FileSource {
 public:
  absl::StatusOr<std::filesystem::path> Locate(const std::string& path) const override {
    return absl::NotFoundError(path);
  }
};

/// A scene with its textures, as Scene::Build puts it together.
struct MaskedScene {
  std::unique_ptr<TextureSet> textures;
  std::unique_ptr<Geometry> geometry;

  explicit MaskedScene(const SceneDescription& scene) : geometry(MustBuild(scene)) {
    auto loaded = TextureSet::Load(scene.textures, NoImages());
    EXPECT_TRUE(loaded.ok()) << loaded.status();
    textures = *std::move(loaded);
    geometry->SetTextures(*textures);
  }
};

/// The square [-1, 1]^2 at height z, uv from (0, 0) to (2, 2).
ShapeDescription Square(float z, AlphaMask alpha) {
  TriangleMeshShape mesh;
  mesh.positions = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}};
  mesh.uvs = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  ShapeDescription shape = Shape(mesh);
  shape.alpha = alpha;
  return shape;
}

TextureId AddConstant(SceneDescription* scene, float value) {
  scene->textures.push_back(ConstantTexture{Rgb::Gray(value)});
  return static_cast<TextureId>(scene->textures.size()) - 1;
}

// Textures of WithCheckerboard.
constexpr TextureId kOne = 1, kZero = 2, kCells = 3;

/// kCells is a checkerboard of kOne and kZero in unit cells of uv.
SceneDescription WithCheckerboard() {
  SceneDescription scene = EmptyScene();
  EXPECT_EQ(AddConstant(&scene, 1), kOne);
  EXPECT_EQ(AddConstant(&scene, 0), kZero);
  scene.textures.push_back(CheckerboardTexture{.a = kOne, .b = kZero});
  return scene;
}

/// The share of rays, each of another id, that meet something; every way of asking must agree.
double HitShare(const Geometry& geometry, int count, const std::function<Ray(uint32_t)>& ray_of) {
  int found = 0;
  for (int i = 0; i < count; i += kLanes) {
    RayLanes rays;
    const MaskLanes all = SameInt(-1);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Ray ray = ray_of(static_cast<uint32_t>(i + lane));
      rays.origin.Set(lane, ray.origin);
      rays.direction.Set(lane, ray.direction);
      rays.id[lane] = static_cast<int32_t>(ray.id);
    }
    HitLanes hits;
    const MaskLanes met = Intersect(geometry, rays, all, &hits);
    const MaskLanes blocked = Occluded(geometry, rays, all);
    for (int lane = 0; lane < kLanes; ++lane) {
      Hit hit;
      const bool meets = geometry.Intersect(rays.Get(lane), &hit);
      EXPECT_EQ(meets, met[lane] != 0);
      EXPECT_EQ(meets, blocked[lane] != 0);
      EXPECT_EQ(meets, geometry.Occluded(rays.Get(lane)));
      found += meets;
    }
  }
  return static_cast<double>(found) / count;
}

Ray Down(float x, float y, uint32_t id) {
  return {.origin = {x, y, 5}, .direction = {0, 0, -1}, .id = id};
}

/// Five standard deviations of a share of `count`.
double Spread(double share, int count) { return 5 * std::sqrt(share * (1 - share) / count); }

TEST(AlphaMasks, CutOutWhereTheTextureSays) {
  SceneDescription scene = WithCheckerboard();
  scene.shapes.push_back(Square(0, {kCells}));
  const MaskedScene masked(scene);
  ASSERT_TRUE(masked.geometry->has_alpha());
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const auto x = static_cast<float>(Uniform(random, -0.99, 0.99));
    const auto y = static_cast<float>(Uniform(random, -0.99, 0.99));
    if (std::fabs(x) < 1e-3f || std::fabs(y) < 1e-3f) continue;
    const bool there = (x < 0) == (y < 0);
    EXPECT_EQ(HitShare(*masked.geometry, 8, [&](uint32_t id) { return Down(x, y, id); }), there)
        << x << " " << y;
  }
}

TEST(AlphaMasks, ShowWhatIsBehind) {
  SceneDescription scene = WithCheckerboard();
  scene.shapes.push_back(Square(1, {kCells}));
  scene.shapes.push_back(Square(0, {}));
  const MaskedScene masked(scene);
  for (const float x : {-0.5f, 0.5f}) {
    const Ray ray = Down(x, -0.5f, 0);
    Hit hit;
    ASSERT_TRUE(masked.geometry->Intersect(ray, &hit));
    EXPECT_FLOAT_EQ(masked.geometry->Surface(ray, hit).p.z, x < 0 ? 1 : 0);
    EXPECT_FLOAT_EQ(masked.geometry->Surface(ray, hit).uv.x, x + 1);
  }
}

TEST(AlphaMasks, AreThereWithTheirProbability) {
  constexpr int kCount = 40000;
  for (const float alpha : {0.1f, 0.5f, 0.9f}) {
    SceneDescription scene = EmptyScene();
    const TextureId constant = AddConstant(&scene, alpha);
    scene.shapes.push_back(Square(0, {constant}));
    const MaskedScene one(scene);
    const auto ray = [](uint32_t i) { return Down(0.3f, 0.1f, i); };
    EXPECT_NEAR(HitShare(*one.geometry, kCount, ray), alpha, Spread(alpha, kCount));
    // Each of two layers decides on its own.
    scene.shapes.push_back(Square(1, {constant}));
    const MaskedScene two(scene);
    const double either = 1 - (1 - alpha) * (1 - alpha);
    EXPECT_NEAR(HitShare(*two.geometry, kCount, ray), either, Spread(either, kCount));
    EXPECT_GT(std::fabs(either - alpha), Spread(either, kCount));  // The control.
  }
}

TEST(AlphaMasks, LeaveBothSidesOfASphereTheirChance) {
  constexpr int kCount = 40000;
  SceneDescription scene = EmptyScene();
  ShapeDescription sphere = Shape(SphereShape{});
  sphere.alpha.texture = AddConstant(&scene, 0.5f);
  scene.shapes.push_back(sphere);
  const MaskedScene masked(scene);
  EXPECT_NEAR(HitShare(*masked.geometry, kCount, [](uint32_t i) { return Down(0.3f, 0.1f, i); }),
              0.75, Spread(0.75, kCount));
}

/// A curve along x from -1 to 1 at z = 0, 0.8 wide, whose ribbon looks up.
ShapeDescription Curve(CurveKind kind, AlphaMask alpha) {
  CurveShape curve;
  curve.kind = kind;
  for (int i = 0; i < 4; ++i) {
    curve.positions.push_back({-1 + 2 * static_cast<float>(i) / 3, 0, 0});
    curve.radii.push_back(0.4f);
    if (kind == CurveKind::kRibbon) curve.normals.push_back({0, 0, 1});
  }
  curve.segments = {0};
  ShapeDescription shape = Shape(curve);
  shape.alpha = alpha;
  return shape;
}
constexpr CurveKind kCurveKinds[] = {CurveKind::kFlat, CurveKind::kCylinder, CurveKind::kRibbon};

TEST(AlphaMasks, CutCurvesAlongAndAcross) {
  for (const CurveKind kind : kCurveKinds) {
    // Cells of half the length and half the width. A tube's two walls have equal cells here.
    SceneDescription scene = WithCheckerboard();
    std::get<CheckerboardTexture>(scene.textures[kCells]).mapping = {2, 2, 0, 0};
    scene.objects.push_back(ObjectOf({Curve(kind, {kCells})}));
    scene.shapes.push_back(Curve(kind, {kCells}));
    for (const double y : {10.0, 20.0})
      scene.instances.push_back(InstanceOf(0, Transform::Translate(0, y, 0)));
    const MaskedScene masked(scene);
    ASSERT_TRUE(masked.geometry->has_alpha());
    for (const float place : {0.0f, 10.0f, 20.0f}) {
      const auto share = [&](float x, float y) {
        return HitShare(*masked.geometry, 8, [&](uint32_t id) { return Down(x, place + y, id); });
      };
      for (const float x : {-0.5f, 0.5f}) {
        const double one = share(x, 0.2f), other = share(x, -0.2f);
        EXPECT_EQ(one + other, 1) << static_cast<int>(kind) << " at " << x;
        EXPECT_EQ(share(-x, 0.2f), other);
      }
    }
  }
}

TEST(AlphaMasks, LeaveCurvesTheirChance) {
  constexpr int kCount = 40000;
  for (const CurveKind kind : kCurveKinds) {
    SceneDescription scene = EmptyScene();
    scene.shapes.push_back(Curve(kind, {AddConstant(&scene, 0.5f)}));
    // Beside it one without a mask, in the same set.
    scene.shapes.push_back(Curve(kind, {}));
    scene.shapes.back().to_world = Transform::Translate(0, 5, 0);
    const MaskedScene masked(scene);
    // A ray meets both walls of a tube.
    const double truth = kind == CurveKind::kCylinder ? 0.75 : 0.5;
    EXPECT_NEAR(HitShare(*masked.geometry, kCount, [](uint32_t i) { return Down(0.3f, 0.1f, i); }),
                truth, Spread(truth, kCount));
    EXPECT_EQ(HitShare(*masked.geometry, 80, [](uint32_t i) { return Down(0.3f, 5.1f, i); }), 1);
  }
}

TEST(AlphaMasks, OpenTheNearSideOfASphere) {
  // u is the angle about z over a turn: the half of y > 0 is there, that of y < 0 is not.
  SceneDescription scene = WithCheckerboard();
  std::get<CheckerboardTexture>(scene.textures[kCells]).mapping = {2, 0, 0, 0};
  ShapeDescription sphere = Shape(SphereShape{});
  sphere.alpha.texture = kCells;
  scene.shapes.push_back(sphere);
  const MaskedScene masked(scene);
  const Ray ray = {{0.1f, -5, 0.2f}, {0, 1, 0}};
  Hit hit;
  ASSERT_TRUE(masked.geometry->Intersect(ray, &hit));
  EXPECT_GT(masked.geometry->Surface(ray, hit).p.y, 0.9f);
  EXPECT_EQ(HitShare(*masked.geometry, 8, [&](uint32_t) { return ray; }), 1);
}

TEST(AlphaMasks, WorkInInstances) {
  SceneDescription scene = WithCheckerboard();
  // The solid texture knows the world's places: its cells are there where floor(x) + ... is even.
  scene.textures.push_back(CheckerboardTexture{.a = kOne, .b = kZero, .solid = true});
  const TextureId solid = kCells + 1, half = AddConstant(&scene, 0.5f);
  for (const TextureId alpha : {kCells, solid, half})
    scene.objects.push_back(ObjectOf({Square(0, {alpha})}));
  for (int object = 0; object < 3; ++object) {
    for (const int place : {0, 11})
      scene.instances.push_back(
          InstanceOf(object, Transform::Translate(100 * object + place, 0, 0.5)));
  }
  const MaskedScene masked(scene);
  const auto share = [&](float x, float y, int count = 8) {
    return HitShare(*masked.geometry, count, [&](uint32_t i) { return Down(x, y, i); });
  };
  for (const float place : {0.0f, 11.0f}) {
    EXPECT_EQ(share(place - 0.5f, -0.5f), 1);
    EXPECT_EQ(share(place + 0.5f, -0.5f), 0);
    // The odd step to the second place changes the parity of the cells.
    EXPECT_EQ(share(100 + place + 0.5f, 0.5f), place == 0 ? 1 : 0);
    EXPECT_EQ(share(100 + place - 0.5f, 0.5f), place == 0 ? 0 : 1);
    EXPECT_NEAR(share(200 + place, 0.3f, 40000), 0.5, Spread(0.5, 40000));
  }
}

TEST(AlphaMasks, HaveACutoff) {
  for (const float alpha : {0.49f, 0.51f}) {
    SceneDescription scene = WithCheckerboard();
    // Not known to be the same everywhere, so that it is looked up.
    const TextureId value = AddConstant(&scene, alpha);
    scene.textures[kCells] = CheckerboardTexture{.a = value, .b = value};
    scene.shapes.push_back(Square(0, {kCells, 0.5f}));
    const MaskedScene masked(scene);
    EXPECT_EQ(HitShare(*masked.geometry, 800, [](uint32_t i) { return Down(0.3f, 0.1f, i); }),
              alpha > 0.5f);
  }
}

TEST(AlphaMasks, OfConstantsAreResolvedAtOnce) {
  SceneDescription scene = WithCheckerboard();
  scene.shapes = {Square(0, {kOne}), Square(1, {kZero})};
  const MaskedScene masked(scene);
  EXPECT_FALSE(masked.geometry->has_alpha());
  EXPECT_EQ(masked.geometry->triangle_count(), 2u);
}

TEST(AlphaMasks, OfUnknownTexturesAreLocatedErrors) {
  SceneDescription scene = EmptyScene();
  scene.shapes = {Square(0, {5})};
  const auto geometry = Geometry::Build(scene);
  EXPECT_EQ(geometry.status().message(),
            "scene.pbrt:7: the shape's alpha is texture 5, which does not exist");
}

TEST(AlphaMasks, MarkTheirEmitters) {
  SceneDescription scene = WithCheckerboard();
  scene.shapes = {Square(0, {kCells}), Square(1, {})};
  for (ShapeDescription& shape : scene.shapes) shape.emission = AreaEmission{Rgb::Gray(1)};
  const MaskedScene masked(scene);
  ASSERT_EQ(masked.geometry->emitters().size(), 4u);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(masked.geometry->emitters()[i].masked, i < 2);
}

}  // namespace
}  // namespace strata::testing
