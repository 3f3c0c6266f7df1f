#pragma once

#include <type_traits>
#include <variant>

#include "worker/scene/description.h"

// Which ids the parts of a description hold. ForEach... call f with a reference to each, kNoTexture
// among them, in no particular order; const parts give const references. Beside those named here
// the emission of shapes holds a texture.

namespace strata {

template <typename Material, typename F>
void ForEachTexture(Material& material, F f) {
  const auto roughness = [&](auto& r) {
    f(r.u);
    f(r.v);
  };
  std::visit(
      [&](auto& m) {
        using M = std::remove_cvref_t<decltype(m)>;
        if constexpr (std::is_same_v<M, DiffuseMaterial>) {
          f(m.reflectance);
        } else if constexpr (std::is_same_v<M, ConductorMaterial>) {
          f(m.eta);
          f(m.k);
          f(m.reflectance);
          roughness(m.roughness);
        } else if constexpr (std::is_same_v<M, DielectricMaterial>) {
          roughness(m.roughness);
        } else if constexpr (std::is_same_v<M, CoatedDiffuseMaterial>) {
          f(m.reflectance);
          roughness(m.roughness);
          f(m.albedo);
        } else if constexpr (std::is_same_v<M, CoatedConductorMaterial>) {
          roughness(m.interface_roughness);
          roughness(m.conductor_roughness);
          f(m.eta);
          f(m.k);
          f(m.reflectance);
        } else if constexpr (std::is_same_v<M, DiffuseTransmissionMaterial>) {
          f(m.reflectance);
          f(m.transmittance);
        } else if constexpr (std::is_same_v<M, BlinnMaterial>) {
          f(m.eta);
          f(m.k);
          f(m.reflectance);
          f(m.exponent);
        } else if constexpr (std::is_same_v<M, AshikhminShirleyMaterial>) {
          f(m.reflectance);
          f(m.specular);
          f(m.u_exponent);
          f(m.v_exponent);
        } else if constexpr (std::is_same_v<M, MetallicRoughnessMaterial>) {
          f(m.base_color);
          f(m.metallic);
          f(m.roughness);
          f(m.specular);
          f(m.specular_color);
          f(m.transmission);
          f(m.coat);
          f(m.coat_roughness);
        } else if constexpr (std::is_same_v<M, MixMaterial>) {
          f(m.amount);
        } else {
          static_assert(std::is_same_v<M, ThinDielectricMaterial> ||
                        std::is_same_v<M, InterfaceMaterial>);
        }
      },
      material);
}

template <typename F>
void ForEachTexture(SurfaceDetail& detail, F f) {
  f(detail.normal_map);
  f(detail.displacement);
}

/// Of the textures that a texture is made of.
template <typename Texture, typename F>
void ForEachInput(Texture& texture, F f) {
  std::visit(
      [&](auto& t) {
        using T = std::remove_cvref_t<decltype(t)>;
        if constexpr (std::is_same_v<T, ScaleTexture>) {
          f(t.texture);
          f(t.scale);
        } else if constexpr (std::is_same_v<T, MixTexture>) {
          f(t.a);
          f(t.b);
          f(t.amount);
        } else if constexpr (std::is_same_v<T, CheckerboardTexture>) {
          f(t.a);
          f(t.b);
        } else if constexpr (std::is_same_v<T, BilinearTexture>) {
          for (auto& corner : t.corners) f(corner);
        } else if constexpr (std::is_same_v<T, DotsTexture>) {
          f(t.inside);
          f(t.outside);
        } else {
          static_assert(std::is_same_v<T, ConstantTexture> || std::is_same_v<T, ImageTexture> ||
                        std::is_same_v<T, NoiseTexture>);
        }
      },
      texture);
}

template <typename F>
void ForEachShape(SceneDescription* scene, F f) {
  for (ShapeDescription& shape : scene->shapes) f(shape);
  for (ObjectDescription& object : scene->objects)
    for (ShapeDescription& shape : object.shapes) f(shape);
}

}  // namespace strata
