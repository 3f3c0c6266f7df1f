#pragma once

#include <cmath>

#include "worker/math/transform.h"
#include "worker/math/vec.h"

// Arithmetic of Vec3d, in which shapes are placed and curved ones are intersected.

namespace strata {

inline Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3d operator-(Vec3d a) { return {-a.x, -a.y, -a.z}; }
inline Vec3d operator*(Vec3d a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double Dot(Vec3d a, Vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3d Cross(Vec3d a, Vec3d b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double Length(Vec3d a) { return std::sqrt(Dot(a, a)); }
inline Vec3d Normalize(Vec3d a) { return a * (1 / Length(a)); }
inline Vec3d Lerp(double t, Vec3d a, Vec3d b) { return a * (1 - t) + b * t; }

inline Vec3d ToDouble(Vec3f v) { return {v.x, v.y, v.z}; }
inline Vec3f ToFloat(Vec3d v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace strata
