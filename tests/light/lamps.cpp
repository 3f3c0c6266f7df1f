#include "tests/light/lamps.h"

#include "tests/statistics/random.h"
#include "worker/math/elementary.h"

namespace strata {

SceneDescription ManyLamps(int count, uint64_t seed) {
  TestRandom random(seed);
  SceneDescription scene;
  for (int i = 0; i < count; ++i) {
    const auto coordinate = [&] { return 10 * random.Double() - 5; };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    const double u = coordinate(), v = coordinate(), w = coordinate();
    const Transform place =
        Transform::Translate(x, y, z) * Transform::Rotate(360 * random.Double(), u, v, w);
    if (i % 5 == 4) {
      scene.lights.push_back({{}, PointLightDescription{place.Point({0, 0, 0}), {1, 2, 3}}});
      continue;
    }
    ShapeDescription shape;
    TriangleMeshShape mesh;
    mesh.positions = {{-0.1f, -0.1f, 0}, {0.1f, -0.1f, 0}, {0.1f, 0.1f, 0}, {-0.1f, 0.1f, 0}};
    mesh.triangles = {{0, 1, 2}};
    if (i % 5 == 1) mesh.triangles.push_back({0, 2, 3});
    shape.geometry = mesh;
    if (i % 5 == 2) shape.geometry = SphereShape{.radius = 0.2f, .z_min = -0.2f, .z_max = 0.2f};
    if (i % 5 == 3) shape.geometry = DiskShape{.radius = 0.3f};
    shape.to_world = place;
    const float radiance = Exp(static_cast<float>(4 * random.Double() - 2));
    shape.emission = AreaEmission{Rgb::Gray(radiance), random.Double() < 0.3};
    scene.shapes.push_back(shape);
  }
  return scene;
}

}  // namespace strata
