#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/status.h"
#include "worker/bsdf/bsdf.h"
#include "worker/geometry/geometry.h"
#include "worker/light/lamp_places.h"
#include "worker/medium/medium.h"
#include "worker/medium/near_lamps.h"
#include "worker/scene/description.h"

namespace strata {

/// Where a ray that was sent through media came to its next vertex.
struct Flight {
  bool scattered = false;       ///< In the medium; else it came to ray.t_max.
  float t = 0;                  ///< Of the scattering.
  MediumId medium = kNoMedium;  ///< There.
  Rgb weight = {1, 1, 1};       ///< Multiplies the throughput.
  Rgb emitted;  ///< By media on the way: radiance, to be multiplied by the throughput before it.
};

/// The media of a scene and where they lie. Immutable after Build, so thread-safe.
///
/// A ray knows the medium it is in and changes it at borders: at surfaces, when it goes through
/// them, and at borders that are nothing else ("interface" in pbrt). Those are no part of the
/// scene's geometry but of one of their own, in which each flight finds the stretches it goes by.
class MediumSet {
 public:
  /// Takes borders that are no surfaces out of `scene` and gives surfaces that are borders
  /// materials of their own, by which the set knows them. INVALID_ARGUMENT for coefficients out of
  /// their range and ids that lead nowhere, or as Geometry::Build.
  static absl::StatusOr<std::unique_ptr<MediumSet>> Build(SceneDescription* scene);

  /// Flights shall end near these lamps more often.
  void SetLamps(LampPlaces lamps) { lamps_ = std::move(lamps); }

  /// Whether all is empty space.
  bool empty() const { return media_.empty(); }
  MediumId camera_medium() const { return camera_medium_; }
  /// Borders that are no surfaces; null if there are none, and rays in no medium stay so.
  const Geometry* borders() const { return borders_.get(); }
  /// Surfaces are borders if their material is this or a later one.
  MaterialId first_border() const { return first_border_; }

  /// The medium of a path that is in `medium`, after it left a point of a surface of `material`
  /// whose outer normal is `ng` in direction `w`.
  MediumId Entered(MaterialId material, Vec3f ng, Vec3f w, MediumId medium) const {
    if (material < first_border_) return medium;
    const Border& border = borders_of_[static_cast<size_t>(material - first_border_)];
    return Dot(w, ng) > 0 ? border.outside : border.inside;
  }
  /// Of the lanes in `at_border`, whose materials are borders'; of the others `medium`.
  IntLanes Entered(IntLanes material, Vec3Lanes ng, Vec3Lanes w, IntLanes medium,
                   MaskLanes at_border) const {
    const auto* rows = reinterpret_cast<const float*>(borders_of_.data());
    const RowLanes sides = GatherRows(rows, (material - first_border_) * 4, at_border);
    const IntLanes entered = AsInts(Dot(w, ng) > 0 ? sides.v[1] : sides.v[0]);
    return at_border ? entered : medium;
  }
  /// What is around a point in `medium`, which may be none.
  Haze HazeOf(MediumId medium) const {
    if (empty() || medium == kNoMedium) return {};
    const Medium& m = media_[static_cast<size_t>(medium)];
    return {Average(m.scattering), Average(m.flight)};
  }
  bool scatters() const { return scatters_; }
  const Bsdf& phase(MediumId medium) const { return phases_[static_cast<size_t>(medium)]; }

  /// Follows `ray`, whose direction is of unit length, from `medium` to the first scattering before
  /// ray.t_max. The distance is drawn for one channel, chosen by its part in the throughput `beta`,
  /// and weighed by the density of all three: one-sample MIS (Wilkie et al. 2014, "Hero Wavelength
  /// Spectral Sampling"; PBRT 14.2.2), so that the sum over the channels of beta times weight stays
  /// at most what it was. u.x is for the distance, of all media on the way, u.y for the channel.
  Flight Fly(const Ray& ray, MediumId medium, Rgb beta, Vec2f u) const;

  /// Whether all that media do is absorb, and all borders are surfaces: then Absorption says all of
  /// flights and of what fades.
  bool only_absorbs() const { return only_absorbs_; }
  /// What is left of radiance over a length in a medium of each lane in `mask`.
  RgbLanes Absorption(IntLanes medium, FloatLanes length, MaskLanes mask) const {
    constexpr int32_t kStride = sizeof(Medium) / sizeof(float);
    const RowLanes extinction = GatherRows(&media_.front().extinction.r, medium * kStride, mask);
    return Fading({extinction.v[0], extinction.v[1], extinction.v[2]}, length);
  }

  /// The part of radiance that is left of it over a segment that starts in `medium`.
  Rgb Transmittance(const Ray& ray, MediumId medium) const;
  /// Whether a ray in `medium` is in none until it meets a surface.
  bool IsOutside(MediumId medium) const { return medium == kNoMedium && !borders_; }

 private:
  /// In fours for GatherRows.
  struct alignas(16) Border : MediumBorder {};
  static_assert(sizeof(Border) == 16);

  MediumSet() = default;
  /// Makes media_ and phases_.
  absl::Status SetMedia(const SceneDescription& scene);
  /// Makes borders_of_.
  absl::Status SetBorders(SceneDescription* scene);
  /// Calls f(medium, length) for each stretch of the ray in turn until it is false.
  template <typename F>
  void ForEachStretch(Ray ray, MediumId medium, F f) const;

  std::vector<Medium> media_;
  std::vector<Bsdf> phases_;        ///< PhaseFunctions, of each medium.
  std::vector<Border> borders_of_;  ///< Materials from first_border_ on.
  MaterialId first_border_ = 0;
  std::unique_ptr<Geometry> borders_;
  MediumId camera_medium_ = kNoMedium;
  bool scatters_ = false;  ///< Any of the media does.
  bool only_absorbs_ = false;
  LampPlaces lamps_;
};

}  // namespace strata
