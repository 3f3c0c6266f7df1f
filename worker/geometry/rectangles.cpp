#include <array>
#include <optional>

#include "worker/geometry/geometry.h"
#include "worker/geometry/parallelogram.h"
#include "worker/geometry/state.h"

namespace strata {
namespace {

std::array<Vec3f, 3> CornersOf(const TriangleSet& set, size_t triangle) {
  const uint32_t* v = set.triangles[triangle].vertices;
  return {set.vertices[v[0]].p, set.vertices[v[1]].p, set.vertices[v[2]].p};
}

}  // namespace

std::vector<FlatRectangle> Geometry::Rectangles(
    const std::function<bool(MaterialId)>& wanted) const {
  std::vector<FlatRectangle> rectangles;
  const TriangleSet& set = state_->world.triangles;
  for (size_t i = 0; i + 1 < set.triangles.size(); ++i) {
    const uint32_t shape = set.triangles[i].shape;
    const MaterialId material = set.shapes[shape].material;
    if (set.triangles[i + 1].shape != shape || !wanted(material)) continue;
    const std::optional<Parallelogram> found =
        ParallelogramOf(CornersOf(set, i), CornersOf(set, i + 1));
    if (!found) continue;
    FlatRectangle r = {.corner = found->corner, .material = material};
    r.length1 = Length(found->edge1);
    r.length2 = Length(found->edge2);
    r.unit1 = found->edge1 / r.length1;
    r.unit2 = found->edge2 / r.length2;
    constexpr float kSquareEnough = 1e-3f;
    if (!(AbsDot(r.unit1, r.unit2) <= kSquareEnough)) continue;
    rectangles.push_back(r);
    ++i;
  }
  return rectangles;
}

}  // namespace strata
