#pragma once

#include <cstdint>

#include "accel/transform/inverse_matrix.h"
#include "accel/transform/two_step.h"
#include "core/config/config.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"
#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// World to model space, by the arithmetic that `accuracy.transform` chose when the structure was built. The
/// direction is not renormalised, so t means the same in both spaces.
struct InstanceTransform {
  /// The transform of a ray. transpose_if_rotation is kTwoStep with another matrix.
  enum class Form : std::uint8_t { kTwoStep, kTwoStepDouble, kInverseMatrix };

  Mat3 inverse_linear{1.0f};  ///< computed in double and rounded once; or the transpose of a rotation
  Vec3 translation{0};        ///< T, to be subtracted; for kInverseMatrix -R^-1 T, to be added
  bool identity = true;       ///< no arithmetic at all
  Form form = Form::kTwoStep;
  bool transposed = false;  ///< inverse_linear is a transpose
  Mat3 inverse_rest{0.0f};  ///< kTwoStepDouble: what rounding took from inverse_linear

  [[gnu::always_inline]] Ray to_model(const Ray& world) const {
    if (identity) return world;
    Ray model = world;
    switch (form) {
      case Form::kTwoStep:
        model.origin = two_step(inverse_linear, translation, world.origin);
        model.direction = linear_step(inverse_linear, world.direction);
        break;
      case Form::kTwoStepDouble:
        model.origin = two_step_double(inverse_linear, inverse_rest, translation, world.origin);
        model.direction = linear_step_double(inverse_linear, inverse_rest, DVec3(world.direction));
        break;
      case Form::kInverseMatrix:
        model.origin = inverse_matrix(inverse_linear, translation, world.origin);
        model.direction = linear_step(inverse_linear, world.direction);
        break;
    }
    return model;
  }
};

/// False when the mapping has no usable inverse in float: the instance must then be baked into world space.
bool make_transform(const scene::Affine& world_from_model, InstanceTransform& out,
                    TransformLevel level = TransformLevel::kTwoStep);

/// |R^T R - I| <= 4 u elementwise: the transpose is then the inverse, as nearly as a float matrix shows it to be.
bool is_rotation(const Mat3& linear);

/// A world box that holds every model point of `model`, and every place where a ray that starts in the box meets
/// `model` after the level's rounded transform: corners in double, padded by gamma(4) (sum |R x| + |T|), by |R| times
/// the transform's error at such a point, and one nextafter outwards (DESIGN.md section 5). The error for a far origin
/// has no bound; it grows with the distance as the slab test's own slack does.
Aabb world_box(const scene::Affine& world_from_model, const Aabb& model,
               TransformLevel level = TransformLevel::kTwoStep);

}  // namespace carousel::accel
