#include "common/image_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace strata {
namespace {

class ImageFileTest : public ::testing::Test {
 protected:
  ImageFileTest()
      : folder_(std::filesystem::path(::testing::TempDir()) /
                (std::string("strata_image_") +
                 ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~ImageFileTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Path(const std::string& name) const { return folder_ / name; }
  std::filesystem::path WriteBytes(const std::string& name, const std::string& bytes) const {
    std::ofstream(Path(name), std::ios::binary) << bytes;
    return Path(name);
  }
  static std::string ReadBytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::filesystem::path folder_;
};

/// A crop of a frame with the layers a job has.
ImageLayers Layers() {
  ImageLayers image;
  image.full_width = 40;
  image.full_height = 30;
  image.crop = {5, 7, 25, 19};
  image.channels = {"R", "G", "B", "A", "stderr.R", "stderr.G", "stderr.B", "samples.Y", "flags.Y"};
  for (size_t i = 0; i < 20 * 12 * image.channels.size(); ++i)
    image.values.push_back(static_cast<float>(std::fmod(i * 0.37, 1.7)) - 0.1f);
  image.metadata = {{"seed", "18446744073709551615"}, {"job", "{\"spp\": 64}"}};
  return image;
}

TEST_F(ImageFileTest, LayersSurviveAnExr) {
  const ImageLayers written = Layers();
  ASSERT_TRUE(WriteExr(Path("a.exr"), written).ok());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1)
      << "no temporary file stays";
  const absl::StatusOr<ImageLayers> read = ReadExr(Path("a.exr"));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->full_width, written.full_width);
  EXPECT_EQ(read->full_height, written.full_height);
  EXPECT_EQ(read->crop, written.crop);
  ASSERT_EQ(read->channels.size(), written.channels.size());
  for (size_t channel = 0; channel < written.channels.size(); ++channel) {
    const auto found =
        std::find(read->channels.begin(), read->channels.end(), written.channels[channel]);
    ASSERT_NE(found, read->channels.end()) << written.channels[channel];
    const size_t other = static_cast<size_t>(found - read->channels.begin());
    for (size_t pixel = 0; pixel < 20 * 12; ++pixel) {
      ASSERT_EQ(read->values[pixel * written.channels.size() + other],
                written.values[pixel * written.channels.size() + channel]);
    }
  }
  for (const auto& attribute : written.metadata) {
    EXPECT_NE(std::find(read->metadata.begin(), read->metadata.end(), attribute),
              read->metadata.end())
        << attribute.first;
  }
}

TEST_F(ImageFileTest, PngsAreToneMapped) {
  ImageLayers image;
  image.full_width = 4;
  image.full_height = 1;
  image.crop = {0, 0, 4, 1};
  image.channels = {"samples.Y", "B", "G", "R"};
  // Shades below the knee are sRGB-encoded as they are; lamps come near white; NaN is black.
  image.values = {9, 0, 0.5f, 0.2140411f, 9, 1, 1, 1, 9, 50, 50, 50, 9, -1, NAN, INFINITY};
  ASSERT_TRUE(WritePng(Path("a.png"), image).ok());
  const absl::StatusOr<ImageFile> read = ReadImageFile(Path("a.png"));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->eight_bit);
  ASSERT_EQ(read->channels, 3);
  ASSERT_EQ(read->width, 4);
  const auto code = [&](int pixel, int channel) {
    return std::lround(read->values[pixel * 3 + channel] * 255);
  };
  EXPECT_NEAR(code(0, 0), 127.5, 0.6);
  EXPECT_EQ(code(0, 1), 188);  // 0.5 linear.
  EXPECT_EQ(code(0, 2), 0);
  EXPECT_EQ(code(1, 0), 243);  // 0.9 linear.
  EXPECT_GE(code(2, 0), 254);
  EXPECT_EQ(code(3, 0), 255);
  EXPECT_EQ(code(3, 1), 0);
  EXPECT_EQ(code(3, 2), 0);
}

