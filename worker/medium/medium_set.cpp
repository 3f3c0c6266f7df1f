#include "worker/medium/medium_set.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "worker/sampling/choose.h"
#include "worker/sampling/inversion.h"
#include "worker/scene/references.h"

namespace strata {
namespace {

bool IsCoefficient(Rgb c) { return IsFinite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0; }

/// Of what fades by less than this over a unit nothing is seen; its free paths are beyond floats.
constexpr float kLeastCoefficient = 1e-12f;
Rgb WithoutTraces(Rgb c) {
  const auto kept = [](float v) { return v < kLeastCoefficient ? 0 : v; };
  return {kept(c.r), kept(c.g), kept(c.b)};
}

absl::StatusOr<Medium> MakeMedium(const MediumDescription& description) {
  Medium medium;
  const Rgb absorption = WithoutTraces(description.absorption);
  medium.scattering = WithoutTraces(description.scattering);
  medium.extinction = absorption + medium.scattering;
  medium.emission = absorption * description.emission;
  if (!IsBlack(medium.scattering)) medium.flight = medium.extinction;
  if (!IsCoefficient(description.absorption) || !IsCoefficient(description.scattering) ||
      !IsCoefficient(description.emission) || !IsCoefficient(medium.extinction) ||
      !IsCoefficient(medium.emission))
    return absl::InvalidArgumentError("a coefficient of the medium is negative or not finite");
  if (!(std::abs(description.g) < 1))
    return absl::InvalidArgumentError(
        absl::StrCat("the medium's g is ", description.g, ", it must lie in (-1, 1)"));
  return medium;
}

/// Moves borders that are no surfaces from `from` to `to`.
void MoveBorders(const SceneDescription& scene, std::vector<ShapeDescription>* from,
                 std::vector<ShapeDescription>* to) {
  const auto is_surface = [&](const ShapeDescription& shape) {
    return !shape.border ||
           !std::holds_alternative<InterfaceMaterial>(scene.materials[shape.material]);
  };
  const auto first = std::stable_partition(from->begin(), from->end(), is_surface);
  to->assign(std::make_move_iterator(first), std::make_move_iterator(from->end()));
  from->erase(first, from->end());
}

/// The scene's borders that are no surfaces, as shapes and objects of a scene of their own.
SceneDescription TakeBorders(SceneDescription* scene) {
  SceneDescription borders;
  MoveBorders(*scene, &scene->shapes, &borders.shapes);
  for (ObjectDescription& object : scene->objects) {
    borders.objects.push_back({object.name, {}});
    MoveBorders(*scene, &object.shapes, &borders.objects.back().shapes);
  }
  return borders;
}

bool IsEmpty(const SceneDescription& scene) {
  return scene.shapes.empty() &&
         std::all_of(scene.objects.begin(), scene.objects.end(),
                     [](const ObjectDescription& object) { return object.shapes.empty(); });
}

float Sum(Rgb c) { return c.r + c.g + c.b; }

}  // namespace

absl::StatusOr<std::unique_ptr<MediumSet>> MediumSet::Build(SceneDescription* scene) {
  std::unique_ptr<MediumSet> set(new MediumSet());
  STRATA_RETURN_IF_ERROR(set->SetMedia(*scene));
  STRATA_RETURN_IF_ERROR(set->SetBorders(scene));
  if (set->empty()) return set;
  set->camera_medium_ = scene->camera.medium;
  SceneDescription borders = TakeBorders(scene);
  if (!IsEmpty(borders)) {
    // There they are surfaces, and keep their ids.
    borders.materials.assign(scene->materials.size(), DiffuseMaterial());
    borders.instances = scene->instances;
    STRATA_ASSIGN_OR_RETURN(set->borders_, Geometry::Build(borders));
  }
  set->only_absorbs_ =
      !set->borders_ && std::all_of(set->media_.begin(), set->media_.end(), [](const Medium& m) {
        return IsBlack(m.scattering) && IsBlack(m.emission);
      });
  return set;
}

absl::Status MediumSet::SetMedia(const SceneDescription& scene) {
  bool all_clear = true;
  for (const MediumDescription& description : scene.media) {
    const absl::StatusOr<Medium> medium = MakeMedium(description);
    if (!medium.ok()) return Annotate(medium.status(), description.where.ToString());
    media_.push_back(*medium);
    phases_.push_back(PhaseFunction{description.g});
    all_clear &= IsBlack(medium->extinction);
    scatters_ |= !IsBlack(medium->scattering);
  }
  if (all_clear) {
    media_.clear();
    phases_.clear();
  }
  return absl::OkStatus();
}

absl::Status MediumSet::SetBorders(SceneDescription* scene) {
  const auto exists = [&](MediumId id) {
    return id >= kNoMedium && id < static_cast<MediumId>(scene->media.size());
  };
  if (!exists(scene->camera.medium))
    return absl::InvalidArgumentError("the camera stands in a medium that does not exist");
  first_border_ = static_cast<MaterialId>(scene->materials.size());
  std::map<std::pair<MaterialId, MediumBorder>, MaterialId> known;
  absl::Status status;
  ForEachShape(scene, [&](ShapeDescription& shape) {
    if (!shape.border) return;
    if (!exists(shape.border->inside) || !exists(shape.border->outside) || shape.material < 0 ||
        static_cast<size_t>(shape.material) >= scene->materials.size()) {
      status.Update(absl::InvalidArgumentError(absl::StrCat(
          shape.where.ToString(), ": the shape has a material or medium that does not exist")));
      return;
    }
    if (empty()) {
      shape.border.reset();
      return;
    }
    const MaterialId plain = shape.material;
    const auto [it, is_new] =
        known.try_emplace({plain, *shape.border}, static_cast<MaterialId>(scene->materials.size()));
    shape.material = it->second;
    if (!is_new) return;
    scene->materials.push_back(scene->materials[plain]);
    if (const auto detail = scene->surface_details.find(plain);
        detail != scene->surface_details.end())
      scene->surface_details[it->second] = detail->second;
    borders_of_.push_back({*shape.border});
  });
  return status;
}

template <typename F>
void MediumSet::ForEachStretch(Ray ray, MediumId medium, F f) const {
  Hit hit;
  while (borders_ && borders_->Intersect(ray, &hit)) {
    if (!f(medium, hit.t)) return;
    const SurfacePoint point = borders_->Surface(ray, hit);
    medium = Entered(point.material, point.ng, ray.direction, medium);
    ray.origin = OffsetRayOrigin(point, ray.direction);
    ray.t_max -= hit.t;
  }
  f(medium, ray.t_max);
}

Flight MediumSet::Fly(const Ray& ray, MediumId medium, Rgb beta, Vec2f u) const {
  const float total = Sum(beta), choice = u.y * total;
  const int channel = choice < beta.r ? 0 : choice < beta.r + beta.g || !(beta.b > 0) ? 1 : 2;
  const auto of_channel = [&](Rgb c) { return channel == 0 ? c.r : channel == 1 ? c.g : c.b; };
  // What is left of radiance, and the probability of no scattering, where a stretch begins.
  Rgb left = {1, 1, 1}, unscattered = {1, 1, 1};
  // By what the density of a distance falls short of `density`, that of each channel.
  const auto weight_by = [&](Rgb density) {
    const float mean = Sum(beta * density) / total;
    return mean > 0 ? 1 / mean : 0;
  };
  float depth = SampleExponential(u.x, 1), passed = 0;  // Optical depth yet to go, distance gone.
  Flight flight;
  ForEachStretch(ray, medium, [&](MediumId here, float length) {
    flight.medium = here;
    if (here == kNoMedium) {
      passed += length;
      return true;
    }
    const Medium& m = media_[static_cast<size_t>(here)];
    if (!IsBlack(m.emission))
      flight.emitted += left * EmissionAlong(m, length) * weight_by(unscattered);
    const float rate = of_channel(m.flight);
    if (rate > 0 && rate * length > depth) {
      // It is scattered on this stretch. Where is either as far as it came, or near a lamp.
      float distance = depth / rate;
      // The same for all channels, whose densities it is a part of.
      const NearLamps near(lamps_, ray.origin + ray.direction * passed, ray.direction, length,
                           Average(m.flight));
      if (near.part() > 0) {
        const float scattered = -Expm1(-rate * length);
        const float u_near = std::min(-Expm1(-depth) / scattered, kBelowOne);
        distance = u_near < near.part()
                       ? near.Sample(u_near / near.part())
                       : -Log1p(-scattered * (u_near - near.part()) / (1 - near.part())) / rate;
        distance = std::min(distance, length);
      }
      left *= Fading(m.extinction, distance);
      Rgb density = m.flight * Fading(m.flight, distance);
      if (near.part() > 0)
        density = density * (1 - near.part()) +
                  (Rgb::Gray(1) - Fading(m.flight, length)) * (near.part() * near.Pdf(distance));
      flight.scattered = true;
      flight.t = passed + distance;
      flight.weight = left * m.scattering * weight_by(unscattered * density);
      return false;
    }
    if (rate > 0) depth -= rate * length;
    left *= Fading(m.extinction, length);
    unscattered *= Fading(m.flight, length);
    passed += length;
    return true;
  });
  if (!flight.scattered) flight.weight = left * weight_by(unscattered);
  return flight;
}

Rgb MediumSet::Transmittance(const Ray& ray, MediumId medium) const {
  const float unit = Length(ray.direction);
  Rgb left = {1, 1, 1};
  ForEachStretch(ray, medium, [&](MediumId here, float length) {
    if (here == kNoMedium) return true;
    left *= Fading(media_[static_cast<size_t>(here)].extinction, unit * length);
    return !IsBlack(left);
  });
  return left;
}

}  // namespace strata
