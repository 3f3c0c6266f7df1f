#include <numbers>

#include "tests/sampling/density_cases.h"
#include "worker/bsdf/ggx.h"
#include "worker/sampling/blinn.h"
#include "worker/sampling/henyey_greenstein.h"
#include "worker/sampling/jacobian.h"
#include "worker/sampling/rejection.h"
#include "worker/sampling/routines.h"
#include "worker/sampling/spherical_rectangle.h"
#include "worker/sampling/spherical_triangle.h"
#include "worker/sampling/warp.h"
#include "worker/sampling/warp_inverse.h"

namespace strata {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

double Wave(double u) { return std::cos(2 * kHalfTurn * u); }

using Draw = std::function<std::optional<Vec3f>(TestRandom&)>;
using Density = std::function<double(Vec3f)>;

Draw FromSquare(std::function<Vec3f(Vec2f)> sample) {
  return [sample](TestRandom& random) -> std::optional<Vec3f> { return sample(random.Float2()); };
}

/// Directions told by their angles (theta, phi), where theta is below `theta_max`.
PlaneCase Angles(std::string name, Draw sample, Density pdf, Density tilt, double theta_max) {
  const auto direction = [](PlanePoint p) {
    const double sine = std::sin(p.x);
    return Vec3f{static_cast<float>(sine * std::cos(p.y)), static_cast<float>(sine * std::sin(p.y)),
                 static_cast<float>(std::cos(p.x))};
  };
  return {.name = std::move(name),
          .sample = [sample](TestRandom& random) -> std::optional<PlanePoint> {
            const std::optional<Vec3f> w = sample(random);
            if (!w) return std::nullopt;
            const double x = w->x, y = w->y;
            return PlanePoint{std::atan2(std::hypot(x, y), w->z), std::atan2(y, x)};
          },
          .density =
              [=](PlanePoint p) {
                return SolidAngleToAnglesPdf(static_cast<float>(pdf(direction(p))),
                                             static_cast<float>(std::sin(p.x)));
              },
          .tilt = [=](PlanePoint p) { return tilt(direction(p)); },
          .x1 = theta_max,
          .y0 = -kHalfTurn,
          .y1 = kHalfTurn};
}

PlaneCase Cone(double angle) {
  const double sine = std::sin(angle);
  const float reach = OneMinusCosFromSinSquared(static_cast<float>(sine * sine));
  return Angles(
      "Cone", FromSquare([=](Vec2f u) { return SampleUniformCone(u, reach); }),
      [=](Vec3f) { return UniformConePdf(reach); },
      [=](Vec3f w) { return Wave(InvertUniformCone(w, reach).x); }, angle);
}

PlaneCase HenyeyGreenstein(const std::string& name, float g) {
  return Angles(
      name, FromSquare([g](Vec2f u) { return SampleHenyeyGreenstein(u, g); }),
      [g](Vec3f w) { return HenyeyGreensteinPdf(w, g); },
      [g](Vec3f w) { return Wave(InvertHenyeyGreenstein(w, g).x); }, kHalfTurn);
}

PlaneCase Blinn(const std::string& name, float n) {
  return Angles(
      name, FromSquare([n](Vec2f u) { return SampleBlinn(u, n); }),
      [n](Vec3f h) { return BlinnPdf(h, n); }, [n](Vec3f h) { return Wave(InvertBlinn(h, n).x); },
      kHalfTurn / 2);
}

/// What Blinn's half vectors make of one direction.
PlaneCase BlinnReflected() {
  constexpr float kExponent = 20;
  const Vec3f wo = {0.6f, 0, 0.8f};
  return Angles(
      "BlinnReflected",
      [=](TestRandom& random) -> std::optional<Vec3f> {
        const Vec3f h = SampleBlinn(random.Float2(), kExponent);
        if (!(Dot(wo, h) > 0)) return std::nullopt;
        return h * (2 * Dot(wo, h)) - wo;
      },
      [=](Vec3f wi) {
        const Vec3f h = Normalize(wo + wi);
        return HalfVectorToReflectedPdf(BlinnPdf(h, kExponent), Dot(wo, h));
      },
      [=](Vec3f wi) { return Wave(InvertBlinn(Normalize(wo + wi), kExponent).y); }, kHalfTurn);
}

PlaneCase VisibleNormals() {
  const Ggx ggx = Ggx::FromAlpha(0.4f, 0.2f);
  const Vec3f wo = Normalize(Vec3f{0.7f, 0.3f, 0.4f});
  return Angles(
      "GgxVisibleNormals", FromSquare([=](Vec2f u) { return ggx.SampleVisibleNormal(wo, u); }),
      [=](Vec3f m) { return ggx.VisibleNormalPdfOverCos(wo, m) * std::max(0.0f, Dot(wo, m)); },
      [=](Vec3f m) { return Wave(ggx.InvertVisibleNormal(wo, m).x); }, kHalfTurn / 2);
}

Vec3f PointOfBall(TestRandom& random) {
  return SampleBallByRejection([&] { return random.Float(); }).point;
}
double AzimuthOf(Vec3f p) { return std::atan2(static_cast<double>(p.y), p.x); }

/// Points of the ball by two of their spherical coordinates, the third integrated: by radius and
/// theta, by theta and phi, and by radius and phi, so that each pair is looked at.
PlaneCase RejectionBall() {
  return {.name = "RejectionBall",
          .sample = [](TestRandom& random) -> std::optional<PlanePoint> {
            const Vec3f p = PointOfBall(random);
            return PlanePoint{Length(p), std::atan2(std::hypot(p.x, p.y), p.z)};
          },
          .density =
              [](PlanePoint p) {
                return 2 * kHalfTurn *
                       VolumeToSphericalPdf(0.75f * kInvPi, static_cast<float>(p.x),
                                            static_cast<float>(std::sin(p.y)));
              },
          .tilt = [](PlanePoint p) { return std::cos(p.y); },
          .y1 = kHalfTurn};
}
PlaneCase RejectionBallDirections() {
  return Angles(
      "RejectionBallDirections",
      [](TestRandom& random) -> std::optional<Vec3f> { return PointOfBall(random); },
      [](Vec3f) { return UniformSpherePdf(); },
      [](Vec3f w) { return Wave(InvertUniformSphere(w).y); }, kHalfTurn);
}
PlaneCase RejectionBallAzimuths() {
  return {.name = "RejectionBallAzimuths",
          .sample = [](TestRandom& random) -> std::optional<PlanePoint> {
            const Vec3f p = PointOfBall(random);
            return PlanePoint{Length(p), AzimuthOf(p)};
          },
          .density =
              [](PlanePoint p) {
                // The sine of theta integrates to 2.
                return 2 * VolumeToSphericalPdf(0.75f * kInvPi, static_cast<float>(p.x), 1);
              },
          .tilt = [](PlanePoint p) { return std::cos(p.y); },
          .y0 = -kHalfTurn,
          .y1 = kHalfTurn};
}

/// Solid angle per area of the point at `to_point` on a surface with unit normal `n`.
double SolidAnglePerArea(Vec3f to_point, Vec3f n) {
  const double d2 = LengthSquared(to_point);
  return AbsDot(to_point, n) / (d2 * std::sqrt(d2));
}

/// Directions to a triangle, told by where they meet it: s = 1 - b0 and b1 / s.
PlaneCase SphericalTriangleCase(const std::string& name, float scale) {
  const Vec3f from = {0.1f, -0.2f, 0.3f};
  const Vec3f p0 = from + Vec3f{1, 0.2f, 0.1f} * 1.0f,
              p1 = from + Vec3f{1, 0.2f + scale, 0.4f * scale},
              p2 = from + Vec3f{1.2f, 0.1f - 0.3f * scale, 0.1f + 0.8f * scale};
  const SphericalTriangle triangle(p0, p1, p2, from);
  const Vec3f cross = Cross(p1 - p0, p2 - p0);
  const float area = 0.5f * Length(cross);
  const Vec3f n = Normalize(cross);
  const auto point = [=](PlanePoint p) {
    const auto s = static_cast<float>(p.x), t = static_cast<float>(p.y);
    return p0 * (1 - s) + p1 * (s * t) + p2 * (s * (1 - t)) - from;
  };
  return {.name = name,
          .sample = [=](TestRandom& random) -> std::optional<PlanePoint> {
            const Vec3f w = triangle.Sample(random.Float2());
            // The weights of the corners of the point that w meets, by volumes.
            const auto volume = [](Vec3f a, Vec3f b, Vec3f c) {
              return std::fabs(Dot(ToDouble(a), Cross(ToDouble(b), ToDouble(c))));
            };
            const double v0 = volume(w, p1 - from, p2 - from), v1 = volume(w, p0 - from, p2 - from),
                         v2 = volume(w, p0 - from, p1 - from);
            return PlanePoint{(v1 + v2) / (v0 + v1 + v2), v1 / (v1 + v2)};
          },
          .density =
              [=](PlanePoint p) {
                return triangle.Pdf() * SolidAnglePerArea(point(p), n) * 2 * area * p.x;
              },
          .tilt = [=](PlanePoint p) { return Wave(triangle.Invert(Normalize(point(p))).x); }};
}

/// Directions to a rectangle, told by where they meet it, in parts of its edges.
PlaneCase SphericalRectangleCase() {
  const Vec3f corner = {-0.3f, 0.2f, 0.5f}, unit1 = {1, 0, 0}, unit2 = {0, 0.6f, 0.8f};
  const Vec3f n = Cross(unit1, unit2), from = {0.2f, 0.1f, 0.2f};
  constexpr float kLength1 = 1.5f, kLength2 = 0.7f;
  const Vec3f edge1 = unit1 * kLength1, edge2 = unit2 * kLength2;
  const RectangleScales scales = ScalesOf(edge1, edge2);
  const SphericalRectangle rectangle(corner, edge1, scales.edge1, edge2, scales.edge2, n,
                                     scales.length, from);
  return {.name = "SphericalRectangle",
          .sample = [=](TestRandom& random) -> std::optional<PlanePoint> {
            const Vec2f p = rectangle.Sample(random.Float2());
            return PlanePoint{p.x, p.y};
          },
          .density =
              [=](PlanePoint p) {
                const Vec3f to_point = corner + unit1 * (kLength1 * static_cast<float>(p.x)) +
                                       unit2 * (kLength2 * static_cast<float>(p.y)) - from;
                return SolidAnglePerArea(to_point, n) * kLength1 * kLength2 / rectangle.solid_angle;
              },
          .tilt =
              [=](PlanePoint p) {
                return Wave(rectangle.Invert({static_cast<float>(p.x), static_cast<float>(p.y)}).x);
              }};
}

}  // namespace

