#include "accel/transform/transform.h"

#include <cmath>
#include <limits>

#include <glm/matrix.hpp>

#include "core/numeric/condition.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

bool finite(const Mat3& m) {
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!std::isfinite(m[c][r])) return false;
  return true;
}

bool finite_vector(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

DMat3 magnitudes(const DMat3& m) {
  return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

/// Bound of the distance by which a level's transform may move a ray that starts in the instance's world box away from
/// a point as large as `size` in the model, beyond the roundings of R x + T: an error e in the model is |R| e in the
/// world. Origin and direction are each a rounded entry, a product and two sums (in double one rounding in all); the
/// origin's difference is rounded as well, and from there to the point it is at most twice the size of the box.
DVec3 transform_error(const scene::Affine& m, const DVec3& size, TransformLevel level) {
  const DMat3 linear = magnitudes(DMat3(m.linear)), inverse = magnitudes(glm::inverse(DMat3(m.linear)));
  const DVec3 back = inverse * (linear * size);  // bound of any point of the world box, brought back into the model
  if (level == TransformLevel::kTwoStepDouble) return linear * (gamma(1 + 2 * 1) * back);
  DVec3 error = gamma(5 + 2 * 4) * back;
  if (level == TransformLevel::kTransposeIfRotation)
    error += 4 * kUnitRoundoff * DVec3(size.x + size.y + size.z);  // (R^T R - I) x
  if (level == TransformLevel::kInverseMatrix)                     // R^-1 p and R^-1 T before they cancel: a third sum
    error += gamma(2 * 5) * (inverse * glm::abs(DVec3(m.translation)));
  return linear * error;
}

}  // namespace

bool is_rotation(const Mat3& linear) {
  const DMat3 m(linear);
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      if (!(std::fabs(glm::dot(m[i], m[j]) - (i == j ? 1.0 : 0.0)) <= 4 * kUnitRoundoff)) return false;
  return true;
}

TransformLevel level_for(const Mat3& linear, TransformLevel level) {
  if (level == TransformLevel::kInverseMatrix) return level;
  return skeel_condition(DMat3(linear)) > kConditionForFloat ? TransformLevel::kTwoStepDouble : level;
}

bool make_transform(const scene::Affine& m, InstanceTransform& out, TransformLevel level) {
  out = InstanceTransform{};
  out.translation = m.translation;
  out.identity = m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f);
  if (out.identity) return true;
  const DMat3 linear(m.linear);
  const double det = glm::determinant(linear);
  if (!std::isfinite(det) || det == 0.0) return false;
  const DMat3 exact = glm::inverse(linear);
  const Mat3 inverse(exact);
  if (!finite(inverse)) return false;
  out.inverse_linear = inverse;
  const TransformLevel held = level_for(m.linear, level);
  out.promoted = held != level;
  switch (held) {
    case TransformLevel::kTwoStep:
      return true;
    case TransformLevel::kTransposeIfRotation:
      out.transposed = is_rotation(m.linear);
      if (out.transposed) out.inverse_linear = glm::transpose(m.linear);
      return true;
    case TransformLevel::kTwoStepDouble:
      out.form = InstanceTransform::Form::kTwoStepDouble;
      out.inverse_rest = Mat3(exact - DMat3(inverse));
      return true;
    case TransformLevel::kInverseMatrix:
      out.form = InstanceTransform::Form::kInverseMatrix;
      out.translation = folded_translation(exact, m.translation);
      return finite_vector(out.translation);
  }
  return false;
}

Aabb world_box(const scene::Affine& m, const Aabb& model, TransformLevel level) {
  if (model.empty()) return {};
  if (m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f)) return model;
  const DVec3 size = glm::max(glm::abs(DVec3(model.lo)), glm::abs(DVec3(model.hi)));
  const DVec3 error = transform_error(m, size, level_for(m.linear, level));
  Aabb box;
  for (int row = 0; row < 3; ++row) {
    double lo = m.translation[row], hi = lo, magnitude = std::fabs(lo);
    for (int c = 0; c < 3; ++c) {
      const double a = double(m.linear[c][row]) * model.lo[c], b = double(m.linear[c][row]) * model.hi[c];
      lo += std::fmin(a, b);
      hi += std::fmax(a, b);
      magnitude += std::fmax(std::fabs(a), std::fabs(b));
    }
    const double pad = gamma(4) * magnitude + error[row];
    box.lo[row] = std::nextafter(float(lo - pad), -std::numeric_limits<float>::infinity());
    box.hi[row] = std::nextafter(float(hi + pad), std::numeric_limits<float>::infinity());
  }
  return box;
}

}  // namespace carousel::accel
