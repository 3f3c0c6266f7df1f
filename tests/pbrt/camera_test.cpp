#include <gtest/gtest.h>

#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

absl::StatusOr<CameraDescription> Read(const std::string& camera) {
  STRATA_ASSIGN_OR_RETURN(PbrtScene scene, ReadText(camera + "\nWorldBegin\n"));
  return scene.scene.camera;
}

TEST(Cameras, OrthographicOnesHaveAWindowAndALens) {
  const auto camera = Read(
      "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"orthographic\" \"float screenwindow\" [ -1 2 -3 4 ] "
      "\"float lensradius\" 0.1 \"float focaldistance\" 5");
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_EQ(camera->kind, CameraKind::kOrthographic);
  EXPECT_EQ(camera->screen_window, (std::array<float, 4>{-1, 2, -3, 4}));
  EXPECT_EQ(camera->lens_radius, 0.1f);
  EXPECT_EQ(camera->focal_distance, 5);
  EXPECT_EQ(Read("Camera \"orthographic\" \"float frameaspectratio\" 2")->frame_aspect, 2);
}

TEST(Cameras, SphericalOnesAreEqualAreaUnlessTheySayOtherwise) {
  const auto camera = Read("Camera \"spherical\"");
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_EQ(camera->kind, CameraKind::kSpherical);
  EXPECT_EQ(camera->spherical_mapping, EnvironmentMapping::kEqualArea);
  EXPECT_EQ(Read("Camera \"spherical\" \"string mapping\" \"equirectangular\"")->spherical_mapping,
            EnvironmentMapping::kLatLong);
  EXPECT_EQ(Read("\nCamera \"spherical\" \"string mapping\" \"cube\"").status().message(),
            "scene.pbrt:2: unknown mapping \"cube\" of a spherical camera; use equalarea or "
            "equirectangular");
}

TEST(Cameras, RealisticOnesAreRefusedWithWhatToUse) {
  const absl::Status status = Read("Camera \"realistic\" \"string lensfile\" \"x.dat\"").status();
  EXPECT_EQ(status.message().rfind("scene.pbrt:1: Camera \"realistic\"", 0), 0u) << status;
  EXPECT_NE(status.message().find("\"lensradius\""), std::string::npos);
}

}  // namespace
}  // namespace strata
