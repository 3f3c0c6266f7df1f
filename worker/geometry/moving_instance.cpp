#include "worker/geometry/moving_instance.h"

#include <cmath>
#include <optional>

#include "worker/math/motion.h"

namespace strata {
namespace {

/// The transform as Embree will hold it.
Transform RoundedToFloat(Transform transform) {
  for (auto& row : transform.m) {
    for (double& element : row) element = static_cast<float>(element);
  }
  return transform;
}

absl::Status CannotBe(const InstanceDescription& description, const char* why) {
  return absl::InvalidArgumentError(absl::StrCat(description.where.ToString(), ": ", why));
}

/// Embree inverts an instance's matrix in float, by cofactors over the determinant, and takes each
/// ray's origin through the result. Bounds the error of that, element by element (PBRT 6.8.1), and
/// maps it back to the world.
void SetOriginError(Instance* instance) {
  const auto& m = instance->placement.to_world;
  const auto& inverse = instance->placement.to_object;
  double determinant_terms = 0;
  double cofactor_terms[3][3];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int r1 = (column + 1) % 3, r2 = (column + 2) % 3;
      const int c1 = (row + 1) % 3, c2 = (row + 2) % 3;
      cofactor_terms[row][column] =
          std::abs(m[r1][c1] * m[r2][c2]) + std::abs(m[r1][c2] * m[r2][c1]);
    }
  }
  for (int i = 0; i < 3; ++i) determinant_terms += std::abs(m[i][0]) * cofactor_terms[0][i];
  const double determinant = std::abs(instance->placement.determinant);
  double error[3][3];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      error[row][column] =
          Gamma(8) * (cofactor_terms[row][column] / determinant +
                      std::abs(inverse[row][column]) * (1 + determinant_terms / determinant));
    }
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      instance->origin_error[row][column] = 0;
      for (int k = 0; k < 3; ++k)
        instance->origin_error[row][column] += std::abs(m[row][k]) * error[k][column];
    }
  }
}

}  // namespace

absl::StatusOr<Instance> PlaceInstance(const InstanceDescription& description,
                                       std::vector<InstanceMotion>* motions) {
  const std::optional<Placement> placement = Placement::From(RoundedToFloat(description.to_world));
  if (!placement)
    return CannotBe(description, "the instance's transform is singular or not affine");
  Instance instance;
  instance.placement = *placement;
  SetOriginError(&instance);
  if (!description.to_world_at_end) return instance;

  const auto steps = MotionSteps(description.to_world, *description.to_world_at_end);
  if (!steps)
    return CannotBe(description,
                    "the instance cannot move as its transforms at start and end say: one is "
                    "singular, or one mirrors and the other does not");
  InstanceMotion motion;
  for (const Transform& step : *steps) {
    const std::optional<Placement> placed = Placement::From(RoundedToFloat(step));
    if (!placed) return CannotBe(description, "the instance's transform is singular on its way");
    motion.steps.push_back(placed->to_world);
  }
  instance.motion = static_cast<int32_t>(motions->size());
  motions->push_back(std::move(motion));
  return instance;
}

MovedInstance::MovedInstance(const Instance& moving, const InstanceMotion& motion, float time) {
  const int pieces = static_cast<int>(motion.steps.size()) - 1;
  const MotionTime at(time, pieces);
  const Placement::Rows &from = motion.steps[at.step], &to = motion.steps[at.step + 1];
  // The fraction of the piece errs by a rounding of the time in all pieces, each product and their
  // sum by one.
  double error[3][4];
  Transform map;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double a = from[row][column] * (1 - double{at.fraction});
      const double b = to[row][column] * at.fraction;
      map.m[row][column] = a + b;
      error[row][column] = Gamma(4) * (std::abs(a) + std::abs(b)) +
                           Gamma(2) * pieces * std::abs(to[row][column] - from[row][column]);
    }
  }
  instance.object = moving.object;
  // Every step has an inverse, and so has what lies between two that are a small turn apart.
  instance.placement = Placement::From(map).value_or(moving.placement);
  SetOriginError(&instance);
  const Placement::Rows& inverse = instance.placement.to_object;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      for (int k = 0; k < 3; ++k)
        instance.origin_error[row][column] += error[row][k] * std::abs(inverse[k][column]);
    }
  }
  translation_error = ToFloat({error[0][3], error[1][3], error[2][3]});
}

}  // namespace strata
