#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tests/light/light_scene.h"
#include "worker/light/emission.h"

// A light of each kind, for what must hold of the rays that leave it.

namespace strata {

/// A light in a scene of its own, above the floor z = 0.
struct Source {
  std::string name;
  std::function<void(SceneDescription*)> add;
  double power_tolerance = 1e-5;  ///< Of Power, relative.
};

/// All of them; those that take files find them in `files`, where they are written.
std::vector<Source> Sources(const LightFiles& files);

inline std::optional<EmittedRay> Emit(const Light& light, const SceneSphere& scene, Vec2f u_point,
                                      Vec2f u_w) {
  return std::visit([&](const auto& l) { return SampleLe(l, scene, u_point, u_w); }, light);
}

}  // namespace strata
