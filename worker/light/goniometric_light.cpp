#include "worker/light/goniometric_light.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "worker/light/ies.h"
#include "worker/light/light_input.h"

namespace strata {
namespace {

/// Of a diagram that is resampled: pixels of 0.4 degrees, finer than any IES file's angles.
constexpr int kResampledSize = 512;
constexpr uint64_t kMaxIesBytes = uint64_t{1} << 24;

/// The diagram of an intensity by direction.
template <typename F>
Diagram Resampled(F intensity) {
  std::vector<float> values;
  values.reserve(size_t{kResampledSize} * kResampledSize);
  for (int y = 0; y < kResampledSize; ++y) {
    for (int x = 0; x < kResampledSize; ++x) {
      values.push_back(
          intensity(EqualAreaSquareToSphere({(static_cast<float>(x) + 0.5f) / kResampledSize,
                                             (static_cast<float>(y) + 0.5f) / kResampledSize})));
    }
  }
  return Diagram(kResampledSize, std::move(values));
}

absl::StatusOr<Diagram> LoadIes(const std::string& path, const FileSource& source) {
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path local, source.Locate(path));
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(local, error);
  if (error || bytes > kMaxIesBytes)
    return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be read, or is no IES file"));
  std::ifstream file(local, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  STRATA_ASSIGN_OR_RETURN(const IesProfile profile, IesProfile::Parse(text, path));
  return Resampled([&](Vec3f d) { return profile.Candelas(d); });
}

/// An image by latitude and longitude, interpolated between the centres of its pixels.
Diagram FromLatLong(const LightImage& image) {
  return Resampled([&](Vec3f d) {
    const Vec2f st = LatLongSphereToSquare(d);
    const float x = st.x * static_cast<float>(image.width) - 0.5f;
    const float y = st.y * static_cast<float>(image.height) - 0.5f;
    const float left = std::floor(x), top = std::floor(y);
    const auto pixel = [&](int dx, int dy) {
      const int column = (static_cast<int>(left) + dx + image.width) % image.width;
      const int row = std::clamp(static_cast<int>(top) + dy, 0, image.height - 1);
      return Average(image.pixels[static_cast<size_t>(row) * image.width + column]);
    };
    const float fx = x - left, fy = y - top;
    return (1 - fy) * ((1 - fx) * pixel(0, 0) + fx * pixel(1, 0)) +
           fy * ((1 - fx) * pixel(0, 1) + fx * pixel(1, 1));
  });
}

/// The pixel at (x, y), at most one beyond the square. What goes out at an edge comes back in at
/// the same edge, mirrored about its middle, as the sphere closes there.
float PixelAt(const std::vector<float>& values, int size, int x, int y) {
  if (x < 0 || x >= size) {
    x = std::clamp(x, 0, size - 1);
    y = size - 1 - y;
  }
  if (y < 0 || y >= size) {
    y = std::clamp(y, 0, size - 1);
    x = size - 1 - x;
  }
  return values[static_cast<size_t>(y) * size + x];
}

}  // namespace

absl::StatusOr<Diagram> Diagram::Load(const std::string& path, EnvironmentMapping mapping,
                                      const FileSource& source) {
  if (IsIesFile(path)) return LoadIes(path, source);
  STRATA_ASSIGN_OR_RETURN(const LightImage image, ReadLightImage(path, 1, source));
  if (mapping == EnvironmentMapping::kLatLong) return FromLatLong(image);
  STRATA_RETURN_IF_ERROR(CheckEqualArea(image, path));
  std::vector<float> values;
  for (const Rgb& pixel : image.pixels) values.push_back(Average(pixel));
  return Diagram(image.width, std::move(values));
}

Diagram::Diagram(int size, std::vector<float> intensities)
    : size(size), values(std::move(intensities)) {
  double sum = 0;
  for (const float value : values) sum += value;
  mean = static_cast<float>(sum / static_cast<double>(values.size()));
  // A pixel's neighbours reach into it.
  std::vector<float> weights;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      float around = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) around += PixelAt(values, size, x + dx, y + dy);
      }
      // About the pixel's own mean: 1 2 1 in both directions, with a part of all for the rest.
      weights.push_back(0.75f * values[static_cast<size_t>(y) * size + x] + 0.25f / 9 * around);
    }
  }
  distribution = PiecewiseConstant2D(weights, size, size);
}

float Diagram::At(Vec3f local) const {
  const Vec2f st = EqualAreaSphereToSquare(local);
  const float x = st.x * static_cast<float>(size) - 0.5f;
  const float y = st.y * static_cast<float>(size) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const float fx = x - left, fy = y - top;
  const int ix = static_cast<int>(left), iy = static_cast<int>(top);
  const auto pixel = [&](int dx, int dy) { return PixelAt(values, size, ix + dx, iy + dy); };
  return (1 - fy) * ((1 - fx) * pixel(0, 0) + fx * pixel(1, 0)) +
         fy * ((1 - fx) * pixel(0, 1) + fx * pixel(1, 1));
}

}  // namespace strata
