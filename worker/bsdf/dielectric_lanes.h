#pragma once

#include "worker/bsdf/bsdf_lanes.h"
#include "worker/bsdf/fresnel.h"

namespace strata {

struct SmoothDielectricSampleLanes : BsdfSampleLanes {
  FloatLanes eta2 = {};  ///< Squared index behind over before the surface; 1 where reflected.
};

/// Sample of smooth DielectricBsdfs side by side, whose indices are `eta`.
inline SmoothDielectricSampleLanes SampleSmoothDielectric(FloatLanes eta, Vec3Lanes wo,
                                                          FloatLanes u_lobe) {
  eta = wo.z > 0 ? eta : 1 / eta;
  const FloatLanes one = SameFloat(1), upper_z = Abs(wo.z), cos_o = Min(upper_z, one);
  const DielectricFresnelOf<FloatLanes> fresnel = FresnelDielectric(cos_o, eta);
  const MaskLanes transmission = u_lobe >= fresnel.reflectance;
  const FloatLanes inverse = 1 / eta;
  const FloatLanes refracted_z = (cos_o / eta - fresnel.cos_refracted) - upper_z * inverse;

  SmoothDielectricSampleLanes sample;
  const FloatLanes scale = transmission ? -inverse : -one;
  sample.wi = {wo.x * scale, wo.y * scale, transmission ? refracted_z : upper_z};
  sample.valid = (cos_o > 0) & (transmission ? sample.wi.z < 0 : sample.wi.z > 0);
  sample.wi.z = wo.z < 0 ? -sample.wi.z : sample.wi.z;
  sample.eta2 = transmission ? eta * eta : one;
  const FloatLanes weight = 1 / sample.eta2;
  sample.weight = {weight, weight, weight};
  sample.pdf = transmission ? 1 - fresnel.reflectance : fresnel.reflectance;
  sample.delta = SameInt(-1);
  return sample;
}

}  // namespace strata
