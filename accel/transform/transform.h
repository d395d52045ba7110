#pragma once

#include <cstdint>

#include "accel/transform/inverse_matrix.h"
#include "accel/transform/two_step.h"
#include "core/config/fields/accuracy.h"
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
  bool promoted = false;    ///< in double because R is nearly singular, at a level that is not: level_for()
  Mat3 inverse_rest{0.0f};  ///< kTwoStepDouble: what rounding took from inverse_linear

  /// A position: a ray's origin, or any other that is needed in the model's space, such as a light's (US 12394134,
  /// claim 11).
  [[gnu::always_inline]] Vec3 position_to_model(const Vec3& world) const {
    if (identity) return world;
    switch (form) {
      case Form::kTwoStep:
        return two_step(inverse_linear, translation, world);
      case Form::kTwoStepDouble:
        return two_step_double(inverse_linear, inverse_rest, translation, world);
      case Form::kInverseMatrix:
        break;
    }
    return inverse_matrix(inverse_linear, translation, world);
  }
  [[gnu::always_inline]] Vec3 direction_to_model(const Vec3& world) const {
    if (identity) return world;
    return form == Form::kTwoStepDouble ? linear_step_double(inverse_linear, inverse_rest, DVec3(world))
                                        : linear_step(inverse_linear, world);
  }
  [[gnu::always_inline]] Ray to_model(const Ray& world) const {
    Ray model = world;
    model.origin = position_to_model(world.origin);
    model.direction = direction_to_model(world.direction);
    return model;
  }
};

/// The level at which rays are brought to an instance placed so, where `level` is configured: a matrix that the
/// two-step levels in float cannot hold (kConditionForFloat) is left to `two_step_double`. Not with `inverse_matrix`,
/// which promises nothing.
TransformLevel level_for(const Mat3& linear, TransformLevel level);

/// False when the mapping has no usable inverse in float: the instance must then be baked into world space.
bool make_transform(const scene::Affine& world_from_model, InstanceTransform& out,
                    TransformLevel level = TransformLevel::kTwoStep);

/// |R^T R - I| <= 4 u elementwise: the transpose is then the inverse, as nearly as a float matrix shows it to be.
bool is_rotation(const Mat3& linear);

/// A world box that holds every model point of `model`, and every place where a ray that starts in the box meets
/// `model` after the level's rounded transform: corners in double, padded by gamma(4) (sum |R x| + |T|), by |R| times
/// the transform's error at such a point, and one nextafter outwards (docs/how-it-works/accuracy.md). The error for a
/// far origin has no bound; it grows with the distance as the slab test's own slack does.
Aabb world_box(const scene::Affine& world_from_model, const Aabb& model,
               TransformLevel level = TransformLevel::kTwoStep);

}  // namespace carousel::accel
