#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/status.h"
#include "worker/geometry/geometry.h"
#include "worker/light/flat_lights.h"
#include "worker/light/light.h"
#include "worker/light/light_tree.h"
#include "worker/light/placed_light.h"
#include "worker/sampling/alias_table.h"
#include "worker/sampling/choose.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

namespace strata {

/// The lights of a scene and how one of them is chosen: those at a place by a LightTree or, to
/// compare, by an AliasTable; against the others by power, and now and then any that shines; or
/// all alike. Immutable.
class LightSet {
 public:
  /// `geometry` and `textures`, those of `scene`, must outlive the set. Errors name the light's
  /// place in the scene file.
  static absl::StatusOr<LightSet> Build(const SceneDescription& scene, const Geometry& geometry,
                                        const TextureSet& textures, const FileSource& source,
                                        const BuildOptions& options = {});

  /// Whether there is no light to choose. Lights with an alpha mask are never chosen: rays that
  /// meet what is there of them find their light.
  bool empty() const { return groups_.empty(); }
  const std::vector<Light>& lights() const { return lights_; }

  struct Choice {
    uint32_t light = 0;
    float probability = 0;  ///< 0: no light was found that can reach the point.
    float u = 0;            ///< What is left of the random number, again uniform in [0, 1).
  };
  /// Chooses by the 48-bit number u + 2^-24 u_low, both multiples of 2^-24 in [0, 1), so that
  /// enough bits are left even behind a faint light. The set must not be empty.
  Choice Select(const LightReceiver& receiver, float u, float u_low) const;
  /// Of each lane in `mask`.
  struct ChoiceLanes {
    IntLanes light = {};
    FloatLanes probability = {}, u = {};
    FloatLanes root_sum = {};  ///< For LightReceiver, where a light of the tree was chosen.
  };
  ChoiceLanes Select(const LightReceiverLanes& receivers, Vec2Lanes u, MaskLanes mask) const;
  bool SelectNeedsLowBits() const { return lights_.size() > 1; }
  float Probability(uint32_t light, const LightReceiver& receiver) const;

  static constexpr size_t kMaxLamps = 64;
  /// Where those lights are that shine from a place and all around or off a surface, if there are
  /// no more than kMaxLamps; else empty.
  const std::vector<LightBounds>& lamps() const { return lamps_; }

  /// Whether it is a triangle, be its radiance textured or not.
  bool IsTriangle(uint32_t light) const {
    const auto* textured = std::get_if<TexturedLight>(&lights_[light]);
    return textured ? std::holds_alternative<TriangleLight>(textured->surface->plain)
                    : std::holds_alternative<TriangleLight>(lights_[light]);
  }
  /// The light that the emissive surface `surface` (SurfacePoint::light) is, or is a part of.
  uint32_t LightOfSurface(uint32_t surface) const { return light_of_surface_[surface]; }
  /// Radiance that leaves the emissive surface `surface` (SurfacePoint::light) towards `wo`.
  /// `point()` gives the SurfacePoint there and is asked for it where the radiance varies.
  template <typename Point>
  Rgb SurfaceLe(uint32_t surface, Vec3f ng, Vec3f wo, Point&& point) const;
  /// Density per solid angle with which Select and SampleLi find a point of `surface`.
  float SurfacePdf(uint32_t surface, const LightReceiver& receiver, const EmissionHit& hit) const;
  std::optional<LightSample> Sample(uint32_t light, Vec3f from, Vec2f u) const;
  /// Eight at once, for the lanes in `mask`.
  void Sample(IntLanes light, Vec3Lanes from, Vec2Lanes u, MaskLanes mask,
              LightSampleLanes* samples) const;

  /// Indices of the lights that a ray which leaves the scene sees.
  const std::vector<uint32_t>& environments() const { return environments_; }
  /// `from` is where the ray comes from; the pdf, that of having sampled the direction there.
  Rgb EnvironmentLe(uint32_t light, Vec3f from, Vec3f direction) const;
  float EnvironmentPdf(uint32_t light, Vec3f from, Vec3f direction) const;

