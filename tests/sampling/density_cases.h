#pragma once

#include <vector>

#include "common/job.h"
#include "tests/statistics/plane_test.h"

namespace strata {

// Every sampling routine of worker/sampling as a case of TestPlane. Tilts are cos(2 pi u), with u a
// number that the routine's inverse gives back, or a cosine of an angle where there is none.

std::vector<PlaneCase> OneDimensionalCases();
std::vector<PlaneCase> PlanarCases();       ///< Squares, disks and triangles.
std::vector<PlaneCase> DirectionalCases();  ///< Spheres and parts of them, lobes.
std::vector<PlaneCase> FilterCases();       ///< Of TestedFilters.

/// Filters of all kinds.
std::vector<FilterSpec> TestedFilters();

}  // namespace strata
