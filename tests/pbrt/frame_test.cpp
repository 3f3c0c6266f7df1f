#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/pbrt/parsed_scene.h"

// What a sound file says of frame and camera is what the scene holds; pbrt-v4's defaults where it
// says nothing.

namespace strata {
namespace {

TEST(EmptyWorld, HasPbrtsDefaults) {
  const PbrtScene scene = World("");
  const FrameDefaults& frame = scene.scene.defaults;
  EXPECT_EQ(frame.width, 1280);
  EXPECT_EQ(frame.height, 720);
  EXPECT_EQ(frame.max_depth, 5);
  EXPECT_EQ(frame.spp, 16u);
  EXPECT_EQ(frame.filter, DefaultFilter(FilterKind::kGaussian));
  EXPECT_FALSE(frame.crop.has_value());
  EXPECT_EQ(scene.scene.camera.fov, 90);
  EXPECT_EQ(scene.scene.camera.camera_to_world, Transform());
  ASSERT_EQ(scene.scene.materials.size(), 1u);
  EXPECT_EQ(Constant(scene, MaterialOf<DiffuseMaterial>(scene, 0).reflectance), Rgb::Gray(0.5f));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Frame, IsReadWithAllItsParameters) {
  const PbrtScene scene = Read(R"(
    Film "rgb" "integer xresolution" 100 "integer yresolution" [ 50 ]
      "float cropwindow" [ 0.25 0.751 0 1 ]
    PixelFilter "mitchell" "float xradius" 3 "float B" 0.5
    Sampler "independent" "integer pixelsamples" 40
    Integrator "volpath" "integer maxdepth" 9
    Camera "perspective" "float fov" 30 "float lensradius" 0.1 "float focaldistance" 7
      "float frameaspectratio" 2 "float screenwindow" [ -2 2 -1 1 ]
    WorldBegin)");
  const FrameDefaults& frame = scene.scene.defaults;
  EXPECT_EQ(frame.width, 100);
  EXPECT_EQ(frame.height, 50);
  EXPECT_EQ(frame.crop, (PixelRect{25, 0, 76, 50}));  // pbrt rounds both up
  EXPECT_EQ(frame.filter.kind, FilterKind::kMitchell);
  EXPECT_EQ(frame.filter.radius_x, 3);
  EXPECT_EQ(frame.filter.radius_y, 2);
  EXPECT_EQ(frame.filter.b, 0.5);
  EXPECT_EQ(frame.sampler, SamplerKind::kIndependent);
  EXPECT_EQ(frame.spp, 40u);
  EXPECT_EQ(frame.max_depth, 9);
  EXPECT_EQ(scene.scene.camera.fov, 30);
  EXPECT_FLOAT_EQ(scene.scene.camera.lens_radius, 0.1f);
  EXPECT_EQ(scene.scene.camera.focal_distance, 7);
  EXPECT_EQ(scene.scene.camera.frame_aspect, 2);
  EXPECT_EQ(scene.scene.camera.screen_window, (std::array<float, 4>{-2, 2, -1, 1}));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Frame, OfUnknownPartsWarns) {
  const PbrtScene scene = Read(R"(
    Sampler "pmj02bn"
    Integrator "bdpt" "bool whatever" true
    PixelFilter "sinc" "float tau" 3
    Film "gbuffer" "float iso" 200
    Option "disablepixeljitter" true
    Option "rendercoordsys" "world" Option "seed" [ 5 ] Option "bool disablepixeljitter" false
    WorldBegin)");
  ASSERT_EQ(scene.warnings.size(), 6u);
  EXPECT_EQ(scene.warnings[0].where.ToString(), "scene.pbrt:2");
  EXPECT_NE(scene.warnings[0].text.find("pmj02bn"), std::string::npos);
}

TEST(Frame, HasTheSamplerOfItsName) {
  const std::pair<const char*, SamplerKind> samplers[] = {
      {"\"halton\"", SamplerKind::kHalton},
      {"\"halton\" \"string randomization\" \"owen\"", SamplerKind::kHalton},
      {"\"halton\" \"string randomization\" \"none\"", SamplerKind::kHaltonPlain},
      {"\"halton_plain\"", SamplerKind::kHaltonPlain},
      {"\"stratified\" \"integer xsamples\" 8", SamplerKind::kStratified},
      {"\"latin_hypercube\"", SamplerKind::kLatinHypercube},
      {"\"poisson_disk\"", SamplerKind::kPoissonDisk},
      {"\"drand48\"", SamplerKind::kDrand48},
  };
  for (const auto& [text, kind] : samplers) {
    const PbrtScene scene = Read(std::string("Sampler ") + text + " WorldBegin");
    EXPECT_EQ(scene.scene.defaults.sampler, kind) << text;
    EXPECT_TRUE(scene.warnings.empty()) << text;
  }
  EXPECT_EQ(Read("Sampler \"stratified\" \"bool jitter\" false WorldBegin").warnings.size(), 1u);
}

TEST(Frame, OfOtherRandomizationsWarns) {
  for (const char* known : {"none", "permutedigits"}) {
    const PbrtScene scene = Read(std::string("Sampler \"sobol\" \"string randomization\" \"") +
                                 known + "\" WorldBegin");
    EXPECT_EQ(scene.warnings.size(), 1u) << known;
  }
  EXPECT_TRUE(
      Read("Sampler \"sobol\" \"string randomization\" \"owen\" WorldBegin").warnings.empty());
}

TEST(Camera, LooksWhereLookAtSays) {
  const PbrtScene scene = Read(
      "LookAt 1 2 3  1 2 10  0 5 0\nCamera \"perspective\"\nWorldBegin\n"
      "CoordSysTransform \"camera\" Shape \"sphere\"");
  const Transform& to_world = scene.scene.camera.camera_to_world;
  const Vec3d eye = to_world.Point({0, 0, 0}), ahead = to_world.Point({0, 0, 1}),
              right = to_world.Point({1, 0, 0}), up = to_world.Point({0, 1, 0});
  EXPECT_EQ(Vec3f({float(eye.x), float(eye.y), float(eye.z)}), (Vec3f{1, 2, 3}));
  EXPECT_EQ(ahead.z, 4);
  EXPECT_EQ(right.x, 2);  // pbrt's camera space is left-handed
  EXPECT_EQ(up.y, 3);
  EXPECT_EQ(scene.scene.shapes.at(0).to_world, to_world);
}

}  // namespace
}  // namespace strata
