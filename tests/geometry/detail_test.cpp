#include <gtest/gtest.h>

#include <cmath>

#include "common/image_file.h"
#include "tests/geometry/scene_builder.h"
#include "worker/geometry/surface_detail.h"

// Derivatives of surfaces against differences, and normal and bump maps against normals worked out
// by hand.

namespace strata::testing {
namespace {

/// Meshes, patches and quadrics with whatever they may have.
std::vector<ShapeGeometry> ShapesWithDerivatives() {
  TriangleMeshShape mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0.3f}, {1, 1, -0.2f}, {-1, 1, 0.1f}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  TriangleMeshShape smooth = mesh;
  smooth.uvs = {{0, 0}, {0.2f, 2}, {2, 1.5f}, {1, 0}};
  smooth.normals = {{0.3f, 0, 1}, {0, 0.4f, 1}, {-0.2f, 0, 1}, {0, -0.3f, 1}};
  BilinearPatchShape patch;
  patch.positions = {{-1, -1, 0}, {1, -1, 0.5f}, {-1, 1, 0.3f}, {1, 1, -0.4f}};
  patch.patches = {{0, 1, 2, 3}};
  patch.normals = smooth.normals;
  BilinearPatchShape mapped = patch;
  mapped.uvs = {{0, 0}, {1, 0.2f}, {0.1f, 2}, {1.5f, 2}};
  return {mesh,
          smooth,
          patch,
          mapped,
          SphereShape{1, -0.8f, 0.9f, 300},
          DiskShape{0, 1, 0.2f, 360},
          CylinderShape{1, -1, 1, 270}};
}

struct Seen {
  SurfacePoint point;
  SurfaceDerivatives derivatives;
  uint32_t primitive = 0;
};
std::optional<Seen> See(const Geometry& geometry, Vec3d origin, Vec3d direction) {
  const Ray ray = MakeRay(origin, direction);
  Hit hit;
  if (!geometry.Intersect(ray, &hit)) return std::nullopt;
  return Seen{geometry.Surface(ray, hit), geometry.Derivatives(ray, hit), hit.primitive};
}

/// How far point and normal move to a near point, and by how much the derivatives, of which the
/// mean of both ends is right to the second order, miss that.
struct Prediction {
  float p_moved, p_error, n_moved, n_error;
};
Prediction Predict(const Seen& here, const Seen& there) {
  const Vec3f dp = there.point.p - here.point.p, dn = there.point.ns - here.point.ns;
  const float du = there.point.uv.x - here.point.uv.x, dv = there.point.uv.y - here.point.uv.y;
  const auto mean = [](Vec3f a, Vec3f b) { return (a + b) * 0.5f; };
  const SurfaceDerivatives &a = here.derivatives, &b = there.derivatives;
  const Vec3f p = mean(a.dpdu, b.dpdu) * du + mean(a.dpdv, b.dpdv) * dv;
  const Vec3f n = mean(a.dndu, b.dndu) * du + mean(a.dndv, b.dndv) * dv;
  return {Length(dp), Length(p - dp), Length(dn), Length(n - dn)};
}

/// What the derivatives say of a near point, against that point. With `instances`, the shape is an
/// object, shared by them.
void CheckDerivatives(const ShapeGeometry& shape, int instances, uint64_t seed) {
  Random random(seed);
  const Transform to_world = RandomAffine(random);
  SceneDescription scene = EmptyScene();
  if (instances == 0) {
    scene.shapes.push_back(Shape(shape, to_world));
  } else {
    scene.objects.push_back(ObjectOf({Shape(shape, RandomAffine(random))}));
    for (int i = 0; i < instances; ++i) scene.instances.push_back(InstanceOf(0, to_world));
  }
  const auto geometry = MustBuild(scene);
  const Geometry::Bounds bounds = geometry->bounds();
  const Vec3d center = (ToDouble(bounds.min) + ToDouble(bounds.max)) * 0.5;
  const double size = Length(ToDouble(bounds.max) - ToDouble(bounds.min));
  int compared = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3d origin = center + UnitVector(random) * size;
    const Vec3d direction =
        Normalize(center + UnitVector(random) * (0.3 * size * Uniform(random)) - origin);
    const auto here = See(*geometry, origin, direction);
    if (!here) continue;
    // Grazing rays end far from each other.
    if (std::fabs(Dot(ToDouble(here->point.ng), direction)) < 0.2) continue;
    const Vec3d turn = UnitVector(random) * 3e-3;
    const auto there = See(*geometry, origin, Normalize(direction + turn));
    const auto halfway = See(*geometry, origin, Normalize(direction + turn * 0.5));
    if (!there || !halfway) continue;
    if (there->primitive != here->primitive || halfway->primitive != here->primitive) continue;
    // The other side, or across a seam.
    if (Length(there->point.p - here->point.p) > 0.1 * size) continue;
    if (std::fabs(there->point.uv.x - here->point.uv.x) > 0.3f ||
        std::fabs(there->point.uv.y - here->point.uv.y) > 0.3f)
      continue;
    if (Dot(there->point.ng, here->point.ng) < 0.5f) continue;
    ++compared;
    const Prediction whole = Predict(*here, *there), half = Predict(*here, *halfway);
    // Of half the step a wrong derivative leaves half of the error. A right one, whose error is of
    // the third order, leaves an eighth, of which twice as much is allowed for higher orders.
    const auto fits = [](float error, float moved, float error_of_half, float rounding) {
      return error < 0.02f * moved + rounding || error_of_half < error / 4 + rounding;
    };
    EXPECT_TRUE(fits(whole.p_error, whole.p_moved, half.p_error, 1e-5f * static_cast<float>(size)))
        << whole.p_error << " of " << whole.p_moved << ", half way " << half.p_error;
    EXPECT_TRUE(fits(whole.n_error, whole.n_moved, half.n_error, 2e-5f))
        << whole.n_error << " of " << whole.n_moved << ", half way " << half.n_error;
    const SurfaceDerivatives& a = here->derivatives;
    EXPECT_LT(Length(a.dpdu - here->point.dpdu), 1e-4f * Length(a.dpdu));
  }
  EXPECT_GT(compared, 30);
}

