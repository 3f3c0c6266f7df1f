#pragma once

#include "worker/gltf/document.h"

namespace strata {

/// Adds the KHR_lights_punctual light that the node `element` has, if it has one, placed by
/// `to_world`: it shines along -z, and only directions and the place of its origin count.
///
/// Units are photometric in glTF (candela, lux, nits) and radiometric here; one is taken for the
/// other, as pbrt-v4 takes the luminance of an RGB light for 1. So a light of 1 lux makes an
/// irradiance of 1, one of 1 candela an intensity of 1, an emissive surface of 1 nit a radiance of
/// 1: the picture shows nits.
absl::Status AddLight(GltfDocument& document, const tinygltf::Node& node, const Transform& to_world,
                      const std::string& element);

}  // namespace strata
