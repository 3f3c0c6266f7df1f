#include "worker/light/mirror_images.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace strata {
namespace {

struct Reflector {
  FlatRectangle rectangle;
  Vec3f normal;
  float alpha = 0;
  float reflectance = 0;

  Vec3f At(float u, float v) const {
    return rectangle.corner + rectangle.unit1 * (u * rectangle.length1) +
           rectangle.unit2 * (v * rectangle.length2);
  }
};

/// A lamp's image in a reflector, by their places in lists.
struct Candidate {
  uint32_t reflector = 0, lamp = 0;
  float flux = 0;  ///< Of the lamp on the reflector, times the reflectance. Roughly.
};

/// Radius over distance beyond which a lamp's image is found by chance often enough.
constexpr float kMaxLampSize = 0.4f;
/// What brings less than this part of the brightest is left to chance.
constexpr float kLeastFlux = 1e-3f;
/// Reflectors that hide behind others are sought out by rays to a grid of so many points each way.
constexpr int kGrid = 8;
constexpr size_t kMaxTested = 1024;
/// Of reflectors and lamps; where there are more, no few of them are most of the light.
constexpr size_t kMaxPairs = size_t{1} << 18;

std::vector<Reflector> ReflectorsOf(const Geometry& geometry, const MaterialSet& materials) {
  const auto metal_of = [&](MaterialId id) {
    const Bsdf* bsdf = materials.Constant(id);
    return bsdf ? std::get_if<ConductorBsdf>(bsdf) : nullptr;
  };
  std::vector<Reflector> reflectors;
  for (const FlatRectangle& rectangle :
       geometry.Rectangles([&](MaterialId id) { return metal_of(id) != nullptr; })) {
    const ConductorBsdf& metal = *metal_of(rectangle.material);
    const Ggx& ggx = metal.ggx;
    reflectors.push_back({rectangle, Normalize(Cross(rectangle.unit1, rectangle.unit2)),
                          ggx.IsSmooth() ? 0 : std::max(ggx.alpha_x, ggx.alpha_y),
                          Luminance(Albedo(metal, {0, 0, 1}))});
  }
  return reflectors;
}

float Radius(const LightBounds& lamp) { return 0.5f * MaxComponent(lamp.max - lamp.min); }

/// Flux on the reflector as if all of it were as far away and as inclined as its centre, at least
/// by its own size.
float FluxOn(const Reflector& reflector, const LightBounds& lamp) {
  const Vec3f to_lamp = lamp.Center() - reflector.At(0.5f, 0.5f);
  const float area = reflector.rectangle.length1 * reflector.rectangle.length2;
  const float distance2 = std::max(LengthSquared(to_lamp), 0.25f * area);
  const float cosine = AbsDot(reflector.normal, to_lamp) / std::sqrt(distance2);
  bool shines = lamp.two_sided || lamp.cos_spread < 0;
  for (int corner = 0; corner < 4 && !shines; ++corner) {
    const Vec3f p = reflector.At(corner & 1 ? 1.0f : 0.0f, corner & 2 ? 1.0f : 0.0f);
    shines = Dot(lamp.axis, p - lamp.Center()) > 0;
  }
  return shines ? lamp.intensity * reflector.reflectance * area * cosine / distance2 : 0;
}

bool IsLarge(const Reflector& reflector, const LightBounds& lamp) {
  return Radius(lamp) > kMaxLampSize * Length(lamp.Center() - reflector.At(0.5f, 0.5f));
}

bool IsHidden(const Geometry& geometry, const Reflector& reflector, const LightBounds& lamp) {
  const Vec3f center = lamp.Center();
  const float side = Dot(reflector.normal, center - reflector.rectangle.corner) < 0 ? -1.0f : 1.0f;
  const float offset = 1e-4f * std::min(reflector.rectangle.length1, reflector.rectangle.length2);
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const Vec3f p = reflector.At((static_cast<float>(i % kGrid) + 0.5f) / kGrid,
                                 (static_cast<float>(i / kGrid) + 0.5f) / kGrid) +
                    reflector.normal * (side * offset);
    const Vec3f to_lamp = center - p;
    const float end = 1 - Radius(lamp) / Length(to_lamp);
    if (!(end > 0) || !geometry.Occluded({p, to_lamp, end})) return false;
  }
  return true;
}

void Set(int lane, const Reflector& reflector, const LightBounds& lamp,
         MirrorImages::Images* images) {
  const FlatRectangle& rectangle = reflector.rectangle;
  const Vec3f center = lamp.Center();
  const float height = Dot(reflector.normal, center - rectangle.corner);
  images->corner.Set(lane, rectangle.corner);
  images->unit1.Set(lane, rectangle.unit1);
  images->unit2.Set(lane, rectangle.unit2);
  images->length1[lane] = rectangle.length1;
  images->length2[lane] = rectangle.length2;
  images->normal.Set(lane, height < 0 ? -reflector.normal : reflector.normal);
  images->center.Set(lane, center - reflector.normal * (2 * height));
  images->height[lane] = std::fabs(height);
  images->radius[lane] = Radius(lamp);
  images->alpha[lane] = reflector.alpha;
  images->strength[lane] = lamp.intensity * reflector.reflectance;
}

}  // namespace

MirrorImages::MirrorImages(const Geometry& geometry, const MaterialSet& materials,
                           const std::vector<LightBounds>& lamps) {
  if (lamps.empty()) return;
  const std::vector<Reflector> reflectors = ReflectorsOf(geometry, materials);
  if (reflectors.size() * lamps.size() > kMaxPairs) return;
  std::vector<Candidate> candidates;
  float most = 0;
  for (uint32_t r = 0; r < reflectors.size(); ++r) {
    for (uint32_t l = 0; l < lamps.size(); ++l) {
      const float flux = FluxOn(reflectors[r], lamps[l]);
      if (!(flux > kLeastFlux * most) || !std::isfinite(flux)) continue;
      candidates.push_back({r, l, flux});
      most = std::max(most, flux);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.flux > b.flux; });
  float kept = 0, left_out = 0;
  size_t count = 0;
  for (size_t i = 0; i < candidates.size() && candidates[i].flux > kLeastFlux * most; ++i) {
    const Reflector& reflector = reflectors[candidates[i].reflector];
    const LightBounds& lamp = lamps[candidates[i].lamp];
    if (i >= kMaxTested || count == kMaxImages) {
      left_out += candidates[i].flux;
    } else if (IsHidden(geometry, reflector, lamp)) {
      continue;
    } else if (IsLarge(reflector, lamp)) {
      left_out += candidates[i].flux;
    } else {
      if (count % kLanes == 0) images_.emplace_back();
      Set(static_cast<int>(count++ % kLanes), reflector, lamp, &images_.back());
      kept += candidates[i].flux;
    }
  }
  if (kept < left_out) images_.clear();
  if (images_.empty()) return;
  for (size_t l = 0; l < lamps.size(); ++l) {
    const int lane = static_cast<int>(l % kLanes);
    if (lane == 0) lamps_.emplace_back();
    lamps_.back().center.Set(lane, lamps[l].Center());
    lamps_.back().intensity[lane] = lamps[l].intensity;
  }
}

}  // namespace strata
