#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/image_file.h"
#include "tests/transport/test_scene.h"

// Shared scenes against the converged images of another RGB renderer that lie beside them. Frames
// are rendered smaller than the reference with the box filter, and compared in blocks of 8x8 of
// their pixels. Where a scene file is known to say something else than what the reference shows,
// its text is edited first; docs/scene-support.md says what was seen.

namespace strata {
namespace {

constexpr int kBlock = 8;

std::filesystem::path SharedScene(const std::string& name) {
  const char* shared = std::getenv("STRATA_SHARED");
  const std::filesystem::path root =
      shared ? shared : std::filesystem::path(STRATA_SOURCE_DIR) / ".." / "shared";
  return root / "scenes" / "pbrt" / name;
}

struct BlockImage {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;

  std::array<double, 3> Mean() const {
    std::array<double, 3> mean{};
    for (const Rgb& p : pixels) {
      mean[0] += p.r / static_cast<double>(pixels.size());
      mean[1] += p.g / static_cast<double>(pixels.size());
      mean[2] += p.b / static_cast<double>(pixels.size());
    }
    return mean;
  }
};

/// Means of blocks of size x size pixels; what is left over at the right and below is dropped.
BlockImage Blocks(const BlockImage& from, int size) {
  BlockImage to{from.width / size, from.height / size, {}};
  for (int y = 0; y < to.height; ++y) {
    for (int x = 0; x < to.width; ++x) {
      Rgb sum;
      for (int i = 0; i < size * size; ++i)
        sum += from.pixels[(y * size + i / size) * from.width + x * size + i % size];
      to.pixels.push_back(sum / static_cast<float>(size * size));
    }
  }
  return to;
}

BlockImage Reference(const std::filesystem::path& scene, int reduction) {
  const auto file = ReadImageFile(scene / "reference.exr");
  EXPECT_TRUE(file.ok()) << file.status();
  BlockImage image{file->width, file->height, {}};
  for (size_t i = 0; i < file->values.size(); i += file->channels)
    image.pixels.push_back({file->values[i], file->values[i + 1], file->values[i + 2]});
  return Blocks(image, reduction);
}

using Edit = void (*)(std::string& text);

/// `from`, which the text holds once, becomes `to`.
void Replace(std::string& text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  ASSERT_EQ(text.find(from, at + 1), std::string::npos) << from;
  text.replace(at, from.size(), to);
}

/// Scales what a material reflects: of `factor` of it, and of black for the rest.
void ScaleMaterial(std::string& text, const std::string& name, const std::string& factor) {
  const std::string define = "MakeNamedMaterial \"" + name;
  Replace(text, define + "\"",
          define + " black\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 0 0]\n" + define +
              "\" \"string type\" \"mix\" \"float amount\" " + factor +
              " \"string materials\" [\"" + name + " black\" \"" + name + " whole\"]\n" + define +
              " whole\"");
}

/// The reference has direct light alone, and its metals reflect 0.3 of what the file says.
void EditVeachMis(std::string& text) {
  Replace(text, "\"integer maxdepth\" [ 3 ]", "\"integer maxdepth\" 1");
  for (const char* name : {"Smooth", "Glossy", "Rough", "SuperRough"})
    ScaleMaterial(text, name, "0.3");
}

/// The reference's sun fills a cone of 5 degrees around its direction, with the irradiance of the
/// file's distant light, 10; its metals reflect less than the file's, too.
void EditClassroom(std::string& text) {
  const size_t sun = text.find("LightSource \"distant\"");
  const size_t end = text.find("TransformBegin", sun);
  ASSERT_NE(end, std::string::npos);
  text.replace(sun, end - sun,
               "AttributeBegin\n"
               "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
               "AreaLightSource \"diffuse\" \"rgb L\" [419.04 419.04 419.04]\n"
               "Translate -1731.6 833.53 -553.86\n"
               "Shape \"sphere\" \"float radius\" 174.31\n"
               "AttributeEnd\n");
  ScaleMaterial(text, "WindowFrame", "0.5");
  for (const char* name : {"ChairFrame", "ChairStainless"}) ScaleMaterial(text, name, "0.75");
}

/// The reference's sky is not the file's. A constant one in its place, of what a light tile far
/// from the pot shows over its reflectance.
void EditTeapot(std::string& text) {
  Replace(text, "\"string filename\" \"textures/envmap.pfm\"", "\"rgb L\" [0.60 0.62 0.74]");
}

/// All parts of the reference, haze, walls, shadow and caustic, have the level of four bounces.
void EditVolumetricCaustic(std::string& text) {
  Replace(text, "\"integer maxdepth\" [ 7 ]", "\"integer maxdepth\" 4");
}

/// The files of a directory, with an edited scene.pbrt.
class EditedSource : public FileSource {
 public:
  EditedSource(const std::filesystem::path& directory, Edit edit)
      : directory_(directory),
        scene_(std::filesystem::path(testing::TempDir()) /
               ("edited_" + std::to_string(getpid()) + ".pbrt")) {
    std::stringstream text;
    text << std::ifstream(directory / "scene.pbrt").rdbuf();
    std::string edited = text.str();
    edit(edited);
    std::ofstream(scene_) << edited;
  }
  ~EditedSource() override { std::filesystem::remove(scene_); }