 private:
  static constexpr double kLowBits = 0x1p-24;
  /// What the first choice is among: a light from afar, or all those at a place.
  struct Group {
    static constexpr uint32_t kTree = ~0u;
    uint32_t light = 0;  ///< Or kTree.
    double power = 0;
    uint32_t lit = 0;  ///< How many of its lights are not black.
    double end = 0;    ///< Upper end in [0, 1]; the last is 1.
    float probability = 0;
  };
  /// Where a light is chosen.
  struct Place {
    static constexpr uint32_t kNowhere = ~0u;  ///< It is black or has an alpha mask.
    uint32_t group = kNowhere;
    uint32_t index = 0;  ///< In the tree, if the group is that.
  };

  /// One of those at a place, by its index among them.
  LightTree::Choice ChoosePlaced(const LightReceiver& receiver, double u) const;
  float PlacedProbability(uint32_t index, const LightReceiver& receiver) const;
  /// `rest` is what is left of the random number.
  const Group& ChooseGroup(float u, float u_low, double* rest) const;
  /// `leaf` is the tree's choice if the group is that.
  Choice ChoiceOf(const Group& group, double rest, const LightTree::Choice* leaf) const;
  /// A light that shines from a point; none for the others.
  absl::StatusOr<std::optional<PlacedLight>> MakePlaced(const LightDescription& description,
                                                        const FileSource& source);
  /// The next light.
  void AddFromAfar(double power);
  /// `placed` are the first lights.
  void BuildTree(const std::vector<PlacedLight>& placed, LightSelection selection);
  void FindProbabilities(LightSelection selection);

