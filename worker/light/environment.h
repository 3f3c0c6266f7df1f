#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/status.h"
#include "worker/light/environment_map.h"
#include "worker/light/light_sample.h"
#include "worker/sampling/distribution.h"
#include "worker/sampling/warp.h"
#include "worker/scene/file_source.h"

// Light from infinitely far away in all directions (PBRT 12.5). `direction` is world space and
// unit, from the scene outwards.

namespace strata {

/// The same radiance from everywhere (PBRT 12.5.1).
struct ConstantEnvironment {
  Rgb radiance;
};

inline Rgb Le(const ConstantEnvironment& light, Vec3f /*direction*/) { return light.radiance; }
inline float PdfLi(const ConstantEnvironment&, Vec3f /*direction*/) { return UniformSpherePdf(); }

inline std::optional<LightSample> SampleLi(const ConstantEnvironment& light, Vec3f /*from*/,
                                           Vec2f u) {
  LightSample sample;
  sample.wi = SampleUniformSphere(u);
  sample.radiance = light.radiance;
  sample.pdf = UniformSpherePdf();
  sample.infinite = true;
  return sample;
}

/// Pixels of constant radiance over the sphere (PBRT 12.5.2). As pbrt-v4 does, the look-up takes
/// the nearest pixel. They are sampled by their luminance or, `compensated`, by what it has above
/// the mean: the rest, which is alike from everywhere, is left to BSDF sampling, without which the
/// sum of both is not complete (MIS compensation: Karlik et al. 2019, 4.1). A constant image has
/// nothing above.
struct EnvironmentImage {
  /// Reads the image of `light` through `source`. INVALID_ARGUMENT with its path when it does not
  /// fit its mapping, holds negative or non-finite values, or has a transform that shears.
  static absl::StatusOr<EnvironmentImage> Load(const ImageInfiniteLightDescription& light,
                                               const FileSource& source, bool compensated);

  /// `pixels` holds width * height radiances, row 0 first.
  EnvironmentImage(int width, int height, std::vector<Rgb> pixels, EnvironmentMapping mapping,
                   const Frame& axes, bool compensated);

  int width, height;
  EnvironmentMapping mapping;
  Frame axes;               ///< The image's x, y and z in world space; may be left-handed.
  std::vector<Rgb> pixels;  ///< Row 0 first.
  PiecewiseConstant2D distribution;
  Rgb mean;  ///< Over the sphere.
};

struct ImageEnvironment {
  const EnvironmentImage* image = nullptr;  ///< Owned by the LightSet.
};

inline Rgb Le(const ImageEnvironment& light, Vec3f direction) {
  const EnvironmentImage& image = *light.image;
  const Vec2f st = SphereToSquare(image.mapping, image.axes.ToLocal(direction));
  const int x = std::min(static_cast<int>(st.x * image.width), image.width - 1);
  const int y = std::min(static_cast<int>(st.y * image.height), image.height - 1);
  return image.pixels[static_cast<size_t>(y) * image.width + x];
}

inline float PdfLi(const ImageEnvironment& light, Vec3f direction) {
  const EnvironmentImage& image = *light.image;
  const Vec3f local = image.axes.ToLocal(direction);
  const float density = SphereDensity(image.mapping, local);
  return density > 0 ? image.distribution.Pdf(SphereToSquare(image.mapping, local)) / density : 0;
}

inline std::optional<LightSample> SampleLi(const ImageEnvironment& light, Vec3f /*from*/, Vec2f u) {
  const EnvironmentImage& image = *light.image;
  float pdf = 0;
  const Vec2f st = image.distribution.Sample(u, &pdf);
  const Vec3f local = SquareToSphere(image.mapping, st);
  const float density = SphereDensity(image.mapping, local);
  if (!(pdf > 0 && density > 0)) return std::nullopt;
  LightSample sample;
  sample.wi = image.axes.ToWorld(local);
  sample.radiance = Le(light, sample.wi);
  sample.pdf = pdf / density;
  sample.infinite = true;
  return sample;
}

}  // namespace strata
