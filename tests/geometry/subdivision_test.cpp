#include "worker/geometry/loop_subdivision.h"

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"

namespace strata::testing {
namespace {

TriangleMeshShape Subdivided(const TriangleMeshShape& control, int levels) {
  absl::StatusOr<TriangleMeshShape> mesh = LoopSubdivide(control, levels);
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return mesh.ok() ? *std::move(mesh) : TriangleMeshShape{};
}

TriangleMeshShape Octahedron() {
  TriangleMeshShape mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

TriangleMeshShape Tetrahedron() {
  TriangleMeshShape mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return mesh;
}

/// A grid of n x n squares over [0, n]^2, each of two triangles, with heights.
template <typename Height>
TriangleMeshShape Grid(int n, Height height) {
  TriangleMeshShape mesh;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x)
      mesh.positions.push_back(ToFloat({double(x), double(y), height(x, y)}));
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const auto at = [&](int i, int j) {
        return static_cast<uint32_t>((y + j) * (n + 1) + x + i);
      };
      mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  }
  return mesh;
}

int Edges(const TriangleMeshShape& mesh) {
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) edges.insert(std::minmax(t[i], t[(i + 1) % 3]));
  }
  return static_cast<int>(edges.size());
}

TEST(LoopSubdivision, EachLevelPartsEveryFaceInFourAndKeepsTheTopology) {
  for (const TriangleMeshShape& control : {Octahedron(), Tetrahedron(), SphereMesh(5)}) {
    for (int level = 0; level < 4; ++level) {
      const TriangleMeshShape mesh = Subdivided(control, level);
      EXPECT_EQ(mesh.triangles.size(), control.triangles.size() << (2 * level));
      std::set<uint32_t> used;
      for (const auto& t : mesh.triangles) used.insert(t.begin(), t.end());
      EXPECT_EQ(
          static_cast<int>(used.size()) - Edges(mesh) + static_cast<int>(mesh.triangles.size()), 2);
    }
  }
  const TriangleMeshShape sheet = Subdivided(Grid(3, [](int, int) { return 0.0; }), 2);
  EXPECT_EQ(static_cast<int>(sheet.positions.size()) - Edges(sheet) +
                static_cast<int>(sheet.triangles.size()),
            1);
}

TEST(LoopSubdivision, APlaneStaysAPlane) {
  const auto height = [](int x, int y) { return 0.25 * x - 0.5 * y + 1; };
  const Vec3d normal = Normalize(Vec3d{-0.25, 0.5, 1});
  for (int level = 0; level < 4; ++level) {
    const TriangleMeshShape mesh = Subdivided(Grid(4, height), level);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3f p = mesh.positions[i];
      EXPECT_NEAR(p.z, 0.25 * p.x - 0.5 * p.y + 1, 1e-5);
      EXPECT_GT(Dot(ToDouble(mesh.normals[i]), normal), 1 - 1e-6) << i;
    }
  }
}

/// Away from borders and extraordinary vertices the surface is a box spline, which turns samples of
/// a quadratic into that quadratic plus a constant.
TEST(LoopSubdivision, ARegularGridOfAParabolaIsOne) {
  const auto height = [](int x, int y) { return 0.1 * x * x - 0.05 * x * y + 0.02 * y * y; };
  // The limit lies above a sample by 1/12 of the sum of the second differences in the grid's three
  // directions.
  const double second = 2 * 0.1 + 2 * 0.02 + 2 * (0.1 - 0.05 + 0.02);
  const double lift = second / 12;
  int inner = 0;
  for (int level = 0; level < 4; ++level) {
    const TriangleMeshShape mesh = Subdivided(Grid(10, height), level);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3d p = ToDouble(mesh.positions[i]);
      if (std::min({p.x, p.y, 10 - p.x, 10 - p.y}) < 2.5) continue;
      ++inner;
      EXPECT_NEAR(p.z, 0.1 * p.x * p.x - 0.05 * p.x * p.y + 0.02 * p.y * p.y + lift, 1e-5);
      const Vec3d normal =
          Normalize(Vec3d{-(0.2 * p.x - 0.05 * p.y), -(0.04 * p.y - 0.05 * p.x), 1});
      EXPECT_GT(Dot(ToDouble(mesh.normals[i]), normal), 1 - 1e-6);
    }
  }
  EXPECT_GT(inner, 1000);
}

