#include "worker/geometry/texture.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "common/image_file.h"
#include "tests/statistics/random.h"
#include "worker/geometry/noise.h"

// Look-ups against values worked out by hand, with pbrt-v4's conventions.

namespace strata {
namespace {

/// Images written for a test, found by the names they were given.
class ImageFolder : public FileSource {
 public:
  ImageFolder() : root_(std::filesystem::path(::testing::TempDir()) / "strata_texture_test") {
    std::filesystem::create_directories(root_);
  }
  ~ImageFolder() override { std::filesystem::remove_all(root_); }

  absl::StatusOr<std::filesystem::path> Locate(const std::string& path) const override {
    ++locates;
    return root_ / path;
  }
  /// A PNG of the given sRGB-encoded shades below the knee of the tone map, or an EXR of `values`.
  void Write(const std::string& name, int width, int height, std::vector<float> values) const {
    ImageLayers image;
    image.full_width = width;
    image.full_height = height;
    image.crop = {0, 0, width, height};
    image.channels = {"R", "G", "B"};
    image.values = std::move(values);
    const std::filesystem::path path = root_ / name;
    const absl::Status status =
        path.extension() == ".png" ? WritePng(path, image) : WriteExr(path, image);
    ASSERT_TRUE(status.ok()) << status;
  }

  mutable int locates = 0;

