#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/gltf/render_file.h"
#include "worker/math/vec3d.h"

// Normal maps, alpha modes and orthographic cameras of glTF files in closed form, by both kernels.
// Means are tested as tests/transport/test_scene.h says, with its controls.

namespace strata {
namespace {

void WriteImage(const GltfFolder& folder, const std::string& name, int width,
                std::vector<std::string> channels, std::vector<float> values) {
  ImageLayers image;
  image.full_width = width;
  image.full_height = 1;
  image.crop = {0, 0, width, 1};
  image.channels = std::move(channels);
  image.values = std::move(values);
  EXPECT_TRUE(WriteExr(folder.root() / name, image).ok());
}

class GltfSurface : public testing::TestWithParam<KernelKind> {
 protected:
  /// Size pixels high and `aspect` times as wide.
  Partial Show(const GltfFile& file, uint32_t spp, int size = 8, int aspect = 1) {
    folder_.Write("scene.gltf", file.Text());
    JobSpec spec = TestSpec(size, spp, 1);
    spec.width = size * aspect;
    spec.crop = {0, 0, spec.width, size};
    spec.kernel = GetParam();
    return RenderFrame(LoadFile(folder_), spec);
  }
  GltfFolder folder_;
};

// ---- normal maps ----

/// How the unit square of a normal map is given.
struct MappedSquare {
  double scale = 1;
  bool mirrored = false;  ///< The picture lies mirrored on it, u to the left.
  bool tangents = false;  ///< As MikkTSpace makes them of the coordinates.
};

class GltfNormalMap : public GltfSurface {
 protected:
  /// The map's normal, before it is scaled.
  static constexpr Vec3d kMapped = {0.36, 0.48, 0.8};

