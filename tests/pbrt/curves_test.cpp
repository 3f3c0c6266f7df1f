#include <gtest/gtest.h>

#include <cmath>

#include "tests/pbrt/scene_folder.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

PbrtScene World(const std::string& text) {
  absl::StatusOr<PbrtScene> scene = ReadWorld(text);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *std::move(scene) : PbrtScene{};
}

CurveShape Curve(const std::string& parameters) {
  const PbrtScene scene = World("Shape \"curve\" " + parameters);
  const auto* curve = scene.scene.shapes.empty()
                          ? nullptr
                          : std::get_if<CurveShape>(&scene.scene.shapes[0].geometry);
  EXPECT_NE(curve, nullptr);
  return curve ? *curve : CurveShape{};
}

std::string Message(const std::string& parameters) {
  return std::string(ReadWorld("Shape \"curve\" " + parameters).status().message());
}

/// The point of segment `i` at u.
Vec3d At(const CurveShape& curve, size_t i, double u) {
  Vec3d p[4];
  for (int k = 0; k < 4; ++k) p[k] = ToDouble(curve.positions[curve.segments[i] + k]);
  for (int round = 3; round > 0; --round) {
    for (int k = 0; k < round; ++k) p[k] = Lerp(u, p[k], p[k + 1]);
  }
  return p[0];
}

void ExpectNear(Vec3d a, Vec3d b) { EXPECT_LT(Length(a - b), 1e-6); }

TEST(Curves, OfCubicBezierSegmentsShareTheirEnds) {
  const CurveShape curve = Curve(
      "\"point3 P\" [ 0 0 0  1 0 0  2 1 0  3 1 0  4 1 0  5 0 0  6 0 0 ] \"float width0\" 0.2 "
      "\"float width1\" 0.8 \"string type\" \"cylinder\"");
  EXPECT_EQ(curve.kind, CurveKind::kCylinder);
  EXPECT_EQ(curve.segments, (std::vector<uint32_t>{0, 3}));
  ASSERT_EQ(curve.positions.size(), 7u);
  EXPECT_FLOAT_EQ(curve.radii.front(), 0.1f);
  EXPECT_FLOAT_EQ(curve.radii[3], 0.25f);
  EXPECT_FLOAT_EQ(curve.radii.back(), 0.4f);
}

TEST(Curves, OfQuadraticSegmentsAreRaised) {
  const CurveShape curve = Curve(
      "\"integer degree\" 2 \"point3 P\" [ 0 0 0  1 2 0  2 0 0  3 -2 1  4 0 2 ] \"float width\" 1");
  ASSERT_EQ(curve.segments.size(), 2u);
  for (const double u : {0.0, 0.3, 0.5, 1.0}) {
    const double w = 1 - u;
    ExpectNear(At(curve, 0, u), Vec3d{1, 2, 0} * (2 * u * w) + Vec3d{2, 0, 0} * (u * u));
    ExpectNear(At(curve, 1, u),
               Vec3d{2, 0, 0} * (w * w) + Vec3d{3, -2, 1} * (2 * u * w) + Vec3d{4, 0, 2} * (u * u));
  }
  EXPECT_EQ(curve.kind, CurveKind::kFlat);
  EXPECT_FLOAT_EQ(curve.radii[0], 0.5f);
}

TEST(Curves, OfSplinesAreTheirSegments) {
  const Vec3d p[5] = {{0, 0, 0}, {1, 2, 0}, {2, -1, 1}, {3, 0, 0}, {4, 4, 2}};
  const std::string points =
      "\"point3 P\" [ 0 0 0  1 2 0  2 -1 1  3 0 0  4 4 2 ] "
      "\"string basis\" \"bspline\" ";
  const CurveShape cubic = Curve(points);
  ASSERT_EQ(cubic.segments.size(), 2u);
  const CurveShape quadratic = Curve(points + "\"integer degree\" 2");
  ASSERT_EQ(quadratic.segments.size(), 3u);
  for (const double u : {0.0, 0.2, 0.7, 1.0}) {
    const double w = 1 - u;
    for (int i = 0; i < 2; ++i) {
      const double b[4] = {w * w * w / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
                           (3 * w * w * w - 6 * w * w + 4) / 6, u * u * u / 6};
      Vec3d sum;
      for (int k = 0; k < 4; ++k) sum = sum + p[i + k] * b[k];
      ExpectNear(At(cubic, i, u), sum);
    }
    for (int i = 0; i < 3; ++i) {
      ExpectNear(At(quadratic, i, u),
                 p[i] * (w * w / 2) + p[i + 1] * (0.5 + u * w) + p[i + 2] * (u * u / 2));
    }
  }
}

