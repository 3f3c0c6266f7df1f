#pragma once

#include "common/bundle.h"

namespace strata {

/// What benches turn off to show its worth.
struct BuildOptions {
  LightSelection selection = LightSelection::kTree;  ///< If the job says nothing else.
  bool quads = true;            ///< Two triangles that make a parallelogram are one light.
  bool solid_angle = true;      ///< Near rectangles and triangles are sampled by solid angle.
  bool sphere_cones = true;     ///< Spheres are sampled in the cone they fill.
  bool compensate = true;       ///< Environment images are sampled where they are above their mean.
  bool mirrors = true;          ///< Paths are guided to images of lamps in metal rectangles.
  bool balls = true;            ///< Paths are guided through balls of glass to small lamps.
  bool near_lamps = true;       ///< In media paths are scattered near lamps more often.
  bool least_kernel = true;     ///< The fast kernel is compiled for what the scene needs.
  bool skip_background = true;  ///< Pixels that see nothing else are not traced.
  bool few_triangles = true;    ///< The fast kernel traces small scenes without a hierarchy.
};

}  // namespace strata