 private:
  std::filesystem::path root_;
};

std::unique_ptr<TextureSet> MustLoad(const std::vector<TextureDescription>& textures,
                                     const FileSource& source = ImageFolder()) {
  auto set = TextureSet::Load(textures, source);
  EXPECT_TRUE(set.ok()) << set.status();
  return set.ok() ? std::move(*set) : nullptr;
}

// Two by two: the top row 1 2, the bottom row 3 4 (in r; g is ten times that, b is 0).
const std::vector<float> kSquare = {1, 10, 0, 2, 20, 0, 3, 30, 0, 4, 40, 0};

TEST(Textures, ConstantsAndNothing) {
  const auto set = MustLoad({ConstantTexture{{1, 2, 3}}});
  EXPECT_EQ(set->Eval(0, {0.3f, 0.4f}, {}), (Rgb{1, 2, 3}));
  EXPECT_EQ(set->Eval(kNoTexture, {}, {}), Rgb{});
  EXPECT_TRUE(set->IsConstant(0));
  EXPECT_TRUE(set->IsConstant(kNoTexture));
}

TEST(Textures, RowZeroOfAnImageIsAtTheTop) {
  const ImageFolder folder;
  folder.Write("square.exr", 2, 2, kSquare);
  ImageTexture image{"square.exr"};
  image.nearest = true;
  const auto set = MustLoad({image}, folder);
  EXPECT_EQ(set->Eval(0, {0.25f, 0.75f}, {}), (Rgb{1, 10, 0}));
  EXPECT_EQ(set->Eval(0, {0.75f, 0.75f}, {}), (Rgb{2, 20, 0}));
  EXPECT_EQ(set->Eval(0, {0.25f, 0.25f}, {}), (Rgb{3, 30, 0}));
  EXPECT_EQ(set->Eval(0, {0.75f, 0.25f}, {}), (Rgb{4, 40, 0}));
  EXPECT_EQ(set->Eval(0, {1.25f, -0.25f}, {}), (Rgb{1, 10, 0})) << "repeats";
  EXPECT_FALSE(set->IsConstant(0));
}

TEST(Textures, BilinearBetweenPixelCenters) {
  const ImageFolder folder;
  folder.Write("square.exr", 2, 2, kSquare);
  ImageTexture repeat{"square.exr"}, clamp = repeat, black = repeat;
  clamp.wrap = ImageWrap::kClamp;
  black.wrap = ImageWrap::kBlack;
  const auto set = MustLoad({repeat, clamp, black}, folder);
  for (TextureId id = 0; id < 3; ++id) {
    EXPECT_NEAR(set->Eval(id, {0.25f, 0.75f}, {}).r, 1, 1e-6);
    EXPECT_NEAR(set->Eval(id, {0.5f, 0.5f}, {}).r, 2.5, 1e-6);
    EXPECT_NEAR(set->Eval(id, {0.375f, 0.75f}, {}).r, 1.25, 1e-6);
    EXPECT_NEAR(set->Eval(id, {0.25f, 0.625f}, {}).g, 15, 1e-5);
  }
  // The corner (0, 1): all four pixels meet there, or one alone, or a quarter of one.
  EXPECT_NEAR(set->Eval(0, {0, 1}, {}).r, 2.5, 1e-6);
  EXPECT_NEAR(set->Eval(1, {0, 1}, {}).r, 1, 1e-6);
  EXPECT_NEAR(set->Eval(2, {0, 1}, {}).r, 0.25, 1e-6);
  EXPECT_NEAR(set->Eval(1, {7, -9}, {}).r, 4, 1e-6);
  EXPECT_NEAR(set->Eval(2, {7, -9}, {}).r, 0, 1e-6);
  // Hostile coordinates give some value and no crash.
  for (const float bad : {1e30f, -1e30f, INFINITY, -INFINITY, NAN}) {
    for (TextureId id = 0; id < 3; ++id) set->Eval(id, {bad, bad}, {});
  }
}

TEST(Textures, MappingScaleAndInversion) {
  const ImageFolder folder;
  folder.Write("square.exr", 2, 2, kSquare);
  ImageTexture image{"square.exr"};
  image.nearest = true;
  image.mapping = {2, 1, 0.5f, 0};
  ImageTexture scaled = image, inverted = image, scalar = image;
  scaled.scale = 0.25f;
  inverted.scale = 0.25f;
  inverted.invert = true;
  scalar.scalar = true;
  const auto set = MustLoad({image, scaled, inverted, scalar}, folder);
  const Vec2f uv = {0.125f, 0.75f};  // s = 0.75: the pixel at the top right.
  EXPECT_EQ(set->Eval(0, uv, {}), (Rgb{2, 20, 0}));
  EXPECT_EQ(set->Eval(1, uv, {}), (Rgb{0.5f, 5, 0}));
  EXPECT_EQ(set->Eval(2, uv, {}), (Rgb{0.5f, 0, 1})) << "1 - scale value, not below 0";
  EXPECT_NEAR(set->Eval(3, uv, {}).r, 22.0 / 3, 1e-5);
  EXPECT_EQ(set->Eval(3, uv, {}).r, set->Eval(3, uv, {}).b);
}

TEST(Textures, EightAtOnceAreWhatEachIs) {
  const ImageFolder folder;
  std::vector<float> shades;
  for (int i = 0; i < 5 * 4 * 3; ++i) shades.push_back(0.01f * static_cast<float>(i));
  folder.Write("image.exr", 5, 4, shades);
  folder.Write("image.png", 5, 4, shades);
  folder.Write("dot.png", 1, 1, {0.3f, 0.4f, 0.5f});
  const auto set =
      MustLoad({ImageTexture{"image.exr"}, ImageTexture{"image.png", {2, 3, 0.1f, 0.2f}},
                ImageTexture{.path = "image.png", .wrap = ImageWrap::kBlack, .channel = 1},
                ImageTexture{.path = "image.png", .scale = 0.5f, .invert = true, .nearest = true},
                ImageTexture{.path = "image.exr", .second_uv = true}, ScaleTexture{0, 1},
                CheckerboardTexture{.a = 0, .b = 1}, ScaleTexture{0, 4}, ConstantTexture{{1, 2, 3}},
                ImageTexture{.path = "image.png", .wrap = ImageWrap::kClamp, .scale = 0.7f},
                ImageTexture{.path = "image.exr", .wrap = ImageWrap::kMirror},
                ImageTexture{.path = "image.png", .wrap_t = ImageWrap::kClamp},
                ImageTexture{"dot.png"}, ImageTexture{"image.png", {1, 1, 0, 0, 0.5f, 0}},
                ImageTexture{.path = "image.png", .scalar = true},
                BilinearTexture{{0, 1, 8, 9}, {}}, DotsTexture{0, 1, {3, 3}}, NoiseTexture{}},
               folder);
  for (const TextureId id : {4, 7}) EXPECT_FALSE(set->NeedsFirstUvOnly(id));
  const std::array<TextureId, 17> ids = {0,  1,  2,  3,  5,  6,  8,  9,         10,
                                         11, 12, 13, 14, 15, 16, 17, kNoTexture};
  for (const TextureId id : ids) EXPECT_TRUE(set->NeedsFirstUvOnly(id));
  TestRandom random(1);
  const MaskLanes mask = {-1, -1, 0, -1, -1, -1, 0, -1};
  for (int i = 0; i < 4000; ++i) {
    IntLanes id;
    Vec2Lanes uv;
    for (int lane = 0; lane < kLanes; ++lane) {
      id[lane] = static_cast<int32_t>(ids[(i + lane * (i / 16)) % ids.size()]);
      uv.x[lane] = 4 * random.Float() - 1.5f;
      uv.y[lane] = i % 7 == 0 ? 0.25f * static_cast<float>(lane) : 4 * random.Float() - 1.5f;
    }
    const Vec3Lanes p = {uv.y, uv.x, uv.x + uv.y};
    TextureSet::BegunLanes begun;
    set->Begin(id, uv, mask, &begun);
    const RgbLanes found = set->Finish(begun, p);
    ForEachLane(mask, [&](int lane) {
      const Vec2f at = {uv.x[lane], uv.y[lane]};
      EXPECT_EQ(found.Get(lane), set->Eval(static_cast<TextureId>(id[lane]), at, p.Get(lane)))
          << id[lane] << " at " << at.x << " " << at.y;
    });
  }
}

TEST(Textures, EightBitCodesAreDecodedAsAsked) {
  const ImageFolder folder;
  folder.Write("gray.png", 1, 1, {0.2140411f, 0.2140411f, 0.2140411f});  // Code 127 or 128.
  ImageTexture srgb{"gray.png"}, linear = srgb, gamma = srgb;
  linear.encoding = ImageEncoding::kLinear;
  gamma.encoding = ImageEncoding::kGamma;
  gamma.gamma = 2;
  const auto set = MustLoad({srgb, linear, gamma}, folder);
  const double code = std::round(set->Eval(1, {}, {}).r * 255);
  EXPECT_NEAR(code, 127.5, 1);
  EXPECT_NEAR(set->Eval(1, {}, {}).g, code / 255, 1e-7);
  EXPECT_NEAR(set->Eval(2, {}, {}).g, code / 255 * code / 255, 1e-7);
  EXPECT_NEAR(set->Eval(0, {}, {}).g, std::pow((code / 255 + 0.055) / 1.055, 2.4), 1e-7);
  EXPECT_EQ(folder.locates, 1) << "one file, loaded once";
}

TEST(Textures, TexelsThatAreNotFiniteAreErrors) {
  const ImageFolder folder;
  for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
    std::vector<float> values = kSquare;
    values[7] = bad;
    folder.Write("bad.exr", 2, 2, values);
    ImageTexture image;
    image.path = "bad.exr";
    const absl::Status status = TextureSet::Load({image}, folder).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(status.message(),
              "texture image bad.exr: the image's texel (0, 1) is NaN or infinite");
  }
}

TEST(Textures, ScaleAndMix) {
  const auto set = MustLoad({ConstantTexture{{1, 2, 4}}, ConstantTexture{Rgb::Gray(0.25f)},
                             ScaleTexture{0, 1}, MixTexture{0, 2, 1},
                             CheckerboardTexture{1, 0, {}, false, {}}, MixTexture{0, 1, 4}});
  EXPECT_EQ(set->Eval(2, {}, {}), (Rgb{0.25f, 0.5f, 1}));
  EXPECT_NEAR(set->Eval(3, {}, {}).b, 0.75 * 4 + 0.25 * 1, 1e-6);
  EXPECT_TRUE(set->IsConstant(2));
  EXPECT_TRUE(set->IsConstant(3));
  EXPECT_FALSE(set->IsConstant(5));
  EXPECT_NEAR(set->Eval(5, {0.5f, 0.5f}, {}).g, 0.75 * 2 + 0.25 * 0.25, 1e-6);
  EXPECT_EQ(set->Eval(5, {1.5f, 0.5f}, {}).g, 0.25f);
}

TEST(Textures, Checkerboards) {
  CheckerboardTexture flat{0, 1, {2, 2, 0, 0}, false, {}};
  CheckerboardTexture solid{0, 1, {}, true, Transform::Scale(2, 2, 2)};
  const auto set =
      MustLoad({ConstantTexture{Rgb::Gray(1)}, ConstantTexture{Rgb::Gray(2)}, flat, solid});
  EXPECT_EQ(set->Eval(2, {0.25f, 0.25f}, {}).r, 1);
  EXPECT_EQ(set->Eval(2, {0.75f, 0.25f}, {}).r, 2);
  EXPECT_EQ(set->Eval(2, {0.75f, 0.75f}, {}).r, 1);
  EXPECT_EQ(set->Eval(2, {-0.25f, 0.25f}, {}).r, 2);
  EXPECT_EQ(set->Eval(3, {}, {0.25f, 0.25f, 0.25f}).r, 1);
  EXPECT_EQ(set->Eval(3, {}, {0.25f, 0.75f, 0.25f}).r, 2);
  EXPECT_EQ(set->Eval(3, {}, {0.25f, 0.75f, -0.25f}).r, 1);
  EXPECT_EQ(set->Eval(3, {}, {0.75f, 0.75f, 0.75f}).r, 2);
}

TEST(Textures, PatternsOfConstantsAreNotConstant) {
  const auto set = MustLoad(
      {ConstantTexture{Rgb::Gray(1)}, ConstantTexture{{2, 4, 8}}, ConstantTexture{Rgb::Gray(3)},
       BilinearTexture{{0, 1, 2, 0}, {2, 1, 0, 0}}, DotsTexture{0, 1, {10, 10}},
       NoiseTexture{.octaves = 1, .world_to_texture = Transform::Scale(2, 2, 2)}});
  for (const TextureId id : {3, 4, 5}) EXPECT_FALSE(set->IsConstant(id));
  EXPECT_EQ(set->Eval(3, {}, {}), Rgb::Gray(1));
  EXPECT_EQ(set->Eval(3, {0.5f, 0}, {}), (Rgb{2, 4, 8}));
  EXPECT_EQ(set->Eval(3, {0, 1}, {}), Rgb::Gray(3));
  EXPECT_EQ(set->Eval(3, {0.25f, 0.5f}, {}).g, 0.25f * (1 + 4 + 3 + 1));
  EXPECT_EQ(set->Eval(4, {0.05f, 0.05f}, {}), (Rgb{2, 4, 8})) << "the border of a dot's cell";
  EXPECT_FLOAT_EQ(set->Eval(5, {}, {0.2f, 0.3f, 0.4f}).g,
                  static_cast<float>(Noise({0.4f, 0.6f, 0.8f})));
}

TEST(Textures, CyclesAndMissingPartsAreErrors) {
  const ImageFolder folder;
  const auto status = [&](const std::vector<TextureDescription>& textures) {
    return TextureSet::Load(textures, folder).status();
  };
  EXPECT_NE(status({ScaleTexture{0, 0}}).message().find("cycle"), absl::string_view::npos);
  EXPECT_NE(status({ScaleTexture{1, 1}, MixTexture{0, 1, 0}}).message().find("cycle"),
            absl::string_view::npos);
  EXPECT_EQ(status({ScaleTexture{3, 0}}).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(status({ImageTexture{"none.png"}}).code(), absl::StatusCode::kNotFound);
  EXPECT_NE(status({ImageTexture{"none.png"}}).message().find("none.png"), absl::string_view::npos);
  // Forty doublings would take a million million look-ups.
  std::vector<TextureDescription> textures = {
      CheckerboardTexture{kNoTexture, kNoTexture, {}, false, {}}};
  for (TextureId i = 0; i < 40; ++i) textures.push_back(MixTexture{i, i, i});
  EXPECT_EQ(status(textures).code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace strata
