#include "cli/lab/plates_scene.h"

#include <cmath>

#include "worker/math/vec3d.h"
#include "worker/scene/file_source.h"

namespace strata::lab {
namespace {

// y is up; the camera looks along -z and has, as pbrt's, x to the left of its picture.
constexpr Vec3d kEye = {0, 2, 15};
constexpr Vec3d kTarget = {0, -1.6, 2};
constexpr double kFov = 33;
constexpr std::array<double, 4> kLampX = {3.75, 1.25, -1.25, -3.75};
constexpr double kHalfWidth = 4.2, kHalfDepth = 0.45;
/// Middles of the plates: y and z.
constexpr std::array<Vec2f, 4> kPlates = {
    {{-2.3f, 0.0f}, {-3.0f, 1.2f}, {-3.55f, 2.5f}, {-3.9f, 3.9f}}};

/// Builds the description.
class Builder {
 public:
  SceneDescription Build() {
    const MaterialId wall = Add(DiffuseMaterial{Gray(0.35f)});
    const MaterialId black = Add(DiffuseMaterial{Gray(0)});
    Quad({-12, -4.6, -4}, {24, 0, 0}, {0, 0, 24}, wall);
    Quad({-12, -4.6, -4}, {0, 14, 0}, {24, 0, 0}, wall);
    for (size_t i = 0; i < PlatesScene::kRadii.size(); ++i) {
      const float radius = PlatesScene::kRadii[i];
      ShapeDescription& lamp = scene_.shapes.emplace_back();
      lamp.geometry = SphereShape{radius, -radius, radius};
      lamp.to_world = Transform::Translate(kLampX[i], 0, 0);
      lamp.material = black;
      lamp.emission = AreaEmission{Rgb::Gray(1 / (radius * radius))};
    }
    for (size_t i = 0; i < kPlates.size(); ++i) Plate(i);
    scene_.camera.camera_to_world = *Transform::LookAt(kEye, kTarget, {0, 1, 0})->Inverse();
    scene_.camera.fov = static_cast<float>(kFov);
    return std::move(scene_);
  }

 private:
  TextureId Gray(float value) {
    scene_.textures.push_back(ConstantTexture{Rgb::Gray(value)});
    return static_cast<TextureId>(scene_.textures.size()) - 1;
  }
  MaterialId Add(MaterialDescription material) {
    scene_.materials.push_back(std::move(material));
    return static_cast<MaterialId>(scene_.materials.size()) - 1;
  }
  void Quad(Vec3d corner, Vec3d edge1, Vec3d edge2, MaterialId material) {
    ShapeDescription& shape = scene_.shapes.emplace_back();
    shape.geometry =
        TriangleMeshShape{.positions = {ToFloat(corner), ToFloat(corner + edge1),
                                        ToFloat(corner + edge1 + edge2), ToFloat(corner + edge2)},
                          .triangles = {{0, 1, 2}, {0, 2, 3}}};
    shape.material = material;
  }
  void Plate(size_t i) {
    const TextureId alpha = Gray(PlatesScene::kAlphas[i]);
    const MaterialId metal = Add(ConductorMaterial{
        .reflectance = Gray(0.9f), .roughness = {.u = alpha, .v = alpha, .remap = false}});
    const Vec3d middle = {0, kPlates[i].x, kPlates[i].y};
    // Halfway between the directions to the camera and to the row of lamps, which meets the origin.
    const Vec3d normal = Normalize(Normalize(kEye - middle) + Normalize(-middle));
    const Vec3d across = Cross({1, 0, 0}, normal);
    Quad(middle - Vec3d{kHalfWidth, 0, 0} - across * kHalfDepth, {2 * kHalfWidth, 0, 0},
         across * (2 * kHalfDepth), metal);
  }

  SceneDescription scene_;
};

/// The pixel, not rounded, in which the camera sees a point.
Vec2f Project(Vec3d point) {
  const Vec3d forward = Normalize(kTarget - kEye), right = Normalize(Cross({0, 1, 0}, forward));
  const Vec3d up = Cross(forward, right), d = point - kEye;
  const double scale = 0.5 * PlatesScene::kHeight / std::tan(kFov * M_PI / 360) / Dot(d, forward);
  return {static_cast<float>(0.5 * PlatesScene::kWidth + scale * Dot(d, right)),
          static_cast<float>(0.5 * PlatesScene::kHeight - scale * Dot(d, up))};
}

/// Around the point of the plate where a mirror would show the lamp's middle.
PixelRect Highlight(size_t plate, size_t lamp) {
  constexpr int kReach = 6;
  const Vec3d middle = {0, kPlates[plate].x, kPlates[plate].y};
  // Unfolded, the ray to the lamp is straight.
  const double to_eye = Length(kEye - middle), to_lamp = Length(middle);
  const Vec2f p = Project(middle + Vec3d{kLampX[lamp] * to_eye / (to_eye + to_lamp), 0, 0});
  const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
  return {x - kReach, y - kReach / 3, x + kReach + 1, y + kReach / 3 + 1};
}

}  // namespace

absl::StatusOr<PlatesScene> MakePlatesScene() {
  PlatesScene plates;
  // The guide to mirrored lamps would help BSDF sampling, which is to be seen as it is.
  STRATA_ASSIGN_OR_RETURN(
      plates.scene, Scene::Build(Builder().Build(), DirectorySource("."), {.mirrors = false}));
  for (size_t plate = 0; plate < 4; ++plate) {
    for (size_t lamp = 0; lamp < 4; ++lamp) {
      plates.highlights[plate][lamp] = Highlight(plate, lamp);
    }
  }
  return plates;
}

}  // namespace strata::lab
