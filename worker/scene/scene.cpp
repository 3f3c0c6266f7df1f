#include "worker/scene/scene.h"

#include <utility>

#include "worker/integrator/render.h"
#include "worker/scene/recentre.h"
#include "worker/scene/scene_file.h"

namespace strata {
namespace {

uint32_t FeaturesOf(const Scene& scene) {
  uint32_t features = kNoFeatures;
  if (!scene.lights().environments().empty()) features |= kEnvironments;
  if (scene.geometry().has_alpha()) features |= kAlphaMasks;
  if (!scene.lamp_images().empty()) features |= kLampImages;
  for (const BaseRow& row : scene.materials().base_rows()) {
    if (row.flags != BaseRow::kBase) features |= kOtherMaterials;
  }
  if (scene.lights().SelectNeedsLowBits()) features |= kManyLights;
  if (!scene.media().empty()) features |= kMedia;
  return features;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const Scene>> Scene::Build(SceneDescription description,
                                                          const FileSource& source,
                                                          const BuildOptions& options) {
  std::shared_ptr<Scene> scene(new Scene());
  scene->options_ = options;
  scene->origin_ = Recentre(description);
  scene->camera_ = description.camera;
  scene->defaults_ = description.defaults;
  STRATA_ASSIGN_OR_RETURN(scene->media_, MediumSet::Build(&description));
  STRATA_ASSIGN_OR_RETURN(scene->geometry_, Geometry::Build(description, options));
  const std::vector<Ball> balls = options.balls ? FindBalls(description) : std::vector<Ball>();
  // The meshes live in the geometry now; images may need the room.
  description.shapes.clear();
  description.objects.clear();
  STRATA_ASSIGN_OR_RETURN(scene->textures_, TextureSet::Load(description.textures, source));
  scene->geometry_->SetTextures(*scene->textures_);
  STRATA_ASSIGN_OR_RETURN(scene->materials_,
                          MaterialSet::Build(std::move(description.materials), *scene->textures_,
                                             description.surface_details));
  STRATA_ASSIGN_OR_RETURN(LightSet lights, LightSet::Build(description, *scene->geometry_,
                                                           *scene->textures_, source, options));
  scene->lights_ = std::make_unique<LightSet>(std::move(lights));
  if (options.near_lamps && scene->media_->scatters()) {
    scene->lamp_images_.glows = LampPlaces(scene->lights_->lamps());
    scene->media_->SetLamps(scene->lamp_images_.glows);
  }
  if (options.mirrors)
    scene->lamp_images_.mirrors =
        MirrorImages(*scene->geometry_, *scene->materials_, scene->lights_->lamps());
  scene->lamp_images_.balls = BallImages(balls, *scene->materials_, *scene->lights_);
  if (options.least_kernel) scene->features_ = FeaturesOf(*scene);
  return scene;
}

absl::StatusOr<std::shared_ptr<const Scene>> LoadScene(const FileSource& source,
                                                       const std::string& scene_path,
                                                       const BuildOptions& build_options,
                                                       const SceneOptions& scene_options) {
  STRATA_ASSIGN_OR_RETURN(SceneFile file, ReadSceneFile(source, scene_path, scene_options));
  BuildOptions options = build_options;
  if (scene_options.light_selection != LightSelection::kTree)
    options.selection = scene_options.light_selection;
  return Scene::Build(std::move(file.scene), source, options);
}

}  // namespace strata