TEST(Derivatives, PredictNearPoints) {
  uint64_t seed = 1;
  int number = 0;
  for (const ShapeGeometry& shape : ShapesWithDerivatives()) {
    SCOPED_TRACE(number++);
    for (int i = 0; i < 4; ++i) CheckDerivatives(shape, 0, seed++);
    for (int i = 0; i < 4; ++i) CheckDerivatives(shape, 2, seed++);
  }
}

// ---- normal and bump maps ----

class Images : public FileSource {
 public:
  Images() : root_(std::filesystem::path(::testing::TempDir()) / "strata_detail_test") {
    std::filesystem::create_directories(root_);
  }
  ~Images() override { std::filesystem::remove_all(root_); }
  absl::StatusOr<std::filesystem::path> Locate(const std::string& path) const override {
    return root_ / path;
  }
  /// Heights of slope `u` along the first texture coordinate and `v` along the second, per unit.
  void WriteRamp(const std::string& name, int size, double u, double v) const {
    ImageLayers image;
    image.full_width = image.full_height = size;
    image.crop = {0, 0, size, size};
    image.channels = {"R", "G", "B"};
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const double height = u * (x + 0.5) / size + v * (1 - (y + 0.5) / size);
        image.values.insert(image.values.end(), 3, static_cast<float>(height));
      }
    }
    const absl::Status status = WriteExr(root_ / name, image);
    ASSERT_TRUE(status.ok()) << status;
  }

 private:
  std::filesystem::path root_;
};

std::unique_ptr<TextureSet> MustLoad(const std::vector<TextureDescription>& textures,
                                     const FileSource& source = Images()) {
  auto set = TextureSet::Load(textures, source);
  EXPECT_TRUE(set.ok()) << set.status();
  return set.ok() ? std::move(*set) : nullptr;
}

/// The plane z = 0 seen from above, u along x over a length of 2 and v along y over one of 3.
struct Plane {
  SurfacePoint point;
  SurfaceDerivatives derivatives;

  Plane() {
    point.ng = point.ns = {0, 0, 1};
    point.uv = {0.4f, 0.6f};
    point.dpdu = derivatives.dpdu = {2, 0, 0};
    derivatives.dpdv = {0, 3, 0};
  }
  Vec3f Normal(const SurfaceDetail& detail, const TextureSet& textures,
               Vec3f wo = {0, 0, 1}) const {
    return ApplyDetail(detail, textures, derivatives, point, wo).ns;
  }
};

