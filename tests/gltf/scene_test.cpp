#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/gltf/gltf_file.h"
#include "worker/integrator/camera.h"
#include "worker/math/vec3d.h"

// Nodes, instances, cameras and lights.

namespace strata {
namespace {

void ExpectNear(Vec3d a, Vec3d b) {
  EXPECT_LT(Length(a - b), 1e-6) << a.x << " " << a.y << " " << a.z;
}

absl::StatusOr<SceneFile> ReadNodes(GltfFile& file, const SceneOptions& options = {}) {
  return file.Read(options);
}

TEST(GltfNodes, TransformsMultiplyDownTheHierarchy) {
  GltfFile file;
  const double half = std::sqrt(0.5);
  // A quarter turn about z, then twice as large, then moved; below it a matrix that moves along x.
  const int child = file.Append(
      "nodes",
      {{"mesh", file.AddSquare()}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1}}});
  file.AddNode({{"translation", {10, 0, 0}},
                {"rotation", {0, 0, half, half}},
                {"scale", {2, 2, 2}},
                {"children", {child}}});
  const auto read = ReadNodes(file);
  ASSERT_TRUE(read.ok()) << read.status();
  ExpectNear(read->scene.shapes.at(0).to_world.Point({1, 0, 0}), {10, 8, 0});
}

TEST(GltfNodes, AMeshOfSeveralNodesIsAnObject) {
  GltfFile file;
  const int mesh = file.AddSquare();
  file.AddNode({{"mesh", mesh}});
  file.AddNode({{"mesh", mesh}, {"scale", {-1, 1, 1}}});
  file.AddNode({{"mesh", mesh}, {"scale", {1, 0, 1}}});
  const auto read = ReadNodes(file);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->scene.shapes.empty());
  ASSERT_EQ(read->scene.objects.size(), 1u);
  ASSERT_EQ(read->scene.instances.size(), 2u);
  EXPECT_TRUE(read->scene.instances[1].to_world.SwapsHandedness());
  EXPECT_TRUE(Warns(*read, "nodes[2]", "singular"));
}

TEST(GltfNodes, InstancesOfAnAttribute) {
  GltfFile file;
  const int translations = file.AddFloats({0, 0, 0, 5, 0, 0, 0, 6, 0}, "VEC3");
  file.AddNode(
      {{"mesh", file.AddSquare()},
       {"translation", {0, 0, 1}},
       {"extensions",
        {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translations}}}}}}}});
  const auto read = ReadNodes(file);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->scene.instances.size(), 3u);
  ExpectNear(read->scene.instances[2].to_world.Point({0, 0, 0}), {0, 6, 1});
}

TEST(GltfNodes, LoopsAndSecondParentsAreRefused) {
  GltfFile loop;
  const int node = loop.AddNode({{"children", {0}}});
  ASSERT_EQ(node, 0);
  EXPECT_NE(std::string(ReadNodes(loop).status().message()).find("scene.gltf:nodes[0]: "),
            std::string::npos);
  GltfFile twice;
  const int shared = twice.Append("nodes", Json::object());
  twice.AddNode({{"children", {shared}}});
  twice.AddNode({{"children", {shared}}});
  EXPECT_FALSE(ReadNodes(twice).ok());
}

TEST(GltfCamera, LooksAlongMinusZWithXToTheRight) {
  GltfFile file;
  file.Append("cameras", {{"type", "perspective"},
                          {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 2}}}});
  file.AddNode({{"camera", 0}, {"translation", {0, 1, 5}}, {"scale", {3, 3, 3}}});
  const auto read = ReadNodes(file);
  ASSERT_TRUE(read.ok()) << read.status();
  const CameraDescription& camera = read->scene.camera;
  ExpectNear(camera.camera_to_world.Point({0, 0, 0}), {0, 1, 5});
  ExpectNear(camera.camera_to_world.Vector({0, 0, 1}), {0, 0, -1});
  ExpectNear(camera.camera_to_world.Vector({1, 0, 0}), {1, 0, 0});
  EXPECT_NEAR(camera.fov, 0.5 * 180 / std::numbers::pi, 1e-4);
  EXPECT_EQ(read->scene.defaults.width, 1440);
  EXPECT_EQ(read->scene.defaults.height, 720);
  // The angle is that of the height in frames of any shape.
  for (const int width : {1440, 720, 300}) {
    const Camera frame = *Camera::Create(camera, width, 720);
    const Vec3f top = frame.GenerateRay({static_cast<float>(width) / 2, 0}, {}).direction;
    EXPECT_NEAR(std::atan2(top.y, -top.z), 0.25, 1e-5) << width;
  }
}

