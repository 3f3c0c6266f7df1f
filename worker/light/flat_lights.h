#pragma once

#include <type_traits>
#include <vector>

#include "worker/geometry/geometry_lanes.h"
#include "worker/light/light.h"
#include "worker/math/lanes.h"
#include "worker/sampling/warp_lanes.h"

namespace strata {

/// LightSamples side by side.
struct LightSampleLanes {
  Vec3Lanes wi;
  RgbLanes radiance;
  FloatLanes pdf = {};
  MaskLanes delta = {}, infinite = {};
  Vec3Lanes end;
  MaskLanes valid = {};

  void Set(int lane, const LightSample& s) {
    wi.Set(lane, s.wi);
    radiance.Set(lane, s.radiance);
    pdf[lane] = s.pdf;
    delta[lane] = s.delta ? -1 : 0;
    infinite[lane] = s.infinite ? -1 : 0;
    end.Set(lane, s.end);
    valid[lane] = -1;
  }
};

/// The triangles and parallelograms among some lights as rows of numbers, from which eight are
/// sampled by area at once.
class FlatLights {
 public:
  FlatLights() = default;
  explicit FlatLights(const std::vector<Light>& lights) {
    for (const Light& light : lights) rows_.push_back(RowOf(light));
  }

  /// Samples lights[light] from `from` in those lanes of `mask` where it is flat and not to be
  /// sampled by solid angle; returns them.
  MaskLanes Sample(IntLanes light, Vec3Lanes from, Vec2Lanes u, MaskLanes mask,
                   LightSampleLanes* sample) const {
    const RowLanes row = {rows_.data(), light * static_cast<int32_t>(sizeof(Row) / sizeof(float)),
                          mask};
    const MaskLanes done = mask & (row.Get(&Row::flat) > 0) &
                           ~(LengthSquared(row.Get(&Row::center) - from) < row.Get(&Row::near2));
    if (!Any(done)) return done;
    const Vec2Lanes corner_weights = SampleTriangle(u);
    const MaskLanes triangle = row.Get(&Row::triangle) > 0;
    u = {triangle ? corner_weights.x : u.x, triangle ? corner_weights.y : u.y};
    const Vec3Lanes p =
        row.Get(&Row::p0) + (row.Get(&Row::edge1) * u.x + row.Get(&Row::edge2) * u.y);
    const Vec3Lanes ng = row.Get(&Row::ng);
    const Vec3Lanes to_light = p - from;
    const FloatLanes distance2 = LengthSquared(to_light);
    const Vec3Lanes wi = to_light * (1 / Sqrt(distance2));
    const FloatLanes cosine = Dot(ng, wi);
    const MaskLanes shines = (row.Get(&Row::two_sided) > 0) | (cosine < 0);
    const RgbLanes radiance = row.Get(&Row::radiance);
    const FloatLanes pdf = row.Get(&Row::pdf_area) * distance2 / Abs(cosine);
    const FloatLanes offset = Dot(Abs(ng), row.Get(&Row::p_error));
    sample->wi = Select(done, wi, sample->wi);
    sample->radiance = Select(done, radiance, sample->radiance);
    sample->pdf = done ? pdf : sample->pdf;
    sample->end = Select(done, OffsetRayOrigins(p, offset, ng, -to_light), sample->end);
    sample->valid |=
        done & shines & (distance2 > 0) & (cosine != 0) & (pdf > 0) & ~IsBlack(radiance);
    return done;
  }

 private:
  struct Row {
    Vec3f p0, edge1, edge2, ng, p_error;
    Vec3f center;  ///< With near2: see QuadLight.
    float near2 = 0;
    Rgb radiance;
    float pdf_area = 0;
    float two_sided = 0, flat = 0, triangle = 0;  ///< 1 or 0.
  };
  static_assert(std::is_standard_layout_v<Row> && sizeof(Row) % sizeof(float) == 0);

  /// A member of the rows of eight lights.
  struct RowLanes {
    const Row* rows;
    IntLanes first;  ///< Of each row, in floats.
    MaskLanes mask;

    FloatLanes Get(float Row::*member) const { return Gather(&(rows->*member), first, mask); }
    Vec3Lanes Get(Vec3f Row::*member) const {
      const float* x = &(rows->*member).x;
      return {Gather(x, first, mask), Gather(x + 1, first, mask), Gather(x + 2, first, mask)};
    }
    RgbLanes Get(Rgb Row::*member) const {
      const float* r = &(rows->*member).r;
      return {Gather(r, first, mask), Gather(r + 1, first, mask), Gather(r + 2, first, mask)};
    }
  };

  static Row RowOf(const Light& light) {
    Row row;
    if (const auto* t = std::get_if<TriangleLight>(&light)) {
      row = {.p0 = t->p0,
             .edge1 = t->edge1,
             .edge2 = t->edge2,
             .ng = t->ng,
             .p_error = t->p_error,
             .radiance = t->radiance,
             .pdf_area = t->pdf_area,
             .two_sided = t->two_sided ? 1.0f : 0.0f,
             .flat = 1,
             .triangle = 1};
    } else if (const auto* q = std::get_if<QuadLight>(&light)) {
      row = {.p0 = q->corner,
             .edge1 = q->edge1,
             .edge2 = q->edge2,
             .ng = q->ng,
             .p_error = q->p_error,
             .center = q->corner + (q->edge1 + q->edge2) * 0.5f,
             .near2 = q->near2,
             .radiance = q->radiance,
             .pdf_area = q->pdf_area,
             .two_sided = q->two_sided ? 1.0f : 0.0f,
             .flat = 1};
    }
    return row;
  }

  std::vector<Row> rows_;
};

}  // namespace strata
