#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/image_file.h"
#include "tests/gltf/render_file.h"
#include "worker/integrator/render.h"
#include "worker/scene/scene.h"

// What is seen of a glTF file: textures the right way round, lights of the right strength.

namespace strata {
namespace {

/// The means of the pixels, row-major.
std::vector<Rgb> Render(const GltfFolder& folder, int size, KernelKind kernel, uint32_t spp = 64,
                        int depth = 1, const SceneOptions& options = {}) {
  const auto scene = LoadScene(DirectorySource(folder.root()), "scene.gltf", {}, options);
  EXPECT_TRUE(scene.ok()) << scene.status();
  if (!scene.ok()) return std::vector<Rgb>(static_cast<size_t>(size) * size);
  JobSpec spec;
  spec.bundle.scene = "scene.gltf";
  spec.bundle.files = {{"scene.gltf", DigestOf("test"), 4}};
  spec.width = spec.height = size;
  spec.crop = {0, 0, size, size};
  spec.spp = spp;
  spec.max_depth = depth;
  spec.kernel = kernel;
  const auto renderer = Renderer::Create(*scene, spec);
  EXPECT_TRUE(renderer.ok()) << renderer.status();
  RenderPool pool(2);
  const auto partial = (*renderer)->Render({{}, spec.crop, {{0, spp / kReplicates}}}, pool);
  EXPECT_TRUE(partial.ok()) << partial.status();
  std::vector<Rgb> pixels;
  for (int64_t p = 0; p < spec.crop.Pixels(); ++p) {
    const double* values = &partial->values[p * partial->layout.Doubles()];
    Rgb mean;
    for (int r = 0; r < kReplicates; ++r) {
      mean += Rgb{static_cast<float>(values[partial->layout.Mean(r, 0)]),
                  static_cast<float>(values[partial->layout.Mean(r, 1)]),
                  static_cast<float>(values[partial->layout.Mean(r, 2)])};
    }
    pixels.push_back(mean * (1.0f / kReplicates));
  }
  return pixels;
}

void ExpectColor(Rgb seen, Rgb expected, const std::string& what) {
  EXPECT_NEAR(seen.r, expected.r, 1e-4) << what;
  EXPECT_NEAR(seen.g, expected.g, 1e-4) << what;
  EXPECT_NEAR(seen.b, expected.b, 1e-4) << what;
}

/// A camera from which the unit square fills the picture.
void AddCamera(GltfFile& file) {
  file.Append(
      "cameras",
      {{"type", "perspective"},
       {"perspective", {{"yfov", 2 * std::atan(0.5 / 10)}, {"znear", 0.1}, {"aspectRatio", 1}}}});
  file.AddNode({{"camera", 0}, {"translation", {0.5, 0.5, 10}}});
}

/// One that shines along -z.
void AddSun(GltfFile& file, double lux) {
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"intensity", lux}}};
  file.AddNode({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
}

constexpr Rgb kRed = {1, 0, 0}, kGreen = {0, 1, 0}, kBlue = {0, 0, 1}, kWhite = {1, 1, 1};

/// An unlit square with red and green above blue and white.
class GltfPicture : public testing::TestWithParam<KernelKind> {
 protected:
  GltfPicture() {
    ImageLayers image;
    image.full_width = image.full_height = 2;
    image.crop = {0, 0, 2, 2};
    image.channels = {"R", "G", "B"};
    image.values = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    EXPECT_TRUE(WriteExr(folder_.root() / "four colours.exr", image).ok());
  }

  std::vector<Rgb> Show(const Json& transform, const Json& sampler = {{"magFilter", 9728}}) {
    GltfFile file;
    file.Append("images", {{"uri", "four%20colours.exr"}});
    file.Append("samplers", sampler);
    file.Append("textures", {{"source", 0}, {"sampler", 0}});
    Json reference = {{"index", 0}};
    if (!transform.empty()) reference["extensions"] = {{"KHR_texture_transform", transform}};
    file.Append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", reference}}},
                              {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
    file.AddNode({{"mesh", file.AddSquare({{"material", 0}})}});
    AddCamera(file);
    folder_.Write("scene.gltf", file.Text());
    return Render(folder_, 4, GetParam());
  }
  /// The quarters, seen in pixels that touch no border: upper left, upper right, lower left, lower
  /// right.
  void ExpectQuarters(const std::vector<Rgb>& pixels, std::array<Rgb, 4> quarters,
                      const std::string& what) {
    ExpectColor(pixels[0], quarters[0], what + ", upper left");
    ExpectColor(pixels[3], quarters[1], what + ", upper right");
    ExpectColor(pixels[12], quarters[2], what + ", lower left");
    ExpectColor(pixels[15], quarters[3], what + ", lower right");
  }

  GltfFolder folder_;
};

TEST_P(GltfPicture, StandsUprightAndIsNotMirrored) {
  ExpectQuarters(Show(Json::object()), {kRed, kGreen, kBlue, kWhite}, "as it is");
}

TEST_P(GltfPicture, MovesByTheTransform) {
  ExpectQuarters(Show({{"offset", {0.5, 0}}}), {kGreen, kRed, kWhite, kBlue}, "offset in u");
  ExpectQuarters(Show({{"offset", {0, 0.5}}}), {kBlue, kWhite, kRed, kGreen}, "offset in v");
  ExpectQuarters(Show({{"scale", {-1, 1}}, {"offset", {1, 0}}}), {kGreen, kRed, kWhite, kBlue},
                 "mirrored");
  // u' = v, v' = -u: along the picture's lower edge u grows, so v' falls from 0, which repeats.
  ExpectQuarters(Show({{"rotation", std::numbers::pi / 2}}), {kBlue, kRed, kWhite, kGreen},
                 "a quarter turn");
  ExpectQuarters(Show({{"rotation", std::numbers::pi / 2}, {"scale", {1, 0.001}}}),
                 {kBlue, kRed, kBlue, kRed}, "scaled before it is turned");
}

TEST_P(GltfPicture, WrapsAlongEachAxisAsTheSamplerSays) {
  const Json away = {{"offset", {1, 0}}};
  ExpectQuarters(Show(away, {{"magFilter", 9728}, {"wrapS", 33071}}),
                 {kGreen, kGreen, kWhite, kWhite}, "clamped");
  ExpectQuarters(Show(away, {{"magFilter", 9728}, {"wrapS", 33648}}), {kGreen, kRed, kWhite, kBlue},
                 "mirrored");
  ExpectQuarters(Show({{"offset", {0, -1}}}, {{"magFilter", 9728}, {"wrapT", 33648}}),
                 {kBlue, kWhite, kRed, kGreen}, "mirrored along v");
}

/// Over each triangle colours are linear, so seen in a pixel's middle they are known.
TEST_P(GltfPicture, ColoursOfVerticesAreInterpolated) {
  GltfFile file;
  const int colors = file.AddFloats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0.25, 0.75}, "VEC3");
  file.Append("materials", {{"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  file.AddNode(
      {{"mesh", file.AddSquare({{"material", 0}, {"attributes", {{"COLOR_0", colors}}}})}});
  AddCamera(file);
  folder_.Write("scene.gltf", file.Text());
  const std::vector<Rgb> pixels = Render(folder_, 4, GetParam(), 1024);
  // Pixel (2, 3) lies in the lower right triangle 0 1 2 around x = 0.625, y = 0.125.
  const Rgb low = kRed * (1 - 0.625f) + kGreen * (0.625f - 0.125f) + kBlue * 0.125f;
  // Pixel (1, 0) lies in 0 2 3 around x = 0.375, y = 0.875.
  const Rgb high =
      kRed * (1 - 0.875f) + kBlue * 0.375f + Rgb{0.5f, 0.25f, 0.75f} * (0.875f - 0.375f);
  for (const auto& [seen, expected] : {std::pair(pixels[14], low), std::pair(pixels[1], high)}) {
    EXPECT_NEAR(seen.r, expected.r, 2e-3);
    EXPECT_NEAR(seen.g, expected.g, 2e-3);
    EXPECT_NEAR(seen.b, expected.b, 2e-3);
  }
}

/// The picture by one set of coordinates, what multiplies it by another or by its vertices.
TEST_P(GltfPicture, LiesByItsOwnSetOfCoordinates) {
  for (const bool emissive : {false, true}) {
    GltfFile file;
    file.Append("images", {{"uri", "four%20colours.exr"}});
    file.Append("samplers", {{"magFilter", 9728}});
    file.Append("textures", {{"source", 0}, {"sampler", 0}});
    const Json first = {{"index", 0}}, second = {{"index", 0}, {"texCoord", 1}};
    Json material = WhiteDiffuse();
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = first;
    if (emissive) {
      material["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
      material["emissiveFactor"] = {1, 1, 1};
      material["emissiveTexture"] = second;
    } else {
      material["pbrMetallicRoughness"]["baseColorTexture"] = second;
    }
    file.Append("materials", material);
    const int mesh = file.AddSquare({{"material", 0}});
    // Mirrored: u from the right.
    file.json["meshes"][mesh]["primitives"][0]["attributes"]["TEXCOORD_1"] =
        file.AddFloats({1, 1, 0, 1, 0, 0, 1, 0}, "VEC2");
    file.AddNode({{"mesh", mesh}});
    AddCamera(file);
    if (!emissive) AddSun(file, std::numbers::pi);
    folder_.Write("scene.gltf", file.Text());
    ExpectQuarters(Render(folder_, 4, GetParam()), {kGreen, kRed, kWhite, kBlue},
                   emissive ? "emissive" : "base colour");
  }
}

TEST_P(GltfPicture, IsMultipliedByTheColoursOfItsVertices) {
  GltfFile file;
  file.Append("images", {{"uri", "four%20colours.exr"}});
  file.Append("samplers", {{"magFilter", 9728}});
  file.Append("textures", {{"source", 0}, {"sampler", 0}});
  Json material = WhiteDiffuse();
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  file.Append("materials", material);
  // From half of it at the left to nothing at the right.
  const int colors = file.AddFloats({0.5, 0.5, 0.5, 0, 0, 0, 0, 0, 0, 0.5, 0.5, 0.5}, "VEC3");
  file.AddNode(
      {{"mesh", file.AddSquare({{"material", 0}, {"attributes", {{"COLOR_0", colors}}}})}});
  AddCamera(file);
  AddSun(file, std::numbers::pi);
  folder_.Write("scene.gltf", file.Text());
  const std::vector<Rgb> pixels = Render(folder_, 4, GetParam(), 4096);
  // A pixel's mean over its 4096 points of a net errs by less than a column of 1/64 of its width.
  const float slack = 0.5f / 4 / 64;
  for (const auto& [pixel, color] :
       {std::pair(0, kRed), std::pair(3, kGreen), std::pair(13, kBlue), std::pair(14, kWhite)}) {
    const Rgb expected = color * (0.5f * (1 - (static_cast<float>(pixel % 4) + 0.5f) / 4));
    EXPECT_NEAR(pixels[pixel].r, expected.r, slack) << pixel;
    EXPECT_NEAR(pixels[pixel].g, expected.g, slack) << pixel;
    EXPECT_NEAR(pixels[pixel].b, expected.b, slack) << pixel;
  }
}

/// One that is white above and black below, by latitude and longitude: up in glTF's world is y.
TEST_P(GltfPicture, EnvironmentsStandUprightAndAreNotMirrored) {
  GltfFile file;
  file.AddNode({{"mesh", file.AddSquare()}, {"translation", {0, 0, 100}}});
  file.Append("cameras", {{"type", "perspective"},
                          {"perspective", {{"yfov", 1.2}, {"znear", 0.1}, {"aspectRatio", 1}}}});
  file.AddNode({{"camera", 0}});
  folder_.Write("scene.gltf", file.Text());
  ImageLayers sky;
  sky.full_width = 8;
  sky.full_height = 4;
  sky.crop = {0, 0, 8, 4};
  sky.channels = {"R", "G", "B"};
  // Left half red, right half green, the lower rows with blue.
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (const float value : {x < 4 ? 1.0f : 0.0f, x < 4 ? 0.0f : 1.0f, y < 2 ? 0.0f : 1.0f})
        sky.values.push_back(value);
    }
  }
  ASSERT_TRUE(WriteExr(folder_.root() / "sky.exr", sky).ok());
  ExpectQuarters(Render(folder_, 4, GetParam(), 64, 1, {.environment = "sky.exr"}),
                 {kRed, kGreen, Rgb{1, 0, 1}, Rgb{0, 1, 1}}, "sky");
}

INSTANTIATE_TEST_SUITE_P(Kernels, GltfPicture,
                         testing::Values(KernelKind::kFast, KernelKind::kReference));

/// A white diffuse square, which returns E / pi of its irradiance E.
class GltfIrradiance : public testing::TestWithParam<KernelKind> {
 protected:
  Rgb Measure(const Json& light, const Json& node) {
    GltfFile file;
    file.Append("materials", WhiteDiffuse());
    file.AddNode({{"mesh", file.AddSquare({{"material", 0}})},
                  {"translation", {-0.5, -0.5, 0}},
                  {"scale", {1, 1, 1}}});
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    Json lit = node;
    lit["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
    file.AddNode(lit);
    // Sees the middle alone.
    file.Append("cameras", {{"type", "perspective"},
                            {"perspective", {{"yfov", 1e-5}, {"znear", 0.1}, {"aspectRatio", 1}}}});
    file.AddNode({{"camera", 0}, {"translation", {0, 0, 10}}});
    GltfFolder folder;
    folder.Write("scene.gltf", file.Text());
    return Render(folder, 8, GetParam())[27] * static_cast<float>(std::numbers::pi);
  }
};

TEST_P(GltfIrradiance, OfALuxIsOne) {
  const double half = std::sqrt(0.5), quarter = std::numbers::pi / 8;
  EXPECT_NEAR(Measure({{"type", "directional"}, {"intensity", 5}}, Json::object()).g, 5, 1e-4);
  // Turned by 45 degrees.
  EXPECT_NEAR(Measure({{"type", "directional"}, {"intensity", 5}},
                      {{"rotation", {std::sin(quarter), 0, 0, std::cos(quarter)}}})
                  .g,
              5 * half, 1e-4);
}

TEST_P(GltfIrradiance, OfACandelaFallsByTheSquareOfTheDistance) {
  EXPECT_NEAR(Measure({{"type", "point"}, {"intensity", 9}}, {{"translation", {0, 0, 3}}}).g, 1,
              1e-4);
  EXPECT_NEAR(Measure({{"type", "point"}, {"intensity", 9}}, {{"translation", {3, 0, 3}}}).g,
              9.0 / 18 * std::sqrt(0.5), 1e-4);
}

/// Of a spot 3 above the square, whose axis is turned away by `degrees` about y.
class GltfSpot : public GltfIrradiance {
 protected:
  float Turned(double degrees, const Json& cones) {
    const double half = degrees * std::numbers::pi / 360;
    return Measure({{"type", "spot"}, {"intensity", 9}, {"spot", cones}},
                   {{"translation", {0, 0, 3}},
                    {"scale", {2, 2, 2}},
                    {"rotation", {0, std::sin(half), 0, std::cos(half)}}})
        .g;
  }
};

TEST_P(GltfSpot, IsWholeInItsInnerConeAndEndsAtItsOuterOne) {
  const Json cones = {{"innerConeAngle", std::numbers::pi / 9}, {"outerConeAngle", 0.5235987756}};
  for (const double degrees : {0.0, 19.9, -19.9}) EXPECT_NEAR(Turned(degrees, cones), 1, 1e-4);
  for (const double degrees : {30.1, -30.1, 90.0, 180.0}) EXPECT_EQ(Turned(degrees, cones), 0);
  // Between them a smooth step of the cosine, as PBRT 12.2.1 has it.
  const auto cosine = [](double degrees) { return std::cos(degrees * std::numbers::pi / 180); };
  const double t = (cosine(26) - cosine(30)) / (cosine(20) - cosine(30));
  EXPECT_NEAR(Turned(26, cones), t * t * (3 - 2 * t), 1e-4);
}

/// An inner cone of 0 and an outer one of 45 degrees.
TEST_P(GltfSpot, HasTheDefaultsOfTheExtension) {
  EXPECT_NEAR(Turned(0, Json::object()), 1, 1e-4);
  const double outer = std::sqrt(0.5), at = std::cos(std::numbers::pi / 6);
  const double t = (at - outer) / (1 - outer);
  EXPECT_NEAR(Turned(30, Json::object()), t * t * (3 - 2 * t), 1e-4);
  EXPECT_EQ(Turned(45.1, Json::object()), 0);
}

INSTANTIATE_TEST_SUITE_P(Kernels, GltfSpot,
                         testing::Values(KernelKind::kFast, KernelKind::kReference));

INSTANTIATE_TEST_SUITE_P(Kernels, GltfIrradiance,
                         testing::Values(KernelKind::kFast, KernelKind::kReference));

}  // namespace
}  // namespace strata