TEST(Curves, RibbonsHaveNormalsAtTheEndsOfSegments) {
  const std::string points = "\"string type\" \"ribbon\" \"point3 P\" [ 0 0 0 1 0 0 2 0 0 3 0 0 ] ";
  const CurveShape curve = Curve(points + "\"normal N\" [ 0 2 0  0 0 1 ]");
  ASSERT_EQ(curve.normals.size(), 4u);
  EXPECT_NEAR(curve.normals[0].y, 1, 1e-6);
  EXPECT_NEAR(curve.normals[1].y, std::cos(M_PI / 6), 1e-6);
  EXPECT_NEAR(curve.normals[3].z, 1, 1e-6);
  EXPECT_NE(Message(points).find("wants 2 normals"), std::string::npos);
}

TEST(Curves, ThatDifferInNothingElseAreOneShape) {
  const std::string hair = "Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 2 0 0 3 0 0 ] ";
  const PbrtScene scene = World(hair + hair + "Material \"conductor\" " + hair +
                                "Translate 1 0 0 " + hair + hair + "Shape \"sphere\" " + hair);
  ASSERT_EQ(scene.scene.shapes.size(), 5u);
  const auto& first = std::get<CurveShape>(scene.scene.shapes[0].geometry);
  EXPECT_EQ(first.segments, (std::vector<uint32_t>{0, 4}));
  EXPECT_EQ(first.positions.size(), 8u);
  EXPECT_EQ(first.radii.size(), 8u);
}

TEST(Curves, HaveTheirAlpha) {
  const std::string points = " \"point3 P\" [ 0 0 0 1 0 0 2 0 0 3 0 0 ] ";
  const PbrtScene scene = World(
      "Texture \"t\" \"float\" \"checkerboard\" Shape \"curve\"" + points +
      "\"float alpha\" 0.25 Shape \"curve\"" + points + "\"texture alpha\" \"t\" Shape \"curve\"" +
      points + "\"texture alpha\" \"t\" Shape \"curve\"" + points + "\"float alpha\" 0");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.scene.shapes.size(), 2u) << "of alpha 0 there is none, of one alpha are joined";
  const auto& textures = scene.scene.textures;
  const auto alpha = [&](size_t i) { return scene.scene.shapes[i].alpha.texture; };
  EXPECT_EQ(std::get<ConstantTexture>(textures.at(alpha(0))).value.r, 0.25f);
  EXPECT_TRUE(std::holds_alternative<CheckerboardTexture>(textures.at(alpha(1))));
}

TEST(Curves, MistakesAreLocated) {
  EXPECT_EQ(Message("\"point3 P\" [ 0 0 0 1 0 0 ]"),
            "scene.pbrt:2: a bezier curve of degree 3 has a multiple of 3 and one control points "
            "\"point3 P\", not 2");
  EXPECT_NE(Message("\"integer degree\" 4").find("2 or 3"), std::string::npos);
  EXPECT_NE(Message("\"string basis\" \"nurbs\"").find("bezier or bspline"), std::string::npos);
  EXPECT_NE(Message("\"string type\" \"tube\"").find("flat, cylinder or ribbon"),
            std::string::npos);
  EXPECT_NE(Message("\"float width\" -1").find("negative"), std::string::npos);
}

TEST(Curves, NeitherEmitNorStretchAndSaySo) {
  const std::string hair = "Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 2 0 0 3 0 0 ]\n";
  const PbrtScene scene = World("AttributeBegin AreaLightSource \"diffuse\" " + hair +
                                "AttributeEnd\nScale 1 2 1 " + hair);
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_EQ(scene.warnings[0].text,
            "area lights that are curves are not supported; the shape does not emit");
  EXPECT_EQ(scene.warnings[0].where.line, 2);
  EXPECT_NE(scene.warnings[1].text.find("cross-sections of curves round"), std::string::npos);
  EXPECT_FALSE(scene.scene.shapes.at(0).emission.has_value());
}

TEST(LoopSubdivision, ReadsItsControlMesh) {
  const PbrtScene scene = World(
      "Shape \"loopsubdiv\" \"integer levels\" 2 \"point3 P\" [ 1 1 1  1 -1 -1  -1 1 -1  -1 -1 1 ] "
      "\"integer indices\" [ 0 1 2  0 3 1  0 2 3  1 3 2 ]");
  ASSERT_EQ(scene.scene.shapes.size(), 1u);
  const auto& mesh = std::get<TriangleMeshShape>(scene.scene.shapes[0].geometry);
  EXPECT_EQ(mesh.triangles.size(), 64u);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_NEAR(mesh.positions[0].x, 0.2, 1e-6);
  EXPECT_EQ(ReadWorld("Shape \"loopsubdiv\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] "
                      "\"integer indices\" [ 0 1 1 ]")
                .status()
                .message(),
            "scene.pbrt:2: a face of the mesh has vertex 1 twice");
}

}  // namespace
}  // namespace strata