std::vector<PlaneCase> DirectionalCases() {
  return {
      Angles(
          "UniformHemisphere", FromSquare(SampleUniformHemisphere),
          [](Vec3f) { return UniformHemispherePdf(); },
          [](Vec3f w) { return Wave(InvertUniformHemisphere(w).x); }, kHalfTurn / 2),
      Angles(
          "CosineHemisphere", FromSquare(SampleCosineHemisphere),
          [](Vec3f w) { return CosineHemispherePdf(w.z); },
          [](Vec3f w) { return Wave(InvertCosineHemisphere(w).x); }, kHalfTurn / 2),
      Angles(
          "Sphere", FromSquare(SampleUniformSphere), [](Vec3f) { return UniformSpherePdf(); },
          [](Vec3f w) { return Wave(InvertUniformSphere(w).x); }, kHalfTurn),
      Angles(
          "RejectionSphere",
          [](TestRandom& random) -> std::optional<Vec3f> {
            return SampleSphereByRejection([&] { return random.Float(); }).point;
          },
          [](Vec3f) { return UniformSpherePdf(); },
          [](Vec3f w) { return Wave(InvertUniformSphere(w).x); }, kHalfTurn),
      Angles(
          "JobHemisphereByRejection", FromSquare([](Vec2f u) {
            return SampleUniformHemisphereBy(SamplingRoutines::kRejection, u);
          }),
          [](Vec3f) { return UniformHemispherePdf(); },
          [](Vec3f w) { return Wave(InvertUniformHemisphere(w).x); }, kHalfTurn / 2),
      Angles(
          "JobCosineHemisphereByRejection", FromSquare([](Vec2f u) {
            return SampleCosineHemisphereBy(SamplingRoutines::kRejection, u);
          }),
          [](Vec3f w) { return CosineHemispherePdf(w.z); },
          [](Vec3f w) { return Wave(InvertCosineHemisphere(w).x); }, kHalfTurn / 2),
      RejectionBall(),
      RejectionBallDirections(),
      RejectionBallAzimuths(),
      Cone(0.3),
      HenyeyGreenstein("HenyeyGreensteinForward", 0.9f),
      HenyeyGreenstein("HenyeyGreensteinBackward", -0.5f),
      HenyeyGreenstein("HenyeyGreensteinEven", 0),
      Blinn("BlinnOne", 1),
      Blinn("BlinnThousand", 1000),
      BlinnReflected(),
      VisibleNormals(),
      SphericalTriangleCase("SphericalTriangle", 0.9f),
      SphericalTriangleCase("SphericalTriangleSmall", 0.01f),
      SphericalRectangleCase(),
  };
}

}  // namespace strata