TEST_F(ImageFileTest, TheToneMapIsSmoothAndGrows) {
  EXPECT_EQ(ToneMap(0.5f), 0.5f);
  EXPECT_EQ(ToneMap(-1), 0);
  EXPECT_NEAR(ToneMap(1), 0.9, 1e-6);
  float last = 0;
  for (float x = 0; x < 20; x += 0.01f) {
    const float y = ToneMap(x);
    EXPECT_GE(y, last);
    EXPECT_LE(y - last, 0.0101f);
    last = y;
  }
  EXPECT_LT(last, 1);
}

TEST_F(ImageFileTest, MissingAndForeignFiles) {
  EXPECT_EQ(ReadImageFile(Path("none.png")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReadImageFile(folder_).status().code(), absl::StatusCode::kInvalidArgument);
  for (const char* name :
       {"a.png", "a.exr", "a.jpg", "a.tga", "a.hdr", "a.tif", "a.pfm", "a.xyz"}) {
    EXPECT_EQ(ReadImageFile(WriteBytes(name, "")).status().code(),
              absl::StatusCode::kInvalidArgument)
        << name;
    EXPECT_EQ(ReadImageFile(WriteBytes(name, std::string(300, 'x'))).status().code(),
              absl::StatusCode::kInvalidArgument)
        << name;
  }
  ASSERT_TRUE(WritePng(Path("b.png"), Layers()).ok());
  EXPECT_EQ(ReadExr(Path("b.png")).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(ImageFileTest, TruncatedFilesAreErrors) {
  ASSERT_TRUE(WriteExr(Path("whole.exr"), Layers()).ok());
  ASSERT_TRUE(WritePng(Path("whole.png"), Layers()).ok());
  for (const char* name : {"whole.exr", "whole.png"}) {
    const std::string bytes = ReadBytes(Path(name));
    ASSERT_GT(bytes.size(), 300u);
    for (size_t length = 0; length < bytes.size() * 9 / 10; length += 1 + bytes.size() / 50) {
      const std::filesystem::path cut =
          WriteBytes(std::string("cut") + name, bytes.substr(0, length));
      EXPECT_FALSE(ReadImageFile(cut).ok()) << name << " cut to " << length;
    }
  }
}

TEST_F(ImageFileTest, DamagedFilesDoNoHarm) {
  ASSERT_TRUE(WriteExr(Path("whole.exr"), Layers()).ok());
  ASSERT_TRUE(WritePng(Path("whole.png"), Layers()).ok());
  uint64_t random = 1;
  for (const char* name : {"whole.exr", "whole.png"}) {
    const std::string bytes = ReadBytes(Path(name));
    for (int trial = 0; trial < 200; ++trial) {
      std::string damaged = bytes;
      for (int i = 0; i < 3; ++i) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        damaged[(random >> 33) % damaged.size()] = static_cast<char>(random >> 25);
      }
      // Whether it is an error or an image, it is told without a crash.
      const absl::StatusOr<ImageFile> file =
          ReadImageFile(WriteBytes(std::string("damaged") + name, damaged));
      if (!file.ok()) continue;
      EXPECT_EQ(file->values.size(),
                static_cast<size_t>(file->width) * file->height * file->channels);
    }
  }
}

TEST_F(ImageFileTest, AbsurdSizesAreRefusedBeforeMemoryIsAsked) {
  // A PFM and a TGA of a few bytes that claim gigabytes.
  const auto pfm = ReadImageFile(WriteBytes("huge.pfm", "PF\n60000 60000\n-1.0\n"));
  EXPECT_EQ(pfm.status().code(), absl::StatusCode::kInvalidArgument) << pfm.status();
  const auto hdr = ReadImageFile(
      WriteBytes("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 30000\nxx"));
  EXPECT_EQ(hdr.status().code(), absl::StatusCode::kInvalidArgument) << hdr.status();
}

TEST_F(ImageFileTest, WhatCannotBeWrittenIsSaid) {
  const absl::Status status = WriteExr(Path("no") / "such" / "folder.exr", Layers());
  EXPECT_EQ(status.code(), absl::StatusCode::kUnknown) << "no server's silence";
  EXPECT_NE(status.message().find("folder.exr"), absl::string_view::npos);
  ImageLayers gray = Layers();
  gray.channels[0] = "Y";
  EXPECT_EQ(WritePng(Path("a.png"), gray).code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace strata
