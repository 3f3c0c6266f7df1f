#pragma once

#include <cmath>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "worker/bsdf/bsdf.h"
#include "worker/bsdf/mixture_parts.h"
#include "worker/math/elementary.h"

namespace strata {

/// A BSDF under test; coats point to interfaces that live as long as the program.
struct BsdfCase {
  std::string name;
  Bsdf bsdf;
};

inline const CoatInterface& TestCoatInterface() {
  static const CoatInterface interface(1.5f);
  return interface;
}

inline const AlbedoTable* TestTrappedLight() {
  static const AlbedoTable table = TabulateTrappedLight(1.5f);
  return &table;
}

/// Copper near 630, 540 and 450 nm (Johnson and Christy 1972), to two digits.
inline constexpr Rgb kCopperEta = {0.25f, 1.04f, 1.16f};
inline constexpr Rgb kCopperK = {3.3f, 2.6f, 2.4f};

inline const SchlickAlbedo* TestSchlickAlbedo() {
  static const SchlickAlbedo albedo;
  return &albedo;
}

inline Coat TestCoat(float alpha, Rgb optical_depth = {}) {
  return {&TestCoatInterface(), Ggx::FromAlpha(alpha, alpha), optical_depth};
}

/// A sum whose parts live as long as the program.
inline MixtureBsdf TestMixture(const std::vector<std::pair<Bsdf, float>>& parts) {
  static std::deque<MixtureParts> kept;
  MixtureParts& added = kept.emplace_back();
  for (const auto& [bsdf, weight] : parts) added.Add(bsdf, weight);
  return {&added};
}

/// One or more of every kind.
inline std::vector<BsdfCase> AllBsdfCases() {
  const Rgb color = {0.8f, 0.5f, 0.2f};
  std::vector<BsdfCase> cases = {
      {"diffuse", DiffuseBsdf{color}},
      {"diffuse transmission", DiffuseTransmissionBsdf{{0.5f, 0.2f, 0.1f}, {0.1f, 0.3f, 0.2f}}},
      {"transmission alone", DiffuseTransmissionBsdf{{}, {0.1f, 0.3f, 0.2f}}},
      {"smooth conductor", ConductorBsdf{kCopperEta, kCopperK, {}}},
      {"anisotropic conductor", ConductorBsdf{kCopperEta, kCopperK, Ggx::FromAlpha(0.4f, 0.05f)}},
      {"smooth dielectric", DielectricBsdf{1.5f, {}}},
      {"dielectric of lower index", DielectricBsdf{1 / 1.33f, Ggx::FromAlpha(0.2f, 0.2f)}},
      {"anisotropic dielectric", DielectricBsdf{1.5f, Ggx::FromAlpha(0.3f, 0.1f)}},
      {"rough dielectric of index 1", DielectricBsdf{1, Ggx::FromAlpha(0.3f, 0.3f)}},
      {"thin dielectric", ThinDielectricBsdf{1.5f}},
      {"smooth coat on diffuse", CoatedDiffuseBsdf(TestCoat(0), color)},
      {"absorbing coat on diffuse", CoatedDiffuseBsdf(TestCoat(0.1f, {0.01f, 0.3f, 1}), color)},
      {"smooth coat on black", CoatedDiffuseBsdf(TestCoat(0), {})},
      {"rough coat on black", CoatedDiffuseBsdf(TestCoat(0.3f), {})},
      {"smooth coat on smooth metal",
       CoatedConductorBsdf(TestCoat(0), TestTrappedLight(), kCopperEta, kCopperK, {})},
      {"smooth coat on rough metal",
       CoatedConductorBsdf(TestCoat(0, Rgb::Gray(0.01f)), TestTrappedLight(), kCopperEta, kCopperK,
                           Ggx::FromAlpha(0.2f, 0.4f))},
      {"rough coat on smooth metal",
       CoatedConductorBsdf(TestCoat(0.3f), TestTrappedLight(), kCopperEta, kCopperK, {})},
      {"Blinn's metal", BlinnBsdf{kCopperEta, kCopperK, 50}},
      {"sharp Blinn", BlinnBsdf{kCopperEta, kCopperK, 5000}},
      {"wide Blinn of glass", BlinnBsdf{Rgb::Gray(1.5f), {}, 3}},
      {"Ashikhmin-Shirley", AshikhminShirleyBsdf{color, Rgb::Gray(0.05f), {50, 50}}},
      {"anisotropic Ashikhmin-Shirley",
       AshikhminShirleyBsdf{{0.3f, 0.2f, 0.1f}, Rgb::Gray(0.4f), {10, 1000}}},
      {"Ashikhmin-Shirley without diffuse part", AshikhminShirleyBsdf{{}, color, {200, 20}}},
      {"sum of paint and metals",
       TestMixture({{DiffuseBsdf{color}, 0.5f},
                    {ConductorBsdf{kCopperEta, kCopperK, Ggx::FromAlpha(0.1f, 0.3f)}, 0.3f},
                    {BlinnBsdf{kCopperEta, kCopperK, 20}, 0.2f}})},
      {"sum of paint and a mirror",
       TestMixture({{DiffuseBsdf{color}, 0.6f}, {ConductorBsdf{kCopperEta, kCopperK, {}}, 0.4f}})},
      {"sum of a mirror and a pane", TestMixture({{ConductorBsdf{kCopperEta, kCopperK, {}}, 0.5f},
                                                  {ThinDielectricBsdf{1.5f}, 0.5f}})},
      {"rough coat on rough metal",
       CoatedConductorBsdf(TestCoat(0.1f), TestTrappedLight(), kCopperEta, kCopperK,
                           Ggx::FromAlpha(0.3f, 0.3f))},
  };
  const auto metallic_roughness = [&](const std::string& name, MetallicRoughness m) {
    m.base_color = color;
    cases.push_back({"metallic-roughness: " + name, MetallicRoughnessBsdf(TestSchlickAlbedo(), m)});
  };
  metallic_roughness("smooth dielectric", {.alpha = 0});
  metallic_roughness("smooth metal", {.metallic = 1, .alpha = 0});
  metallic_roughness("smooth pane", {.alpha = 0, .transmission = 1});
  metallic_roughness("half metal", {.metallic = 0.5f, .alpha = 0.2f});
  metallic_roughness("dim coloured specular",
                     {.alpha = 0.1f, .specular_color = {1, 0.3f, 0.1f}, .specular = 0.5f});
  metallic_roughness("rough pane", {.alpha = 0.3f, .transmission = 0.8f});
  metallic_roughness("smooth coat", {.metallic = 0.3f, .alpha = 0.4f, .coat = 0.8f});
  metallic_roughness(
      "all at once",
      {.metallic = 0.2f, .alpha = 0.3f, .transmission = 0.5f, .coat = 1, .coat_alpha = 0.05f});
  for (const float alpha : {1e-3f, 0.01f, 0.1f, 0.5f, 1.0f}) {
    const std::string at = " at alpha " + std::to_string(alpha);
    const Ggx ggx = Ggx::FromAlpha(alpha, alpha);
    cases.push_back({"conductor" + at, ConductorBsdf{kCopperEta, kCopperK, ggx}});
    cases.push_back({"dielectric" + at, DielectricBsdf{1.5f, ggx}});
    cases.push_back({"rough coat on diffuse" + at, CoatedDiffuseBsdf(TestCoat(alpha), color)});
    metallic_roughness("plastic" + at, {.alpha = alpha});
  }
  return cases;
}

/// The direction at `degrees` from the normal, turned about it so that no axis is special.
inline Vec3f DirectionAt(double degrees) {
  const SinCosResult<double> theta = SinCos(Radians(degrees));
  return {static_cast<float>(theta.sin * Cos(0.7)), static_cast<float>(theta.sin * Sin(0.7)),
          static_cast<float>(theta.cos)};
}

/// From both sides, normal to grazing.
inline std::vector<double> TestAngles() { return {0, 40, 75, 89.5, 140}; }

}  // namespace strata