TEST(GltfCamera, OrthographicOnesShowTwiceTheirMagnifications) {
  GltfFile file;
  file.Append("cameras",
              {{"type", "orthographic"},
               {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 10}}}});
  file.AddNode({{"camera", 0}, {"translation", {0, 1, 5}}, {"scale", {7, 7, 7}}});
  const auto read = ReadNodes(file);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->scene.defaults.width, 1440);
  const CameraDescription& description = read->scene.camera;
  EXPECT_EQ(description.kind, CameraKind::kOrthographic);
  EXPECT_FALSE(Warns(*read, "cameras", ""));
  const Camera camera = *Camera::Create(description, 1440, 720);
  const auto at = [&](float x, float y) { return ToDouble(camera.GenerateRay({x, y}, {}).origin); };
  ExpectNear(at(0, 0), {-2, 2, 5});
  ExpectNear(at(1440, 720), {2, 0, 5});
  ExpectNear(ToDouble(camera.GenerateRay({0, 0}, {}).direction), {0, 0, -1});
  EXPECT_FLOAT_EQ(camera.Depth({1, 1, 1}), 4);
}

TEST(GltfCamera, IsChosenByNameIndexOrNumbers) {
  GltfFile file;
  for (const char* name : {"near", "far"}) {
    file.Append("cameras", {{"type", "perspective"},
                            {"name", name},
                            {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  }
  file.AddNode({{"camera", 0}, {"translation", {0, 0, 1}}});
  file.AddNode({{"camera", 1}, {"translation", {0, 0, 9}}, {"name", "overview"}});
  for (const auto& [wanted, z] : std::vector<std::pair<std::string, double>>{
           {"", 1}, {"far", 9}, {"overview", 9}, {"1", 9}, {"0", 1}, {"1,2,3,0,0,0", 3}}) {
    const auto read = ReadNodes(file, {.camera = wanted});
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(read->scene.camera.camera_to_world.Point({0, 0, 0}).z, z) << wanted;
  }
  EXPECT_NE(
      std::string(ReadNodes(file, {.camera = "middle"}).status().message()).find("\"middle\""),
      std::string::npos);
}

TEST(GltfDefaults, ACameraThatSeesAllAndALight) {
  GltfFile file;
  file.AddNode({{"mesh", file.AddSquare()}, {"scale", {10, 20, 1}}});
  const auto read = ReadNodes(file);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(Warns(*read, "cameras", "--camera"));
  EXPECT_TRUE(Warns(*read, "", "--env"));
  ASSERT_EQ(read->scene.lights.size(), 1u);
  const CameraDescription& camera = read->scene.camera;
  const auto to_camera = camera.camera_to_world.Inverse();
  ASSERT_TRUE(to_camera);
  const double reach = std::tan(camera.fov * std::numbers::pi / 360);
  double most = 0;
  for (const Vec3d corner : {Vec3d{0, 0, 0}, Vec3d{10, 0, 0}, Vec3d{0, 20, 0}, Vec3d{10, 20, 0}}) {
    const Vec3d p = to_camera->Point(corner);
    EXPECT_GT(p.z, 0);
    most = std::max({most, std::abs(p.x / p.z), std::abs(p.y / p.z)});
  }
  EXPECT_LT(most, reach);
  EXPECT_GT(most, 0.5 * reach) << "the scene fills the picture";
  // The world's right is the picture's right, and up is up.
  EXPECT_GT(to_camera->Vector({1, 0, 0}).x, 0);
  EXPECT_GT(to_camera->Vector({0, 1, 0}).y, 0);
}

TEST(GltfDefaults, AFileWithoutSurfacesSaysSo) {
  for (const Json& json : {Json{{"asset", {{"version", "2.0"}}}},
                           Json{{"asset", {{"version", "2.0"}}}, {"scenes", {Json::object()}}}}) {
    GltfFile file;
    file.json = json;
    const auto read = ReadNodes(file);
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_TRUE(Warns(*read, "scene", "nothing is seen"));
  }
}

TEST(GltfLights, HaveTheirUnitsAndDirections) {
  GltfFile file;
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"intensity", 3}, {"color", {1, 0.5, 0}}},
      {{"type", "point"}, {"intensity", 7}},
      {{"type", "sunbeam"}}};
  const auto light = [&](int index, const Json& more) {
    Json node = more;
    node["extensions"] = {{"KHR_lights_punctual", {{"light", index}}}};
    return file.AddNode(node);
  };
  const double half = std::sqrt(0.5);
  light(0, {{"rotation", {-half, 0, 0, half}}});  // -z turned to -y.
  light(1, {{"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}});
  const auto read = ReadNodes(file);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->scene.lights.size(), 2u);
  const auto& distant = std::get<DistantLightDescription>(read->scene.lights[0].light);
  EXPECT_EQ(distant.irradiance, (Rgb{3, 1.5f, 0}));
  EXPECT_NEAR(distant.direction.y, 1, 1e-6);
  const auto& point = std::get<PointLightDescription>(read->scene.lights[1].light);
  EXPECT_EQ(point.intensity, (Rgb{7, 7, 7}));
  EXPECT_EQ(point.position, (Vec3d{1, 2, 3}));
  light(2, Json::object());
  EXPECT_NE(std::string(ReadNodes(file).status().message()).find("lights[2].type"),
            std::string::npos);
}

}  // namespace
}  // namespace strata
