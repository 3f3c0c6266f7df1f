#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/statistics/sphere_quadrature.h"
#include "tests/transport/test_scene.h"
#include "worker/bsdf/bsdf.h"
#include "worker/math/elementary.h"

// A flat surface of each material under a sky of constant radiance, seen along one direction, shows
// the sky times its directional albedo. Here the albedo is the integral of the BSDF by quadrature,
// and of its delta parts a closed form in double; the picture comes from the whole renderer. The
// mean of each is tested at p = 1e-5 (quadrature adds at most 1e-5), and a control shows that an
// error of 1 % would be found.

namespace strata {
namespace {

constexpr float kSky = 1.5f;
constexpr float kEta = 1.5f;
constexpr float kMetalEta = 1.04f, kMetalK = 2.6f;  ///< Copper's near 540 nm.
constexpr float kCoatThickness = 0.01f;             ///< Of every coat over metal.

// ---- closed forms ----

/// Fresnel's equations for unpolarized light from a medium of index 1 on one of complex index n.
double Fresnel(double cos_theta, std::complex<double> n) {
  const std::complex<double> refracted =
      std::sqrt(1.0 - (1 - cos_theta * cos_theta) / (n * n));  // Its cosine.
  const std::complex<double> s = (cos_theta - n * refracted) / (cos_theta + n * refracted);
  const std::complex<double> p = (n * cos_theta - refracted) / (n * cos_theta + refracted);
  return 0.5 * (std::norm(s) + std::norm(p));
}

/// The cosine inside a medium of index kEta.
double CosRefracted(double cos_theta) {
  return std::sqrt(1 - (1 - cos_theta * cos_theta) / (double(kEta) * kEta));
}

double Nothing(double) { return 0; }

/// What is reflected, and the radiance of the sky on the other side as the border changes it. A
/// cosine below 0 is that of a view from within.
double SmoothDielectric(double cos_theta) {
  const double n = cos_theta > 0 ? double(kEta) : 1 / double(kEta);
  const double reflected = Fresnel(std::fabs(cos_theta), n);
  return reflected + (1 - reflected) / (n * n);
}

double SmoothBorder(double cos_theta) { return Fresnel(std::fabs(cos_theta), kEta); }

/// A smooth coat over a smooth metal: all reflections between them.
double SmoothCoatedMetal(double cos_theta) {
  const double border = SmoothBorder(cos_theta);
  const double inner = CosRefracted(cos_theta);
  const double metal = Fresnel(inner, std::complex<double>(kMetalEta, kMetalK) / double(kEta)) *
                       std::exp(-2 * double(kCoatThickness) / inner);
  return border + (1 - border) * (1 - border) * metal / (1 - border * metal);
}

// ---- materials ----

/// A material as scenes describe it, and what it is to be.
struct Surface {
  std::string name;
  std::function<MaterialDescription(TestScene&)> material;
  Bsdf bsdf;
  double (*delta)(double cos_theta);  ///< Radiance of the delta parts under a sky of 1.
};

void PrintTo(const Surface& surface, std::ostream* out) { *out << surface.name; }

Roughness Alpha(TestScene& scene, float u, float v) {
  return {scene.Texture(Rgb::Gray(u)), scene.Texture(Rgb::Gray(v)), false};
}

Surface Conductor(const std::string& name, float u, float v, double (*delta)(double)) {
  return {name,
          [=](TestScene& scene) {
            return ConductorMaterial{.eta = scene.Texture(Rgb::Gray(kMetalEta)),
                                     .k = scene.Texture(Rgb::Gray(kMetalK)),
                                     .roughness = Alpha(scene, u, v)};
          },
          ConductorBsdf{Rgb::Gray(kMetalEta), Rgb::Gray(kMetalK), Ggx::FromAlpha(u, v)}, delta};
}

Surface Dielectric(const std::string& name, float alpha, double (*delta)(double)) {
  return {name,
          [=](TestScene& scene) {
            return DielectricMaterial{kEta, Alpha(scene, alpha, alpha)};
          },
          DielectricBsdf{kEta, Ggx::FromAlpha(alpha, alpha)}, delta};
}

Coat CoatOf(float alpha, float thickness) {
  static const CoatInterface interface(kEta);
  return {&interface, Ggx::FromAlpha(alpha, alpha), Rgb::Gray(thickness)};
}

Surface CoatedDiffuse(const std::string& name, float alpha, float thickness,
                      double (*delta)(double)) {
  constexpr float kBase = 0.7f;
  return {name,
          [=](TestScene& scene) {
            return CoatedDiffuseMaterial{.reflectance = scene.Texture(Rgb::Gray(kBase)),
                                         .roughness = Alpha(scene, alpha, alpha),
                                         .eta = kEta,
                                         .thickness = thickness};
          },
          CoatedDiffuseBsdf(CoatOf(alpha, thickness), Rgb::Gray(kBase)), delta};
}

Surface CoatedConductor(const std::string& name, float border, float metal,
                        double (*delta)(double)) {
  static const AlbedoTable trapped = TabulateTrappedLight(kEta);
  return {name,
          [=](TestScene& scene) {
            return CoatedConductorMaterial{.interface_roughness = Alpha(scene, border, border),
                                           .conductor_roughness = Alpha(scene, metal, metal),
                                           .interface_eta = kEta,
                                           .eta = scene.Texture(Rgb::Gray(kMetalEta)),
                                           .k = scene.Texture(Rgb::Gray(kMetalK))};
          },
          CoatedConductorBsdf(CoatOf(border, kCoatThickness), &trapped, Rgb::Gray(kMetalEta / kEta),
                              Rgb::Gray(kMetalK / kEta), Ggx::FromAlpha(metal, metal)),
          delta};
}

std::vector<Surface> AllSurfaces() {
  return {
      {"Diffuse", [](TestScene& scene) { return DiffuseMaterial{scene.Texture(Rgb::Gray(0.6f))}; },
       DiffuseBsdf{Rgb::Gray(0.6f)}, Nothing},
      {"DiffuseTransmission",
       [](TestScene& scene) {
         return DiffuseTransmissionMaterial{scene.Texture(Rgb::Gray(0.3f)),
                                            scene.Texture(Rgb::Gray(0.5f))};
       },
       DiffuseTransmissionBsdf{Rgb::Gray(0.3f), Rgb::Gray(0.5f)}, Nothing},
      Conductor("SmoothConductor", 0, 0,
                [](double cos_theta) {
                  return Fresnel(std::fabs(cos_theta), {kMetalEta, kMetalK});
                }),
      Conductor("RoughConductor", 0.3f, 0.3f, Nothing),
      Conductor("AnisotropicConductor", 0.6f, 0.1f, Nothing),
      Dielectric("SmoothDielectric", 0, SmoothDielectric),
      Dielectric("RoughDielectric", 0.3f, Nothing),
      {"ThinDielectric", [](TestScene&) { return ThinDielectricMaterial{kEta}; },
       ThinDielectricBsdf{kEta}, [](double) { return 1.0; }},
      CoatedDiffuse("SmoothCoatOnDiffuse", 0, 0, SmoothBorder),
      CoatedDiffuse("AbsorbingSmoothCoatOnDiffuse", 0, 0.2f, SmoothBorder),
      CoatedDiffuse("RoughCoatOnDiffuse", 0.25f, 0.01f, Nothing),
      CoatedConductor("SmoothCoatOnSmoothConductor", 0, 0, SmoothCoatedMetal),
      CoatedConductor("SmoothCoatOnRoughConductor", 0, 0.3f, SmoothBorder),
      CoatedConductor("RoughCoatOnRoughConductor", 0.2f, 0.4f, Nothing),
  };
}

/// A square in y = 0, whose normal is y and whose u runs along z, and the camera that looks at the
/// origin against `wo`: local coordinates (x, y, z) are the world's (z, x, y).
std::shared_ptr<const Scene> SquareUnderTheSky(const Surface& surface, Vec3f wo) {
  TestScene scene;
  scene.Polygon({{-50, 0, -50}, {-50, 0, 50}, {50, 0, 50}, {50, 0, -50}},
                scene.Material(surface.material(scene)));
  std::get<TriangleMeshShape>(scene.description.shapes.back().geometry).uvs = {
      {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(kSky)});
  scene.Camera({wo.y, wo.z, wo.x}, {0, 0, 0}, 0.01f);
  return BuildScene(scene);
}

class Albedo : public testing::TestWithParam<Surface> {};

TEST_P(Albedo, IsSeenUnderAConstantSky) {
  const Surface& surface = GetParam();
  for (const double degrees : {20.0, 65.0, 80.0, 130.0}) {
    SCOPED_TRACE(testing::Message() << degrees << " degrees");
    const SinCosResult<double> theta = SinCos(Radians(degrees)), phi = SinCos(0.4);
    const Vec3f wo = {float(theta.sin * phi.cos), float(theta.sin * phi.sin), float(theta.cos)};
    const double scattered =
        IntegrateSphere([&](Vec3f wi) { return Eval(surface.bsdf, wo, wi).g; });
    const double truth = kSky * (scattered + surface.delta(theta.cos));
    // One bounce: what the sky sends off the surface.
    ExpectMean(RenderFrame(SquareUnderTheSky(surface, wo), TestSpec(16, 512, 1)), truth);
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Albedo, testing::ValuesIn(AllSurfaces()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace strata
