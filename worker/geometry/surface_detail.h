#pragma once

#include "worker/geometry/geometry.h"
#include "worker/geometry/texture.h"
#include "worker/scene/description.h"

namespace strata {

/// `point` with the shading normal of a normal map or a bump map, and with the tangent that goes
/// with a bump (PBRT 10.5.2, 10.5.3). Bumps are differences over the texture's own step, forward in
/// u and v. The normal stays on the outer side: where the map would turn it beyond, the point is
/// returned as it is; and where it would be seen from behind along `wo` it is bent back as far as
/// that takes, so that no edge is seen there.
SurfacePoint ApplyDetail(const SurfaceDetail& detail, const TextureSet& textures,
                         const SurfaceDerivatives& derivatives, const SurfacePoint& point,
                         Vec3f wo);

}  // namespace strata