  /// pi times the radiance under a light from `towards`, of irradiance 1 where it falls straight.
  Partial Lit(const MappedSquare& square, Vec3d towards) {
    const auto channel = [](double n) { return static_cast<float>((n + 1) / 2); };
    WriteImage(folder_, "normals.exr", 1, {"R", "G", "B"},
               {channel(kMapped.x), channel(kMapped.y), channel(kMapped.z)});
    GltfFile file;
    file.Append("images", {{"uri", "normals.exr"}});
    file.Append("textures", {{"source", 0}});
    Json material = WhiteDiffuse();
    material["normalTexture"] = {{"index", 0}, {"scale", square.scale}};
    file.Append("materials", material);
    const int mesh = file.AddSquare({{"material", 0}});
    Json& attributes = file.json["meshes"][mesh]["primitives"][0]["attributes"];
    attributes["NORMAL"] = file.AddFloats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    if (square.mirrored)
      attributes["TEXCOORD_0"] = file.AddFloats({1, 1, 0, 1, 0, 0, 1, 0}, "VEC2");
    if (square.tangents) {
      const float x = square.mirrored ? -1 : 1;
      attributes["TANGENT"] =
          file.AddFloats({x, 0, 0, x, x, 0, 0, x, x, 0, 0, x, x, 0, 0, x}, "VEC4");
    }
    file.AddNode({{"mesh", mesh}});
    AddOrthographicCamera(file, 0.5, 0.5, 0.9, 0.9);
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"intensity", std::numbers::pi}}};
    // The rotation that takes z, against which the light shines, to `towards`.
    const Vec3d axis = Cross(Vec3d{0, 0, 1}, towards);
    const double w = 1 + towards.z, length = std::sqrt(Dot(axis, axis) + w * w);
    file.AddNode({{"rotation", {axis.x / length, axis.y / length, axis.z / length, w / length}},
                  {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return Show(file, 8);
  }
};

/// The picture's right is +u, up is its upper edge: those are the map's x and y.
TEST_P(GltfNormalMap, TurnsTheNormalByItsScale) {
  for (const double scale : {1.0, 0.5, 0.0, -1.0}) {
    for (const bool mirrored : {false, true}) {
      const Vec3d n =
          Normalize(Vec3d{(mirrored ? -1 : 1) * scale * kMapped.x, scale * kMapped.y, kMapped.z});
      for (const Vec3d towards : {Vec3d{0, 0, 1}, Vec3d{0.6, 0, 0.8}, Vec3d{0, 0.6, 0.8}}) {
        SCOPED_TRACE(testing::Message() << "scale " << scale << (mirrored ? ", mirrored" : ""));
        const MappedSquare square{.scale = scale, .mirrored = mirrored};
        ExpectMean(Lit(square, towards), Dot(n, towards));
      }
    }
  }
}

TEST_P(GltfNormalMap, IsTheSameWithTheTangentsThatItsCoordinatesGive) {
  for (const bool mirrored : {false, true}) {
    const Partial without = Lit({.mirrored = mirrored}, {0.6, 0, 0.8});
    const Partial with = Lit({.mirrored = mirrored, .tangents = true}, {0.6, 0, 0.8});
    EXPECT_EQ(without.values, with.values);
    EXPECT_NE(without.values, Lit({.mirrored = !mirrored}, {0.6, 0, 0.8}).values) << "control";
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, GltfNormalMap,
                         testing::Values(KernelKind::kFast, KernelKind::kReference));

// ---- alpha modes ----

class GltfAlpha : public GltfSurface {
 protected:
  /// The unit square seen alone before an environment of radiance 1. It emits no green, so that
  /// green is what passes it. Its left half has alpha 0.4, the right 0.6.
  Partial Passed(Json alpha_mode) {
    WriteImage(folder_, "alpha.exr", 2, {"R", "G", "B", "A"}, {1, 0, 1, 0.4f, 1, 0, 1, 0.6f});
    GltfFile file;
    file.Append("images", {{"uri", "alpha.exr"}});
    file.Append("samplers", {{"magFilter", 9728}});
    file.Append("textures", {{"source", 0}, {"sampler", 0}});
    Json material = Unlit({1, 1, 1, 0.75});
    material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    material.update(alpha_mode);
    file.Append("materials", material);
    file.AddNode({{"mesh", file.AddSquare({{"material", 0}})}});
    AddOrthographicCamera(file, 0.5, 0.5, 1, 1);
    return Show(file, 1024, 16);
  }
};

TEST_P(GltfAlpha, OpaqueIgnoresIt) {
  EXPECT_EQ(FrameMean(Passed(Json::object()), 1).mean, 0);
  EXPECT_EQ(FrameMean(Passed({{"alphaMode", "OPAQUE"}}), 1).mean, 0);
}

/// The factor counts as well: 0.3 and 0.45 are compared with the cutoff, which is 0.5 by itself.
TEST_P(GltfAlpha, MaskIsThereFromTheCutoffOn) {
  for (const auto& [cutoff, passed] :
       {std::pair(0.29, 0.0), std::pair(0.31, 0.5), std::pair(0.44, 0.5), std::pair(0.46, 1.0)})
    EXPECT_EQ(FrameMean(Passed({{"alphaMode", "MASK"}, {"alphaCutoff", cutoff}}), 1).mean, passed)
        << cutoff;
  EXPECT_EQ(FrameMean(Passed({{"alphaMode", "MASK"}}), 1).mean, 1);
}

TEST_P(GltfAlpha, CutoffsAboveOneLeaveNothing) {
  for (const auto& [cutoff, passed] : {std::pair(1.0, 0.0), std::pair(1.5, 1.0)}) {
    GltfFile file;
    Json material = Unlit({1, 0, 1, 1});
    material.update({{"alphaMode", "MASK"}, {"alphaCutoff", cutoff}});
    file.Append("materials", material);
    file.AddNode({{"mesh", file.AddSquare({{"material", 0}})}});
    AddOrthographicCamera(file, 0.5, 0.5, 1, 1);
    EXPECT_EQ(FrameMean(Show(file, 64, 16), 1).mean, passed) << cutoff;
  }
}

TEST_P(GltfAlpha, BlendIsThereAsOftenAsAlphaSays) {
  ExpectMean(Passed({{"alphaMode", "BLEND"}}), 1 - 0.75 * (0.4 + 0.6) / 2);
}

INSTANTIATE_TEST_SUITE_P(Kernels, GltfAlpha,
                         testing::Values(KernelKind::kFast, KernelKind::kReference));

// ---- bodies ----

class GltfBody : public GltfSurface {};

/// Both faces of a body of index 1 and thickness 2, whose light falls to a quarter over a distance
/// of 4, before an environment of radiance 1.
TEST_P(GltfBody, AbsorbsByTheWayOfLightWithin) {
  GltfFile file;
  file.Append("materials",
              {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
               {"extensions",
                {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                 {"KHR_materials_ior", {{"ior", 1}}},
                 {"KHR_materials_volume",
                  {{"thicknessFactor", 2},
                   {"attenuationColor", {1, 0.25, 1}},
                   {"attenuationDistance", 4}}}}}});
  const int face = file.AddSquare({{"material", 0}});
  file.AddNode({{"mesh", face}});
  // Turned about its lower edge to face the other way.
  file.AddNode({{"mesh", face}, {"rotation", {0, 1, 0, 0}}, {"translation", {1, 0, -2}}});
  AddOrthographicCamera(file, 0.5, 0.5, 0.4, 0.4);
  folder_.Write("scene.gltf", file.Text());
  JobSpec spec = TestSpec(8, 64, 4);
  spec.kernel = GetParam();
  ExpectMean(RenderFrame(LoadFile(folder_), spec), 0.5);
}

INSTANTIATE_TEST_SUITE_P(Kernels, GltfBody,
                         testing::Values(KernelKind::kFast, KernelKind::kReference));

// ---- cameras ----

class GltfOrthographic : public GltfSurface {};

/// A square of 0.8 by 0.5 in a window of 3 by 1.5, wherever it stands along the view.
TEST_P(GltfOrthographic, SeesASquareOfOneSizeAtAnyDistance) {
  for (const double z : {8.0, 0.0, -1000.0}) {
    GltfFile file;
    file.Append("materials", Unlit({1, 1, 1, 1}));
    file.AddNode({{"mesh", file.AddSquare({{"material", 0}})},
                  {"translation", {-0.3, -0.4, z}},
                  {"scale", {0.8, 0.5, 1}}});
    AddOrthographicCamera(file, 0.1, 0.05, 3, 1.5);
    // Beside the square there is nothing, but for a lamp's sake: no environment.
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.AddNode({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    ExpectMean(Show(file, 512, 32, 2), 0.8 * 0.5 / (3 * 1.5));
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, GltfOrthographic,
                         testing::Values(KernelKind::kFast, KernelKind::kReference));

}  // namespace
}  // namespace strata
