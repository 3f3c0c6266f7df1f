#pragma once

#include <cstdint>

#include "worker/math/vec3d.h"
#include "worker/scene/description.h"

namespace strata {

/// Gradient noise of unit lattice cells (Perlin, "Improving Noise", 2002, with the table of its
/// reference and pbrt's choice of gradients: PBRT, 3rd ed., 10.6.1). Continuous, 0 at lattice
/// points, between -1.1 and 1.1; repeats every 256 units. 0 where `p` is not finite.
double Noise(Vec3d p);

/// The sum of `octaves` octaves of noise, each 1.99 times as fine as the one before and `roughness`
/// times as strong (PBRT, 3rd ed., 10.6.3). No octave is left out for being finer than a pixel.
double FractalNoise(Vec3d p, double roughness, int octaves);
/// The same of absolute values, as pbrt sums them.
double Turbulence(Vec3d p, double roughness, int octaves);

/// Of the textures of that name (PBRT, 3rd ed., 10.6.3 to 10.6.6), at a point in texture space.
Rgb EvalNoise(const NoiseTexture& texture, Vec3d p);

/// Whether a point lies in one of the random dots of pbrt's "dots" (PBRT, 3rd ed., 10.6.2): two in
/// five unit cells have one, of radius 0.35.
bool IsInDot(Vec2f st);

}  // namespace strata
