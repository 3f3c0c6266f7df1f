#include "cli/scene_summary.h"

#include <variant>

#include "coordinator/film.h"

namespace strata {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

std::string NameOf(const TextureDescription& texture) {
  return std::visit(Overloaded{[](const ConstantTexture&) { return "constant"; },
                               [](const ImageTexture&) { return "imagemap"; },
                               [](const ScaleTexture&) { return "scale"; },
                               [](const MixTexture&) { return "mix"; },
                               [](const CheckerboardTexture&) { return "checkerboard"; },
                               [](const BilinearTexture&) { return "bilerp"; },
                               [](const DotsTexture&) { return "dots"; },
                               [](const NoiseTexture&) { return "noise"; }},
                    texture);
}

std::string NameOf(const MaterialDescription& material) {
  return std::visit(
      Overloaded{[](const DiffuseMaterial&) { return "diffuse"; },
                 [](const ConductorMaterial&) { return "conductor"; },
                 [](const DielectricMaterial&) { return "dielectric"; },
                 [](const ThinDielectricMaterial&) { return "thindielectric"; },
                 [](const CoatedDiffuseMaterial&) { return "coateddiffuse"; },
                 [](const CoatedConductorMaterial&) { return "coatedconductor"; },
                 [](const DiffuseTransmissionMaterial&) { return "diffusetransmission"; },
                 [](const BlinnMaterial&) { return "blinn"; },
                 [](const AshikhminShirleyMaterial&) { return "ashikhminshirley"; },
                 [](const MixMaterial& mix) { return mix.sum ? "mixture" : "mix"; },
                 [](const MetallicRoughnessMaterial&) { return "metallicroughness"; },
                 [](const InterfaceMaterial&) { return "interface"; }},
      material);
}

std::string NameOf(const ShapeGeometry& shape) {
  return std::visit(Overloaded{[](const TriangleMeshShape&) { return "trianglemesh"; },
                               [](const SphereShape&) { return "sphere"; },
                               [](const DiskShape&) { return "disk"; },
                               [](const CylinderShape&) { return "cylinder"; },
                               [](const BilinearPatchShape&) { return "bilinearmesh"; },
                               [](const CurveShape&) { return "curve"; }},
                    shape);
}

std::string NameOf(const LightDescription& light) {
  return std::visit(
      Overloaded{[](const PointLightDescription&) { return "point"; },
                 [](const SpotLightDescription&) { return "spot"; },
                 [](const ProjectionLightDescription&) { return "projection"; },
                 [](const GoniometricLightDescription&) { return "goniometric"; },
                 [](const DistantLightDescription&) { return "distant"; },
                 [](const ConstantInfiniteLightDescription&) { return "infinite"; },
                 [](const ImageInfiniteLightDescription&) { return "infinite image"; }},
      light.light);
}

uint64_t Triangles(const ShapeGeometry& shape) {
  const auto* mesh = std::get_if<TriangleMeshShape>(&shape);
  return mesh ? mesh->triangles.size() : 0;
}

/// Counts the shapes and returns the triangles among them.
uint64_t CountShapes(const std::vector<ShapeDescription>& shapes, SceneSummary* summary) {
  uint64_t triangles = 0;
  for (const ShapeDescription& shape : shapes) {
    ++summary->shapes[NameOf(shape.geometry)];
    if (shape.emission) ++summary->lights["area"];
    triangles += Triangles(shape.geometry);
  }
  summary->triangles += triangles;
  return triangles;
}

}  // namespace

SceneSummary Summarize(const SceneDescription& scene) {
  SceneSummary summary;
  summary.instanced_triangles = CountShapes(scene.shapes, &summary);
  std::vector<uint64_t> object_triangles;
  for (const ObjectDescription& object : scene.objects) {
    object_triangles.push_back(CountShapes(object.shapes, &summary));
  }
  for (const InstanceDescription& instance : scene.instances) {
    summary.instanced_triangles += object_triangles[static_cast<size_t>(instance.object)];
  }
  summary.objects = scene.objects.size();
  summary.instances = scene.instances.size();
  for (const MaterialDescription& material : scene.materials) ++summary.materials[NameOf(material)];
  for (const TextureDescription& texture : scene.textures) {
    // A number in the file is a constant texture too; nobody would look for it here.
    if (!std::holds_alternative<ConstantTexture>(texture)) ++summary.textures[NameOf(texture)];
  }
  for (const LightDescription& light : scene.lights) ++summary.lights[NameOf(light)];
  return summary;
}

std::string BackgroundLine(int64_t background_pixels, int64_t all_pixels) {
  return absl::StrCat(background_pixels, " of ", all_pixels,
                      " pixels see the background only, so no rays are traced there");
}

std::string UnusedLine(const UnusedParts& unused) {
  std::string line;
  const auto add = [&](uint64_t count, const char* what) {
    if (count == 0) return;
    absl::StrAppend(&line, line.empty() ? "" : ", ", count, " ", what, count == 1 ? "" : "s");
  };
  add(unused.objects, "object");
  add(unused.materials, "material");
  add(unused.textures, "texture");
  if (unused.images > 0)
    absl::StrAppend(&line, " (", unused.images, unused.images == 1 ? " image)" : " images)");
  return line;
}

uint64_t FilmBytes(const JobSpec& spec) {
  const uint64_t pixel =
      static_cast<uint64_t>(LayoutOf(spec).Doubles()) * sizeof(double) + sizeof(PixelCounts);
  return pixel * static_cast<uint64_t>(spec.crop.Pixels());
}

}  // namespace strata
