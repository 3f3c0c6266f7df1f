#pragma once

#include <memory>

#include "common/status.h"
#include "worker/bsdf/material.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/texture.h"
#include "worker/light/lamp_guide.h"
#include "worker/light/light_set.h"
#include "worker/medium/medium_set.h"
#include "worker/scene/build_options.h"
#include "worker/scene/description.h"
#include "worker/scene/features.h"
#include "worker/scene/file_source.h"

namespace strata {

/// A scene ready to be traced; what its file said of camera and frame is kept beside it.
/// Immutable, so that all threads and jobs may share it.
class Scene {
 public:
  /// Errors name the place in the scene file. Takes what it needs out of `description`.
  static absl::StatusOr<std::shared_ptr<const Scene>> Build(SceneDescription description,
                                                            const FileSource& source,
                                                            const BuildOptions& options = {});

  const Geometry& geometry() const { return *geometry_; }
  const TextureSet& textures() const { return *textures_; }
  const MaterialSet& materials() const { return *materials_; }
  const LightSet& lights() const { return *lights_; }
  const MediumSet& media() const { return *media_; }
  const LampImages& lamp_images() const { return lamp_images_; }
  const BuildOptions& options() const { return options_; }
  /// Features that a kernel must have for this scene.
  uint32_t features() const { return features_; }
  const CameraDescription& camera() const { return camera_; }
  /// Where the origin of all coordinates here lies in the file's world: see Recentre.
  Vec3d origin() const { return origin_; }
  const FrameDefaults& defaults() const { return defaults_; }

 private:
  Scene() = default;

  BuildOptions options_;
  Vec3d origin_;
  CameraDescription camera_;
  FrameDefaults defaults_;
  std::unique_ptr<Geometry> geometry_;
  std::unique_ptr<TextureSet> textures_;
  std::unique_ptr<MaterialSet> materials_;
  std::unique_ptr<LightSet> lights_;
  std::unique_ptr<MediumSet> media_;
  LampImages lamp_images_;
  uint32_t features_ = kAllFeatures;
};

}  // namespace strata
