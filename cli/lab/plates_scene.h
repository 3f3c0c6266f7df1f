#pragma once

#include <array>
#include <memory>

#include "common/job.h"
#include "common/status.h"
#include "worker/scene/scene.h"

namespace strata::lab {

/// After Veach's picture of multiple importance sampling (1997, figure 9.2): four spherical lamps
/// of equal power, small to large from left to right, mirrored in four metal plates, smooth to
/// rough from far to near, each tilted so that the camera sees the lamps in it.
struct PlatesScene {
  static constexpr int kWidth = 160, kHeight = 120;
  static constexpr std::array<float, 4> kAlphas = {0.01f, 0.03f, 0.08f, 0.2f};
  static constexpr std::array<float, 4> kRadii = {0.03f, 0.1f, 0.3f, 0.9f};

  std::shared_ptr<const Scene> scene;
  /// The pixels around each lamp's image in each plate: [plate][lamp].
  std::array<std::array<PixelRect, 4>, 4> highlights;
};

absl::StatusOr<PlatesScene> MakePlatesScene();

}  // namespace strata::lab
