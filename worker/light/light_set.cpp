#include "worker/light/light_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "worker/math/cpu_clones.h"

namespace strata {
namespace {

constexpr double kPiDouble = std::numbers::pi;

/// The power that light from afar brings to a ball around the scene.
double PowerFromAfar(double irradiance_sum, double scene_radius) {
  return kPiDouble * scene_radius * scene_radius * irradiance_sum;
}

/// The part of the choices between groups that does not go by power, as in LightTree.
constexpr double kEvenShare = 0.01;

bool ShinesFromPoint(const LightDescription& description) {
  return std::holds_alternative<PointLightDescription>(description.light) ||
         std::holds_alternative<SpotLightDescription>(description.light) ||
         std::holds_alternative<ProjectionLightDescription>(description.light) ||
         std::holds_alternative<GoniometricLightDescription>(description.light);
}

double SceneRadius(const Geometry& geometry) {
  const Geometry::Bounds bounds = geometry.bounds();
  const Vec3f diagonal = bounds.max - bounds.min;
  const double radius = 0.5 * Length(diagonal);
  return std::isfinite(radius) && radius > 0 ? radius : 1;  // Nothing to light: any will do.
}

}  // namespace

absl::StatusOr<LightSet> LightSet::Build(const SceneDescription& scene, const Geometry& geometry,
                                         const TextureSet& textures, const FileSource& source,
                                         const BuildOptions& options) {
  LightSet set;
  SurfaceLights surfaces = MakeSurfaceLights(geometry, textures, options);
  set.light_of_surface_ = std::move(surfaces.light_of_surface);
  set.textured_ = std::move(surfaces.textured);
  std::vector<PlacedLight>& placed = surfaces.lights;
  for (const LightDescription& description : scene.lights) {
    auto light = set.MakePlaced(description, source);
    if (!light.ok()) return Annotate(light.status(), description.where.ToString());
    if (*light) placed.push_back(**light);
  }
  for (const PlacedLight& light : placed) set.lights_.push_back(light.light);
  set.BuildTree(placed, options.selection);

  const double radius = SceneRadius(geometry);
  for (const LightDescription& description : scene.lights) {
    if (ShinesFromPoint(description)) continue;
    const uint32_t index = static_cast<uint32_t>(set.lights_.size());
    if (const auto* distant = std::get_if<DistantLightDescription>(&description.light)) {
      set.lights_.push_back(DistantLight{distant->direction, distant->irradiance});
      set.AddFromAfar(PowerFromAfar(Luminance(distant->irradiance), radius));
    } else {
      Rgb mean;
      set.environments_.push_back(index);
      const auto* image = std::get_if<ImageInfiniteLightDescription>(&description.light);
      if (image && image->portal) {
        auto loaded = PortalImage::Load(*image, source);
        if (!loaded.ok()) return Annotate(loaded.status(), description.where.ToString());
        set.portals_.push_back(std::make_unique<PortalImage>(*std::move(loaded)));
        const PortalImage& portal = *set.portals_.back();
        set.lights_.push_back(PortalEnvironment{&portal});
        set.AddFromAfar(double{portal.Area()} * Luminance(portal.irradiance));
        continue;
      }
      if (image) {
        auto loaded = EnvironmentImage::Load(*image, source, options.compensate);
        if (!loaded.ok()) return Annotate(loaded.status(), description.where.ToString());
        set.images_.push_back(std::make_unique<EnvironmentImage>(*std::move(loaded)));
        set.lights_.push_back(ImageEnvironment{set.images_.back().get()});
        mean = set.images_.back()->mean;
      } else {
        mean = std::get<ConstantInfiniteLightDescription>(description.light).radiance;
        set.lights_.push_back(ConstantEnvironment{mean});
      }
      set.AddFromAfar(PowerFromAfar(4 * kPiDouble * Luminance(mean), radius));
    }
  }
  set.FindProbabilities(options.selection);
  set.flat_ = FlatLights(set.lights_);
  return set;
}

absl::StatusOr<std::optional<PlacedLight>> LightSet::MakePlaced(const LightDescription& description,
                                                                const FileSource& source) {
  if (!ShinesFromPoint(description)) return std::nullopt;
  if (const auto* point = std::get_if<PointLightDescription>(&description.light))
    return MakePointLight(*point);
  if (const auto* spot = std::get_if<SpotLightDescription>(&description.light))
    return MakeSpotLight(*spot);
  if (const auto* projection = std::get_if<ProjectionLightDescription>(&description.light)) {
    STRATA_ASSIGN_OR_RETURN(Projection loaded, Projection::Load(*projection, source));
    projections_.push_back(std::make_unique<Projection>(std::move(loaded)));
    return MakeProjectionLight(*projection, *projections_.back());
  }
  const auto& lamp = std::get<GoniometricLightDescription>(description.light);
  std::unique_ptr<Diagram>& diagram = diagrams_[{lamp.path, lamp.mapping}];
  if (!diagram) {
    STRATA_ASSIGN_OR_RETURN(Diagram loaded, Diagram::Load(lamp.path, lamp.mapping, source));
    diagram = std::make_unique<Diagram>(std::move(loaded));
  }
  return MakeGoniometricLight(lamp, *diagram);
}

void LightSet::AddFromAfar(double power) {
  const uint32_t light = static_cast<uint32_t>(places_.size());
  places_.push_back({static_cast<uint32_t>(groups_.size())});
  groups_.push_back({light, power, power > 0 ? 1u : 0u});
}

void LightSet::BuildTree(const std::vector<PlacedLight>& placed, LightSelection selection) {
  places_.resize(placed.size());
  double total = 0, power = 0;
  for (const PlacedLight& light : placed) {
    if (light.masked) continue;
    total += light.intensity;
    power += light.power;
  }
  // Where no intensity is known (all black, or beyond all numbers) all are alike.
  const bool known = total > 0 && std::isfinite(total);
  constexpr double kFaintest = 1e-30;
  std::vector<LightBounds> bounds;
  for (uint32_t i = 0; i < placed.size(); ++i) {
    if (placed[i].masked || (known && !(placed[i].intensity > 0))) continue;
    places_[i] = {0, static_cast<uint32_t>(bounds.size())};
    tree_lights_.push_back(i);
    LightBounds& b = bounds.emplace_back(placed[i].bounds);
    b.intensity =
        known ? static_cast<float>(std::max(placed[i].intensity / total, kFaintest)) : 1.0f;
  }
  if (bounds.empty()) return;
  groups_.push_back({Group::kTree, power, known ? static_cast<uint32_t>(bounds.size()) : 0u});
  if (known && selection == LightSelection::kTree) {
    tree_ = LightTree::Build(bounds);
  } else {
    const double even = 1.0 / static_cast<double>(bounds.size());
    const bool uniform = !known || selection == LightSelection::kUniform;
    std::vector<double> weights;
    for (const LightBounds& b : bounds)
      weights.push_back(uniform ? 1 : (1 - kEvenShare) * b.intensity + kEvenShare * even);
    table_.emplace(weights);
  }
  if (!known || bounds.size() > kMaxLamps) return;
  for (const LightBounds& b : bounds) {
    if (b.cos_emit == 0) lamps_.push_back(b);
  }
}

void LightSet::FindProbabilities(LightSelection selection) {
  double total = 0, lit = 0;
  for (const Group& group : groups_) {
    total += group.power;
    lit += group.lit;
  }
  const bool known = total > 0 && std::isfinite(total);
  const double even = selection == LightSelection::kUniform ? 1 : kEvenShare;
  double sum = 0;
  for (Group& group : groups_) {
    const double before = sum;
    if (!known)
      sum += 1.0 / static_cast<double>(groups_.size());
    else if (group.power > 0)
      sum += (1 - even) * group.power / total + even * group.lit / lit;
    group.end = sum;
    group.probability = static_cast<float>(sum - before);
  }
  // Rounding must not leave a gap behind the last group that may be chosen.
  for (size_t i = groups_.size(); i-- > 0;) {
    groups_[i].end = 1;
    if (groups_[i].probability > 0) break;
  }
}

std::optional<LightSample> LightSet::Sample(uint32_t light, Vec3f from, Vec2f u) const {
  return std::visit([&](const auto& l) { return SampleLi(l, from, u); }, lights_[light]);
}

STRATA_CPU_CLONES LightSet::ChoiceLanes LightSet::Select(const LightReceiverLanes& receivers,
                                                         Vec2Lanes u, MaskLanes mask) const {
  if (lights_.size() == 1) return {IntLanes{}, SameFloat(1), u.x};
  DoubleLanes rest;
  std::array<const Group*, kLanes> groups;
  MaskLanes in_tree = mask;
  if (groups_.size() > 1 || groups_[0].light != Group::kTree) {
    ForEachLane(mask, [&](int lane) {
      double left = 0;
      groups[lane] = &ChooseGroup(u.x[lane], u.y[lane], &left);
      rest.Set(lane, left);
      in_tree[lane] = groups[lane]->light == Group::kTree ? -1 : 0;
    });
  } else {
    const DoubleLanes high = ToDoubleLanes(u.x), low = ToDoubleLanes(u.y);
    for (int i = 0; i < 2; ++i) rest.half[i] = high.half[i] + kLowBits * low.half[i];
  }
  ChoiceLanes choices = {};
  if (Any(in_tree)) {
    LightTree::ChoiceLanes leaves;
    if (table_) {
      ForEachLane(in_tree, [&](int lane) {
        const LightTree::Choice leaf = ChoosePlaced(receivers.Get(lane), rest.Get(lane));
        leaves.index[lane] = static_cast<int32_t>(leaf.index);
        leaves.probability[lane] = leaf.probability;
        leaves.u[lane] = static_cast<float>(leaf.u);
      });
    } else {
      leaves = tree_.Select(receivers, rest, in_tree);
    }
    choices.light = leaves.index;
    if (tree_lights_.size() < lights_.size()) {
      ForEachLane(in_tree, [&](int lane) {
        choices.light[lane] = static_cast<int32_t>(tree_lights_[leaves.index[lane]]);
      });
    }
    choices.probability = leaves.probability * static_cast<float>(groups_[0].probability);
    choices.u = Min(leaves.u, SameFloat(kBelowOne));
    choices.root_sum = leaves.root_sum;
  }
  ForEachLane(mask & ~in_tree, [&](int lane) {
    const Choice choice = ChoiceOf(*groups[lane], rest.Get(lane), nullptr);
    choices.light[lane] = static_cast<int32_t>(choice.light);
    choices.probability[lane] = choice.probability;
    choices.u[lane] = choice.u;
  });
  return choices;
}

}  // namespace strata
