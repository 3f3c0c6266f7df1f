#include "worker/scene/unused.h"

#include <utility>
#include <vector>

#include "worker/scene/references.h"

namespace strata {
namespace {

/// Which parts of one kind are used, and under which number they go on.
class UseList {
 public:
  explicit UseList(size_t count) : used_(count, false) {}

  /// False if it was known.
  bool Mark(int32_t id) {
    const bool news = !used_[static_cast<size_t>(id)];
    used_[static_cast<size_t>(id)] = true;
    return news;
  }

  /// Drops what is not used from `parts`, telling `dropped` of each.
  template <typename Part, typename Dropped>
  void Compact(std::vector<Part>* parts, Dropped dropped) {
    std::vector<Part> kept;
    for (size_t i = 0; i < parts->size(); ++i) {
      new_ids_.push_back(static_cast<int32_t>(kept.size()));
      if (used_[i])
        kept.push_back(std::move((*parts)[i]));
      else
        dropped((*parts)[i]);
    }
    *parts = std::move(kept);
  }
  bool Has(int32_t id) const { return used_[static_cast<size_t>(id)]; }
  int32_t NewId(int32_t id) const { return new_ids_[static_cast<size_t>(id)]; }

 private:
  std::vector<bool> used_;
  std::vector<int32_t> new_ids_;
};

/// Marks a material and, if it is a mix, what it is made of.
void MarkMaterial(const SceneDescription& scene, MaterialId id, UseList* used) {
  if (!used->Mark(id)) return;
  if (const auto* mix = std::get_if<MixMaterial>(&scene.materials[id])) {
    MarkMaterial(scene, mix->a, used);
    MarkMaterial(scene, mix->b, used);
  }
}

void MarkTexture(const SceneDescription& scene, TextureId id, UseList* used) {
  if (id == kNoTexture || !used->Mark(id)) return;
  ForEachInput(scene.textures[id], [&](TextureId input) { MarkTexture(scene, input, used); });
}

void DropObjects(SceneDescription* scene, UnusedParts* unused) {
  UseList used(scene->objects.size());
  for (const InstanceDescription& instance : scene->instances) used.Mark(instance.object);
  used.Compact(&scene->objects, [&](const ObjectDescription&) { ++unused->objects; });
  for (InstanceDescription& instance : scene->instances)
    instance.object = used.NewId(instance.object);
}

void DropMaterials(SceneDescription* scene, UnusedParts* unused) {
  UseList used(scene->materials.size());
  MarkMaterial(*scene, 0, &used);
  ForEachShape(scene,
               [&](const ShapeDescription& shape) { MarkMaterial(*scene, shape.material, &used); });
  used.Compact(&scene->materials, [&](const MaterialDescription&) { ++unused->materials; });
  for (MaterialDescription& material : scene->materials) {
    if (auto* mix = std::get_if<MixMaterial>(&material)) {
      mix->a = used.NewId(mix->a);
      mix->b = used.NewId(mix->b);
    }
  }
  std::map<MaterialId, SurfaceDetail> details;
  for (const auto& [id, detail] : scene->surface_details)
    if (used.Has(id)) details[used.NewId(id)] = detail;
  scene->surface_details = std::move(details);
  ForEachShape(scene,
               [&](ShapeDescription& shape) { shape.material = used.NewId(shape.material); });
}

void DropTextures(SceneDescription* scene, UnusedParts* unused) {
  UseList used(scene->textures.size());
  const auto mark = [&](TextureId id) { MarkTexture(*scene, id, &used); };
  for (const MaterialDescription& material : scene->materials) ForEachTexture(material, mark);
  for (auto& [id, detail] : scene->surface_details) ForEachTexture(detail, mark);
  ForEachShape(scene, [&](const ShapeDescription& shape) {
    mark(shape.alpha.texture);
    if (shape.emission) mark(shape.emission->texture);
  });
  used.Compact(&scene->textures, [&](const TextureDescription& texture) {
    if (!std::holds_alternative<ConstantTexture>(texture)) ++unused->textures;
    if (std::holds_alternative<ImageTexture>(texture)) ++unused->images;
  });
  const auto renumber = [&](TextureId& id) {
    if (id != kNoTexture) id = used.NewId(id);
  };
  for (MaterialDescription& material : scene->materials) ForEachTexture(material, renumber);
  for (auto& [id, detail] : scene->surface_details) ForEachTexture(detail, renumber);
  for (TextureDescription& texture : scene->textures) ForEachInput(texture, renumber);
  ForEachShape(scene, [&](ShapeDescription& shape) {
    renumber(shape.alpha.texture);
    if (shape.emission) renumber(shape.emission->texture);
  });
}

void DropMedia(SceneDescription* scene) {
  UseList used(scene->media.size());
  const auto mark = [&](MediumId id) {
    if (id != kNoMedium) used.Mark(id);
  };
  mark(scene->camera.medium);
  ForEachShape(scene, [&](const ShapeDescription& shape) {
    if (!shape.border) return;
    mark(shape.border->inside);
    mark(shape.border->outside);
  });
  used.Compact(&scene->media, [](const MediumDescription&) {});
  const auto renumber = [&](MediumId& id) {
    if (id != kNoMedium) id = used.NewId(id);
  };
  renumber(scene->camera.medium);
  ForEachShape(scene, [&](ShapeDescription& shape) {
    if (!shape.border) return;
    renumber(shape.border->inside);
    renumber(shape.border->outside);
  });
}

}  // namespace

UnusedParts RemoveUnused(SceneDescription* scene) {
  UnusedParts unused;
  DropObjects(scene, &unused);
  DropMaterials(scene, &unused);
  DropTextures(scene, &unused);
  DropMedia(scene);
  return unused;
}

}  // namespace strata
