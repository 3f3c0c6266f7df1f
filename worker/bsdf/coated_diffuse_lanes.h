#pragma once

#include <cstddef>

#include "worker/bsdf/base_row.h"
#include "worker/bsdf/bsdf_lanes.h"
#include "worker/math/elementary_lanes.h"
#include "worker/sampling/warp_lanes.h"

namespace strata {

/// CoatedDiffuseBsdfs side by side, each seen along a direction wo: the formulas of
/// coated_diffuse.h, with what depends on wo alone computed once.
class CoatedDiffuseLanes {
 public:
  CoatedDiffuseLanes() = default;
  /// `material` indexes `rows`, which have a coat where `mask` is set and outlive this.
  CoatedDiffuseLanes(const BaseRow* rows, IntLanes material, RgbLanes reflectance, Vec3Lanes wo,
                     MaskLanes mask)
      : first_(&rows->reflectance.r), row_(material * kStride & mask), side_(wo.z), wo_(wo) {
    const RowLanes internal_eta = GatherRows(first_ + 4, row_, mask),
                   depth_entering = GatherRows(first_ + 8, row_, mask),
                   alphas_escaping = GatherRows(first_ + 12, row_, mask);
    eta_ = internal_eta.v[3];
    optical_depth_ = {depth_entering.v[0], depth_entering.v[1], depth_entering.v[2]};
    clear_ = !Any(mask & ~IsBlack(optical_depth_));
    gray_ = !Any(
        mask & ~((optical_depth_.r == optical_depth_.g) & (optical_depth_.g == optical_depth_.b)));
    ggx_ = {alphas_escaping.v[0], alphas_escaping.v[1]};
    smooth_ = ggx_.IsSmooth();
    any_smooth_ = Any(mask & smooth_);
    any_rough_ = Any(mask & ~smooth_);
    const RgbLanes internal = {internal_eta.v[0], internal_eta.v[1], internal_eta.v[2]};
    base_ =
        reflectance * (kInvPi / (eta_ * eta_)) / (SameColor(Rgb::Gray(1)) - reflectance * internal);
    wo_.z = Abs(wo.z);
    o_ = Enter(wo_.z);
    const FloatLanes entering = depth_entering.v[3], escaping_path = alphas_escaping.v[2];
    base_albedo_ = base_ * (kPi * (1 - o_.reflectance) * entering) *
                   Transmittance([&] { return 1 / o_.cos_refracted + escaping_path; });
    const FloatLanes base_albedo = MaxComponent(base_albedo_);
    border_ = base_albedo > 0 ? o_.reflectance / (o_.reflectance + base_albedo) : SameFloat(1);
  }

  RgbLanes Albedo() const {
    return RgbLanes{o_.reflectance, o_.reflectance, o_.reflectance} + base_albedo_;
  }

  BsdfValueLanes EvalPdf(Vec3Lanes wi) const {
    const MaskLanes above = side_ * wi.z > 0;
    wi.z = Abs(wi.z);
    BsdfValueLanes value = Scatter(wi);
    value.f = Select(above, value.f, {});
    value.pdf = above ? value.pdf : FloatLanes{};
    return value;
  }

  /// `base_wi` is a direction with density cosine / pi about the normal, made of `u`.
  BsdfSampleLanes Sample(FloatLanes u_lobe, Vec2Lanes u, Vec3Lanes base_wi) const {
    const MaskLanes border = u_lobe < border_, delta = border & smooth_;
    Vec3Lanes wi = base_wi;
    if (Any(border)) {
      Vec3Lanes reflected = {-wo_.x, -wo_.y, wo_.z};
      if (any_rough_)
        reflected = Select(smooth_, reflected, Reflect(wo_, ggx_.SampleVisibleNormal(wo_, u)));
      wi = Select(border, reflected, base_wi);
    }
    const BsdfValueLanes value = Scatter(wi);
    const FloatLanes mirror_weight = o_.reflectance / border_;
    const FloatLanes pdf = delta ? border_ : value.pdf;
    const RgbLanes weight =
        Select(delta, {mirror_weight, mirror_weight, mirror_weight}, value.f * (1 / value.pdf));
    const MaskLanes valid = (side_ != 0) & (wi.z > 0) & (pdf > 0);
    wi.z = CopySign(wi.z, side_);
    return {wi, weight, pdf, delta, valid};
  }

