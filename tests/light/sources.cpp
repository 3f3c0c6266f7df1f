#include "tests/light/sources.h"

#include "tests/light/lamp.h"
#include "tests/statistics/random.h"

namespace strata {
namespace {

/// Faces down, at height 1.5.
TriangleMeshShape Board() {
  TriangleMeshShape mesh;
  mesh.positions = {
      {-0.4f, -0.3f, 1.5f}, {-0.4f, 0.5f, 1.5f}, {0.6f, 0.5f, 1.5f}, {0.6f, -0.3f, 1.5f}};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Random values over an image texture; each and its mirror image across the diagonal from (0, 0)
/// to (1, 1) sum to 1, between the centres of pixels too. So their mean over a rectangle is 1/2
/// exactly, and so is that over any points which lie alike on both sides of the diagonal.
std::vector<Rgb> Uneven(int size) {
  TestRandom random(22);
  std::vector<Rgb> pixels(static_cast<size_t>(size) * size, Rgb::Gray(0.5f));
  const auto at = [&](int s, int t) -> Rgb& { return pixels[(size - 1 - t) * size + s]; };
  for (int t = 0; t < size; ++t) {
    for (int s = 0; s < t; ++s) {
      const float value = random.Float();
      at(s, t) = Rgb::Gray(value);
      at(t, s) = Rgb::Gray(1 - value);
    }
  }
  return pixels;
}

std::vector<Rgb> RandomPixels(int count, uint64_t seed) {
  TestRandom random(seed);
  std::vector<Rgb> pixels;
  for (int i = 0; i < count; ++i) pixels.push_back(Rgb::Gray(i % 6 == 0 ? 0 : random.Float()));
  return pixels;
}

const Transform kAbove = Transform::Translate(0.3, 0.1, 1.5);
/// A light's z axis turned down, a little aslant.
const Transform kDown = kAbove * Transform::Rotate(170, 1, 0.3, 0);
/// The same beside the vertical; its y axis points down.
const Transform kAside = kAbove * Transform::Rotate(-80, 1, 0.3, 0);

}  // namespace

std::vector<Source> Sources(const LightFiles& files) {
  TestRandom random(21);
  std::vector<Rgb> picture, sky;
  for (int i = 0; i < 12 * 8; ++i) picture.push_back(Rgb::Gray(i % 7 == 0 ? 0 : random.Float()));
  for (int i = 0; i < 16 * 16; ++i)
    sky.push_back(Rgb::Gray(i % 5 == 0 ? 0 : i == 130 ? 40 : random.Float()));
  files.WriteImage("picture.pfm", 12, 8, picture);
  files.WriteImage("sky.pfm", 16, 16, sky);
  files.WriteImage("uneven.pfm", 8, 8, Uneven(8));
  files.WriteImage("lamp.pfm", 9, 9, RandomPixels(9 * 9, 23));
  files.WriteImage("latlong.pfm", 24, 12, RandomPixels(24 * 12, 24));
  files.WriteImage("stripes.pfm", 32, 2, RandomPixels(32 * 2, 25));
  files.Write("lamp.ies",
              "TILT=NONE\n1 -1 1 4 3 1 2 0 0 0 1 1 9\n0 30 60 120\n0 45 90\n"
              "9 7 3 0 9 8 5 2 9 4 1 0\n");
  const auto shape = [](ShapeGeometry geometry, const Transform& to_world, bool two_sided) {
    return [=](SceneDescription* scene) {
      scene->shapes.push_back(EmissiveShape(geometry, to_world, two_sided));
    };
  };
  const auto light = [](decltype(LightDescription::light) description) {
    return [=](SceneDescription* scene) { scene->lights.push_back({{}, description}); };
  };
  TriangleMeshShape triangle = Board();
  triangle.triangles.pop_back();
  BilinearPatchShape patch;
  patch.positions = {
      {-0.5f, -0.5f, 1.4f}, {-0.4f, 0.6f, 1.6f}, {0.5f, -0.5f, 1.7f}, {0.6f, 0.5f, 1.5f}};
  patch.patches = {{0, 1, 2, 3}};
  SpotLightDescription spot;
  spot.position = {0.3, 0.1, 1.5};
  spot.direction = Normalize(Vec3f{0.1f, 0.2f, -1});
  spot.intensity = {3, 2, 1};
  spot.cone_angle = 60;
  spot.falloff_start = 20;
  ProjectionLightDescription projection;
  projection.path = "picture.pfm";
  projection.to_world = kDown;
  GoniometricLightDescription lamp;
  lamp.path = "lamp.ies";
  lamp.to_world = kAbove * Transform::Rotate(100, 1, 0, 0);
  lamp.intensity = {3, 2, 1};
  ImageInfiniteLightDescription image;
  image.path = "sky.pfm";
  image.to_world = Transform::Rotate(20, 1, 2, 3);
  ImageInfiniteLightDescription portal = image;
  portal.portal = {Vec3d{-0.5, -0.4, 1.5}, {-0.5, 0.6, 1.5}, {0.7, 0.6, 1.5}, {0.7, -0.4, 1.5}};
  // Longitudes go around the portal's x axis, so that the edges of pixels are lines of the grid
  // that finds the portal's power.
  ImageInfiniteLightDescription stripes = portal;
  stripes.path = "stripes.pfm";
  stripes.mapping = EnvironmentMapping::kLatLong;
  stripes.to_world = Transform::Rotate(120, 1, 1, 1);
  GoniometricLightDescription pictured = lamp;
  pictured.path = "lamp.pfm";
  ImageInfiniteLightDescription lat_long = image;
  lat_long.path = "latlong.pfm";
  lat_long.mapping = EnvironmentMapping::kLatLong;
  const auto textured = [](SceneDescription* scene) {
    scene->textures = {ImageTexture{.path = "uneven.pfm", .wrap = ImageWrap::kClamp}};
    scene->shapes.push_back(EmissiveShape(Board(), {}, false));
    scene->shapes.back().emission->texture = 0;
  };
  // Half of each circle around the axis is dark; a grid of 16 points finds so.
  const auto chequered = [](ShapeGeometry geometry, const Transform& to_world) {
    return [=](SceneDescription* scene) {
      scene->textures = {ConstantTexture{}, ConstantTexture{{1, 0.8f, 0.2f}},
                         CheckerboardTexture{0, 1, {4, 4}}};
      scene->shapes.push_back(EmissiveShape(geometry, to_world, false));
      scene->shapes.back().emission->texture = 2;
    };
  };
  const Transform egg = kAbove * Transform::Scale(0.3, 0.2, 0.4);
  return {
      {"triangle", shape(triangle, {}, false)},
      {"rectangle", shape(Board(), {}, false)},
      {"rectangle of two sides", shape(Board(), {}, true)},
      {"sphere", shape(SphereShape{0.4f, -0.4f, 0.4f, 360}, kAbove, false)},
      {"sphere of two sides", shape(SphereShape{0.4f, -0.4f, 0.4f, 360}, kAbove, true)},
      {"disk", shape(DiskShape{.radius = 0.5f}, kDown, false)},
      {"cylinder", shape(CylinderShape{0.3f, -0.4f, 0.4f, 250}, kDown, true)},
      // Its area is found by quadrature.
      {"spheroid", shape(SphereShape{1, -1, 1, 360}, egg, false), 1e-4},
      {"bilinear patch", shape(patch, {}, true)},
      {"textured rectangle", textured},
      {"point", light(PointLightDescription{{0.3, 0.1, 1.5}, {3, 2, 1}})},
      {"spot", light(spot)},
      {"projection", light(projection)},
      {"goniometric", light(lamp)},
      {"distant", light(DistantLightDescription{Normalize(Vec3f{0.3f, 0.2f, 1}), {3, 2, 1}})},
      {"constant sky", light(ConstantInfiniteLightDescription{{3, 2, 1}})},
      {"image of a sky", light(image)},
      {"portal to a sky", light(portal)},
      {"portal to a striped sky", light(stripes)},
      {"sky by latitude and longitude", light(lat_long)},
      {"goniometric by an image", light(pictured)},
      {"part of a sphere", shape(SphereShape{0.4f, -0.3f, 0.2f, 250}, kDown, true)},
      {"textured sphere", chequered(SphereShape{0.4f, -0.4f, 0.4f, 360}, kAbove)},
      {"textured cylinder", chequered(CylinderShape{0.3f, -0.4f, 0.4f, 250}, kAside)},
  };
}

}  // namespace strata