  absl::StatusOr<std::filesystem::path> Locate(const std::string& bundle_path) const override {
    if (bundle_path == "scene.pbrt") return scene_;
    return directory_.Locate(bundle_path);
  }

 private:
  DirectorySource directory_;
  std::filesystem::path scene_;
};

Partial Render(const FileSource& source, int width, int height, uint32_t spp) {
  const auto scene = LoadScene(source, "scene.pbrt");
  EXPECT_TRUE(scene.ok()) << scene.status();
  JobSpec spec = TestSpec(8, spp, (*scene)->defaults().max_depth);
  spec.width = width;
  spec.height = height;
  spec.crop = {0, 0, width, height};
  return RenderFrame(*scene, spec);
}

BlockImage Means(const Partial& partial, int width, int height) {
  BlockImage image{width, height, {}};
  for (int64_t i = 0; i < int64_t{width} * height; ++i)
    image.pixels.push_back({static_cast<float>(PixelMean(partial, i, 0)),
                            static_cast<float>(PixelMean(partial, i, 1)),
                            static_cast<float>(PixelMean(partial, i, 2))});
  return image;
}

/// Of log luminance.
double Correlation(const BlockImage& a, const BlockImage& b) {
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const double n = static_cast<double>(a.pixels.size());
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const double x = std::log(1e-4 + Luminance(a.pixels[i]));
    const double y = std::log(1e-4 + Luminance(b.pixels[i]));
    sa += x;
    sb += y;
    saa += x * x;
    sbb += y * y;
    sab += x * y;
  }
  return (sab - sa * sb / n) / std::sqrt((saa - sa * sa / n) * (sbb - sb * sb / n));
}

struct Case {
  const char* scene;
  int reduction;  ///< Edge of the reference over the edge of the render.
  uint32_t spp;
  double correlation;     ///< At least.
  double mean_tolerance;  ///< Relative; 0: levels are not compared.
  Edit edit = [](std::string&) {};
};

class ReferenceTest : public testing::TestWithParam<Case> {};

TEST_P(ReferenceTest, RenderLooksLikeIt) {
  const Case& c = GetParam();
  const std::filesystem::path path = SharedScene(c.scene);
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared scenes at " << path;
  const BlockImage reference = Reference(path, c.reduction);
  const Partial partial =
      Render(EditedSource(path, c.edit), reference.width, reference.height, c.spp);
  const BlockImage render = Means(partial, reference.width, reference.height);
  const BlockImage still = Blocks(reference, kBlock);
  const double correlation = Correlation(Blocks(render, kBlock), still);
  RecordProperty("correlation", std::to_string(correlation));
  std::printf("%s: correlation %.4f\n", c.scene, correlation);
  EXPECT_GE(correlation, c.correlation);
  // The control: the picture beside itself, moved by a few blocks, must not pass.
  BlockImage moved = still;
  std::rotate(moved.pixels.begin(), moved.pixels.begin() + 3 * moved.width + 3, moved.pixels.end());
  EXPECT_LT(Correlation(moved, still), c.correlation);

  const std::array<double, 3> expected = reference.Mean();
  for (int channel = 0; channel < 3; ++channel) {
    const Estimate mean = FrameMean(partial, channel);
    std::printf("channel %d: mean %.4f +- %.4f, reference %.4f, ratio %.3f\n", channel, mean.mean,
                mean.standard_error, expected[channel], mean.mean / expected[channel]);
    if (c.mean_tolerance == 0) continue;
    EXPECT_NEAR(mean.mean / expected[channel], 1, c.mean_tolerance) << "channel " << channel;
    // What the tolerance decides must not be the seed.
    EXPECT_LE(3 * mean.standard_error, c.mean_tolerance * expected[channel]);
  }
}

// teapot-full stays below 0.98 for what its glass reflects.
// veach-mis stays below 0.98 because the lobes of the reference's metals are Beckmann's, without
// the tails of GGX, which pbrt-v4 and Strata have.
INSTANTIATE_TEST_SUITE_P(
    Shared, ReferenceTest,
    testing::Values(Case{"cornell-box", 8, 32, 0.98, 0.005},
                    Case{"veach-bidir", 8, 320, 0.98, 0.03}, Case{"coffee", 4, 16, 0.98, 0},
                    Case{"veach-mis", 8, 128, 0.95, 0.04, EditVeachMis},
                    Case{"classroom", 8, 64, 0.98, 0.05, EditClassroom},
                    Case{"staircase2", 8, 32, 0.98, 0},
                    Case{"teapot-full", 8, 64, 0.8, 0, EditTeapot},
                    Case{"volumetric-caustic", 8, 256, 0.98, 0.05, EditVolumetricCaustic}),
    [](const auto& info) {
      std::string name = info.param.scene;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace strata