 private:
  static constexpr int32_t kStride = sizeof(BaseRow) / sizeof(float);
  static constexpr int kBorder = offsetof(BaseRow, border) / sizeof(float);

  /// The refracted cosine is known unless all coats are clear and rough.
  struct Direction {
    FloatLanes reflectance = {}, cos_refracted = {};
  };
  Direction Enter(FloatLanes cos_theta) const {
    Direction direction;
    if (any_smooth_) {
      const DielectricFresnelOf<FloatLanes> fresnel = FresnelDielectric(cos_theta, eta_);
      direction = {fresnel.reflectance, fresnel.cos_refracted};
    } else if (!clear_) {
      direction.cos_refracted = CosRefracted(cos_theta, eta_);
    }
    if (any_rough_)
      direction.reflectance = smooth_ ? direction.reflectance : RoughReflectance(cos_theta);
    return direction;
  }

  FloatLanes RoughReflectance(FloatLanes cos_theta) const {
    constexpr int kCells = AlbedoTable::kCosines - 1;
    const FloatLanes scaled = Sqrt(Min(cos_theta, SameFloat(1))) * static_cast<float>(kCells);
    const IntLanes whole = ToInt(scaled);
    const IntLanes cell = whole < kCells ? whole : SameInt(kCells - 1);
    const RowLanes ends = GatherRows(first_ + kBorder, row_ + cell, cell >= 0);
    return ends.v[0] + (ends.v[1] - ends.v[0]) * (scaled - ToFloat(cell));
  }

  /// Along paths of `path_length()` times the coat's thickness.
  template <typename PathLength>
  RgbLanes Transmittance(PathLength path_length) const {
    if (clear_) return SameColor(Rgb::Gray(1));
    const FloatLanes length = path_length();
    const auto through = [length](FloatLanes depth) {
      return depth == 0 ? SameFloat(1) : Exp(-depth * length);
    };
    const FloatLanes r = through(optical_depth_.r);
    if (gray_) return {r, r, r};
    return {r, through(optical_depth_.g), through(optical_depth_.b)};
  }

  /// As coated_diffuse_detail::Scatter.
  BsdfValueLanes Scatter(Vec3Lanes wi) const {
    const Direction i = Enter(wi.z);
    BsdfValueLanes value;
    value.f = base_ * ((1 - o_.reflectance) * (1 - i.reflectance) * wi.z) *
              Transmittance([&] { return 1 / o_.cos_refracted + 1 / i.cos_refracted; });
    value.pdf = (1 - border_) * (Max(FloatLanes{}, wi.z) * kInvPi);
    if (!any_rough_) return value;
    const Vec3Lanes m = Normalize(wo_ + wi);
    const FloatLanes fresnel =
        FresnelDielectric(Min(AbsDot(wo_, m), SameFloat(1)), eta_).reflectance;
    const FloatLanes f = fresnel * ggx_.D(m) * ggx_.VisibilityOver4(wo_, wi) * wi.z;
    const FloatLanes pdf = border_ * (0.25f * ggx_.VisibleNormalPdfOverCos(wo_, m));
    value.f = Select(smooth_, value.f, value.f + RgbLanes{f, f, f});
    value.pdf = smooth_ ? value.pdf : value.pdf + pdf;
    return value;
  }

  const float* first_ = nullptr;
  IntLanes row_ = {};  ///< Offsets of the rows.
  FloatLanes side_ = {};
  Vec3Lanes wo_;  ///< Above the surface.
  FloatLanes eta_ = {};
  RgbLanes optical_depth_, base_, base_albedo_;
  bool clear_ = false, gray_ = false;  ///< All optical depths are 0, or gray.
  GgxOf<FloatLanes> ggx_;
  MaskLanes smooth_ = {};
  bool any_smooth_ = false, any_rough_ = false;
  Direction o_;
  FloatLanes border_ = {};  ///< Part of samples that go to the border's reflection.
};

}  // namespace strata