/// The limits of vertices are known without subdivision, and each level finds the same ones.
TEST(LoopSubdivision, ExtraordinaryVerticesTendToTheirLimits) {
  for (int level = 0; level < 5; ++level) {
    // Four neighbours that sum to 0: gamma is 1/8, and half of the vertex is left.
    const TriangleMeshShape octahedron = Subdivided(Octahedron(), level);
    for (int i = 0; i < 6; ++i) {
      EXPECT_LT(Length(octahedron.positions[i] - Octahedron().positions[i] * 0.5f), 1e-6f);
      EXPECT_GT(Dot(octahedron.normals[i], Octahedron().positions[i]), 1 - 1e-6f);
    }
    // Three that sum to the opposite of it: gamma is 1/5, and 2/5 - 1/5 is left.
    const TriangleMeshShape tetrahedron = Subdivided(Tetrahedron(), level);
    for (int i = 0; i < 4; ++i)
      EXPECT_LT(Length(tetrahedron.positions[i] - Tetrahedron().positions[i] * 0.2f), 1e-6f);
  }
}

/// A fan of `n` faces with its middle raised: every valence, and a border.
TEST(LoopSubdivision, AnyValenceAndItsBorder) {
  for (int n = 3; n < 12; ++n) {
    TriangleMeshShape fan;
    fan.positions = {{0, 0, 1}};
    for (int i = 0; i < n; ++i) {
      const double phi = 2 * M_PI * i / n;
      fan.positions.push_back(ToFloat({std::cos(phi), std::sin(phi), 0}));
      fan.triangles.push_back(
          {0, static_cast<uint32_t>(1 + i), static_cast<uint32_t>(1 + (i + 1) % n)});
    }
    const double beta = n == 3 ? 3.0 / 16 : 3.0 / (8 * n);
    const double expected = 1 - n / (n + 3 / (8 * beta));
    for (int level = 0; level < 3; ++level) {
      const TriangleMeshShape mesh = Subdivided(fan, level);
      EXPECT_NEAR(mesh.positions[0].z, expected, 1e-6) << n;
      EXPECT_GT(mesh.normals[0].z, 1 - 1e-6f);
      // The border is a cubic B-spline of its own vertices: (p- + 4 p + p+) / 6.
      EXPECT_NEAR(Length(mesh.positions[1]), (2 + std::cos(2 * M_PI / n)) / 3, 1e-6) << n;
      for (const Vec3f& p : mesh.positions) EXPECT_GE(p.z, -1e-6f);
      for (const Vec3f& normal : mesh.normals) EXPECT_GT(normal.z, 0);
    }
  }
}

TEST(LoopSubdivision, NormalsAreThoseOfTheFinerAndFinerFaces) {
  const TriangleMeshShape mesh = Subdivided(Tetrahedron(), 6);
  double worst = 1;
  for (const auto& t : mesh.triangles) {
    const Vec3f ng = Normalize(Cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                     mesh.positions[t[2]] - mesh.positions[t[0]]));
    for (const uint32_t v : t) worst = std::min<double>(worst, Dot(ng, mesh.normals[v]));
  }
  EXPECT_GT(worst, 0.99);
}

TEST(LoopSubdivision, RefusesWhatIsNoSurface) {
  const auto message = [](TriangleMeshShape mesh, int levels = 1) {
    return std::string(LoopSubdivide(mesh, levels).status().message());
  };
  TriangleMeshShape mesh = Octahedron();
  mesh.triangles.push_back({0, 2, 1});
  EXPECT_NE(message(mesh).find("more than two faces"), std::string::npos);
  mesh = Octahedron();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_NE(message(mesh).find("oriented alike"), std::string::npos);
  mesh.positions.resize(5);
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_NE(message(mesh).find("meet in vertex 0 alone"), std::string::npos);
  mesh.triangles = {{0, 1, 7}};
  EXPECT_NE(message(mesh).find("vertex 7"), std::string::npos);
  mesh.triangles = {{0, 1, 1}};
  EXPECT_NE(message(mesh).find("twice"), std::string::npos);
  EXPECT_NE(message(Octahedron(), 20).find("fewer levels"), std::string::npos);
}

}  // namespace
}  // namespace strata::testing