  std::vector<Light> lights_;  ///< Emissive surfaces first.
  FlatLights flat_;            ///< Of lights_.
  std::vector<uint32_t> light_of_surface_;
  std::vector<uint32_t> environments_;
  std::vector<std::unique_ptr<EnvironmentImage>> images_;
  std::vector<std::unique_ptr<PortalImage>> portals_;
  std::vector<std::unique_ptr<TexturedSurface>> textured_;
  std::vector<std::unique_ptr<Projection>> projections_;
  /// By path and mapping.
  std::map<std::pair<std::string, EnvironmentMapping>, std::unique_ptr<Diagram>> diagrams_;
  std::vector<Group> groups_;
  std::vector<Place> places_;  ///< Of each light.
  LightTree tree_;
  std::optional<AliasTable> table_;    ///< In place of the tree: the same choice for all points.
  std::vector<uint32_t> tree_lights_;  ///< By index in the tree, or table.
  std::vector<LightBounds> lamps_;
};

inline LightTree::Choice LightSet::ChoosePlaced(const LightReceiver& receiver, double u) const {
  if (!table_) return tree_.Select(receiver, u);
  const AliasTable::Choice choice = table_->Choose(u);
  return {static_cast<uint32_t>(choice.outcome), choice.probability, choice.fraction};
}

inline float LightSet::PlacedProbability(uint32_t index, const LightReceiver& receiver) const {
  return table_ ? table_->Probability(static_cast<int>(index)) : tree_.Probability(index, receiver);
}

inline const LightSet::Group& LightSet::ChooseGroup(float u, float u_low, double* rest) const {
  const double x = u + kLowBits * static_cast<double>(u_low);
  const Group* group = groups_.data();
  double low = 0;
  while (x >= group->end && group != &groups_.back()) low = (group++)->end;
  *rest = (x - low) / (group->end - low);
  return *group;
}

inline LightSet::Choice LightSet::ChoiceOf(const Group& group, double rest,
                                           const LightTree::Choice* leaf) const {
  Choice choice = {group.light, group.probability};
  if (leaf) {
    choice.light = tree_lights_[leaf->index];
    choice.probability *= leaf->probability;
    rest = leaf->u;
  }
  choice.u = std::min(static_cast<float>(rest), kBelowOne);
  return choice;
}

inline LightSet::Choice LightSet::Select(const LightReceiver& receiver, float u,
                                         float u_low) const {
  if (lights_.size() == 1) return {0, 1, u};
  double rest = 0;
  const Group& group = ChooseGroup(u, u_low, &rest);
  if (group.light != Group::kTree) return ChoiceOf(group, rest, nullptr);
  const LightTree::Choice leaf = ChoosePlaced(receiver, rest);
  return ChoiceOf(group, rest, &leaf);
}

inline float LightSet::Probability(uint32_t light, const LightReceiver& receiver) const {
  if (lights_.size() == 1) return empty() ? 0 : 1;
  const Place& place = places_[light];
  if (place.group == Place::kNowhere) return 0;
  const Group& group = groups_[place.group];
  return group.light == Group::kTree ? group.probability * PlacedProbability(place.index, receiver)
                                     : group.probability;
}

template <typename Point>
Rgb LightSet::SurfaceLe(uint32_t surface, Vec3f ng, Vec3f wo, Point&& point) const {
  const Light& l = lights_[light_of_surface_[surface]];
  if (const auto* triangle = std::get_if<TriangleLight>(&l)) return Le(*triangle, ng, wo);
  if (const auto* quad = std::get_if<QuadLight>(&l)) return Le(*quad, ng, wo);
  if (const auto* sphere = std::get_if<SphereLight>(&l)) return Le(*sphere, ng, wo);
  if (const auto* shape = std::get_if<ShapeLight>(&l)) return Le(*shape, ng, wo);
  return Le(*std::get_if<TexturedLight>(&l), point(), wo);
}

inline float LightSet::SurfacePdf(uint32_t surface, const LightReceiver& receiver,
                                  const EmissionHit& hit) const {
  const uint32_t light = light_of_surface_[surface];
  const Light& l = lights_[light];
  const float probability = Probability(light, receiver);
  if (const auto* triangle = std::get_if<TriangleLight>(&l))
    return probability * PdfLi(*triangle, receiver.p, hit);
  if (const auto* quad = std::get_if<QuadLight>(&l))
    return probability * PdfLi(*quad, receiver.p, hit);
  if (const auto* sphere = std::get_if<SphereLight>(&l))
    return probability * PdfLi(*sphere, receiver.p, hit);
  if (const auto* shape = std::get_if<ShapeLight>(&l))
    return probability * PdfLi(*shape, receiver.p, hit);
  return probability * PdfLi(*std::get_if<TexturedLight>(&l), receiver.p, hit);
}

inline void LightSet::Sample(IntLanes light, Vec3Lanes from, Vec2Lanes u, MaskLanes mask,
                             LightSampleLanes* samples) const {
  samples->delta = samples->infinite = samples->valid = MaskLanes{};
  const MaskLanes flat = flat_.Sample(light, from, u, mask, samples);
  ForEachLane(mask & ~flat, [&](int lane) {
    const std::optional<LightSample> sample =
        Sample(static_cast<uint32_t>(light[lane]), from.Get(lane), {u.x[lane], u.y[lane]});
    if (sample) samples->Set(lane, *sample);
  });
}

inline Rgb LightSet::EnvironmentLe(uint32_t light, Vec3f from, Vec3f direction) const {
  const Light& l = lights_[light];
  if (const auto* constant = std::get_if<ConstantEnvironment>(&l)) return Le(*constant, direction);
  if (const auto* image = std::get_if<ImageEnvironment>(&l)) return Le(*image, direction);
  return Le(*std::get_if<PortalEnvironment>(&l), from, direction);
}

inline float LightSet::EnvironmentPdf(uint32_t light, Vec3f from, Vec3f direction) const {
  const Light& l = lights_[light];
  const float probability = Probability(light, {});
  if (const auto* constant = std::get_if<ConstantEnvironment>(&l))
    return probability * PdfLi(*constant, direction);
  if (const auto* image = std::get_if<ImageEnvironment>(&l))
    return probability * PdfLi(*image, direction);
  return probability * PdfLi(*std::get_if<PortalEnvironment>(&l), from, direction);
}

}  // namespace strata
