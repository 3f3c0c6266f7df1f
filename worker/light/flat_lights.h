#pragma once

#include <array>
#include <vector>

#include "worker/geometry/geometry_lanes.h"
#include "worker/light/light.h"
#include "worker/light/light_lanes.h"
#include "worker/math/lanes.h"
#include "worker/sampling/spherical_rectangle.h"
#include "worker/sampling/warp_lanes.h"

namespace strata {

/// The triangles and parallelograms among some lights as rows of numbers, from which eight are
/// sampled at once.
class FlatLights {
 public:
  FlatLights() = default;
  explicit FlatLights(const std::vector<Light>& lights) {
    for (const Light& light : lights) rows_.push_back(RowOf(light));
  }

  /// Samples lights[light] from `from` in those lanes of `mask` where it is flat, and no triangle
  /// that is near; returns them.
  MaskLanes Sample(IntLanes light, Vec3Lanes from, Vec2Lanes u, MaskLanes mask,
                   LightSampleLanes* sample) const {
    const auto row = [&](const Quad Row::*member) {
      const float* base = (rows_.front().*member).data();
      if (rows_.size() == 1) {
        return RowLanes{SameFloat(base[0]), SameFloat(base[1]), SameFloat(base[2]),
                        SameFloat(base[3])};
      }
      return GatherRows(base, light * static_cast<int32_t>(sizeof(Row) / sizeof(float)), mask);
    };
    const auto vector = [](const RowLanes& v) { return Vec3Lanes{v.v[0], v.v[1], v.v[2]}; };
    const RowLanes corner_near2 = row(&Row::corner_near2), edge1_scale = row(&Row::edge1_scale),
                   edge2_scale = row(&Row::edge2_scale);
    const Vec3Lanes corner = vector(corner_near2), edge1 = vector(edge1_scale),
                    edge2 = vector(edge2_scale);
    const FloatLanes scale1 = edge1_scale.v[3], scale2 = edge2_scale.v[3];
    MaskLanes done = mask & (scale1 != 0);
    const MaskLanes triangle = scale1 < 0;
    const Vec3Lanes center =
        corner + (edge1 + edge2) * (triangle ? SameFloat(1.0f / 3) : SameFloat(0.5f));
    MaskLanes near = done & (LengthSquared(center - from) < corner_near2.v[3]);
    done &= ~(near & triangle);
    near &= done;
    if (!Any(done)) return done;
    const RowLanes ng_pdf = row(&Row::ng_pdf), radiance_offset = row(&Row::radiance_offset);
    const Vec2Lanes corner_weights = SampleTriangle(u);
    u = {triangle ? corner_weights.x : u.x, triangle ? corner_weights.y : u.y};
    FloatLanes solid_angle = {};
    if (Any(near)) {
      const SphericalRectangleOf<FloatLanes> rectangle(
          corner, edge1, scale1, edge2, scale2, vector(ng_pdf), Sqrt(Abs(ng_pdf.v[3])), from);
      const Vec2Lanes parts = rectangle.Sample(u);
      u = {near ? parts.x : u.x, near ? parts.y : u.y};
      solid_angle = rectangle.solid_angle;
    }
    const Vec3Lanes p = corner + Fma(edge1, u.x, edge2 * u.y);
    const Vec3Lanes ng = vector(ng_pdf);
    const Vec3Lanes to_light = p - from;
    const FloatLanes distance2 = LengthSquared(to_light);
    const Vec3Lanes wi = to_light * (1 / Sqrt(distance2));
    const FloatLanes cosine = Dot(ng, wi);
    const MaskLanes shines = (ng_pdf.v[3] < 0) | (cosine < 0);
    const RgbLanes radiance = {radiance_offset.v[0], radiance_offset.v[1], radiance_offset.v[2]};
    const FloatLanes pdf_near = solid_angle > 0 ? 1 / solid_angle : FloatLanes{};
    const FloatLanes pdf = near ? pdf_near : Abs(ng_pdf.v[3]) * distance2 / Abs(cosine);
    sample->wi = Select(done, wi, sample->wi);
    sample->radiance = Select(done, radiance, sample->radiance);
    sample->pdf = done ? pdf : sample->pdf;
    sample->end =
        Select(done, OffsetRayOrigins(p, radiance_offset.v[3], ng, -to_light), sample->end);
    sample->valid |=
        done & shines & (distance2 > 0) & (near | (cosine != 0)) & (pdf > 0) & ~IsBlack(radiance);
    return done;
  }

 private:
  using Quad = std::array<float, 4>;
  /// A vector and what else is asked of the light, in fours for GatherRows.
  struct Row {
    Quad corner_near2 = {};  ///< See QuadLight and TriangleLight.
    /// And their RectangleScales. The first is negative in triangles, where neither is asked for,
    /// and 0 if the light is none of those that are sampled here.
    Quad edge1_scale = {}, edge2_scale = {};
    Quad ng_pdf = {};           ///< pdf_area, negative if it shines to both sides.
    Quad radiance_offset = {};  ///< Of points on it, for OffsetRayOrigins.
  };

  static Quad With(Vec3f v, float last = 0) { return {v.x, v.y, v.z, last}; }
  static Row RowOf(const Light& light) {
    const auto row_of = [](const auto& l, Vec3f corner, float scale1, float scale2) {
      return Row{.corner_near2 = With(corner, l.near2),
                 .edge1_scale = With(l.edge1, scale1),
                 .edge2_scale = With(l.edge2, scale2),
                 .ng_pdf = With(l.ng, l.two_sided ? -l.pdf_area : l.pdf_area),
                 .radiance_offset = {l.radiance.r, l.radiance.g, l.radiance.b, l.offset}};
    };
    if (const auto* t = std::get_if<TriangleLight>(&light)) return row_of(*t, t->p0, -1, 0);
    const auto* q = std::get_if<QuadLight>(&light);
    if (!q) return {};
    return row_of(*q, q->corner, q->scale1, q->scale2);
  }

  std::vector<Row> rows_;
};

}  // namespace strata