void ExpectNear(Vec3f a, Vec3f b, float tolerance = 1e-5f) {
  EXPECT_LT(Length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << ", expected " << b.x << " " << b.y << " " << b.z;
}

TEST(NormalMaps, TurnTheNormalInTheTangentFrame) {
  const auto set =
      MustLoad({ConstantTexture{{0.5f, 0.5f, 1}}, ConstantTexture{{0.8f, 0.4f, 0.9f}}});
  const Plane plane;
  ExpectNear(plane.Normal({.normal_map = 0}, *set), {0, 0, 1});
  ExpectNear(plane.Normal({.normal_map = 1}, *set), Normalize(Vec3f{0.6f, -0.2f, 0.8f}));
  ExpectNear(plane.Normal({.normal_map = 1, .normal_scale = 2}, *set),
             Normalize(Vec3f{1.2f, -0.4f, 0.8f}));
  // The tangent is brought into the plane of the normal; lengths do not matter.
  Plane oblique;
  oblique.point.dpdu = {0, 7, 2};
  ExpectNear(oblique.Normal({.normal_map = 1}, *set), Normalize(Vec3f{0.2f, 0.6f, 0.8f}));
}

TEST(NormalMaps, MayFollowMirroredTextures) {
  const auto set = MustLoad({ConstantTexture{{0.8f, 0.4f, 0.9f}}});
  Plane mirrored;
  mirrored.derivatives.dpdv = {0, -3, 0};
  ExpectNear(mirrored.Normal({.normal_map = 0}, *set), Normalize(Vec3f{0.6f, -0.2f, 0.8f}));
  ExpectNear(mirrored.Normal({.normal_map = 0, .y_along_v = true}, *set),
             Normalize(Vec3f{0.6f, 0.2f, 0.8f}));
}

TEST(NormalMaps, KeepTheNormalOutside) {
  const auto set =
      MustLoad({ConstantTexture{{0.9f, 0.5f, 0.2f}}, ConstantTexture{{1, 0.5f, 0.6f}}});
  const Plane plane;
  // It would point below the plane.
  ExpectNear(plane.Normal({.normal_map = 0}, *set), {0, 0, 1});
  // Seen from where it is just hidden, from above and, since surfaces have two sides, from below.
  const Vec3f wo = Normalize(Vec3f{-1, 0, 0.1f});
  for (const Vec3f viewer : {wo, -wo}) {
    const Vec3f n = plane.Normal({.normal_map = 1}, *set, viewer);
    EXPECT_GT(Dot(n, viewer) * Dot(plane.point.ng, viewer), 0);
    EXPECT_GT(n.x, 0.05f);
    EXPECT_GT(n.z, 0);
  }
}

TEST(BumpMaps, AreTheSlopeOfTheHeight) {
  const Images images;
  images.WriteRamp("ramp.exr", 16, 0.5, -0.75);
  ImageTexture image{"ramp.exr"};
  image.scalar = true;
  const auto set = MustLoad({image}, images);
  const Plane plane;
  // Over lengths of 2 and 3 the slopes are 0.25 and -0.25.
  ExpectNear(plane.Normal({.displacement = 0}, *set), Normalize(Vec3f{-0.25f, 0.25f, 1}), 1e-4f);
  const SurfacePoint turned =
      ApplyDetail({.displacement = 0}, *set, plane.derivatives, plane.point, {0, 0, 1});
  ExpectNear(turned.dpdu, {2, 0, 0.5f}, 1e-4f);
  // Repeated four times and twice as high.
  image.mapping.su = 4;
  image.scale = 2;
  const auto repeated = MustLoad({image}, images);
  ExpectNear(plane.Normal({.displacement = 0}, *repeated), Normalize(Vec3f{-2, 0.5f, 1}), 1e-3f);
}

TEST(BumpMaps, OfOneHeightLeaveASphereAlone) {
  // Its parallel surfaces are spheres.
  const auto set = MustLoad({ConstantTexture{Rgb::Gray(0.2f)}});
  Random random(3);
  const auto geometry = MustBuild(Shape(SphereShape{}, RandomSimilarity(random)));
  const Geometry::Bounds bounds = geometry->bounds();
  const Vec3d center = (ToDouble(bounds.min) + ToDouble(bounds.max)) * 0.5;
  for (int i = 0; i < 50; ++i) {
    const Vec3d away = UnitVector(random);
    const auto seen =
        See(*geometry, center + away * 20, Normalize(UnitVector(random) * 0.2 - away * 20));
    ASSERT_TRUE(seen.has_value());
    ExpectNear(
        ApplyDetail({.displacement = 0}, *set, seen->derivatives, seen->point, ToFloat(away)).ns,
        seen->point.ns, 1e-4f);
  }
}

}  // namespace
}  // namespace strata::testing
