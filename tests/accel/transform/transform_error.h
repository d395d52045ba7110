#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "accel/transform/transform.h"
#include "tests/accel/structure/placements.h"
#include "tests/support/publish.h"

namespace carousel::accel {

/// The traditional form with fused multiply-adds that start from the translation: the fairest it can be made. The
/// kernels never fuse (docs/how-it-works/design.md, One arithmetic).
inline Vec3 inverse_matrix_fma(const Mat3& inverse, const Vec3& folded, const Vec3& p) {
  Vec3 out;
  for (int row = 0; row < 3; ++row)
    out[row] =
        std::fma(inverse[2][row], p.z, std::fma(inverse[1][row], p.y, std::fma(inverse[0][row], p.x, folded[row])));
  return out;
}

/// A way to bring a point into the model's space.
struct TransformMethod {
  std::string name;
  std::function<Vec3(const scene::Affine&, const Vec3&)> point;
};

inline TransformMethod at_level(std::string name, TransformLevel level) {
  return {std::move(name), [level](const scene::Affine& m, const Vec3& p) {
            InstanceTransform t;
            make_transform(m, t, level);
            return t.to_model({p, 0, {0, 0, 1}, 1}).origin;
          }};
}

inline std::vector<TransformMethod> transform_methods() {
  return {at_level("inverse_matrix", TransformLevel::kInverseMatrix),
          {"inverse_matrix_fma",
           [](const scene::Affine& m, const Vec3& p) {
             InstanceTransform t;
             make_transform(m, t, TransformLevel::kInverseMatrix);
             return inverse_matrix_fma(t.inverse_linear, t.translation, p);
           }},
          at_level("two_step", TransformLevel::kTwoStep),
          at_level("two_step_double", TransformLevel::kTwoStepDouble),
          at_level("transpose_if_rotation", TransformLevel::kTransposeIfRotation)};
}

/// Errors of a method over some points, relative to the exact model point's length, and in units of the model.
struct TransformErrors {
  std::vector<double> relative;
  double worst_absolute = 0;

  void add(const Vec3& got, const QuadInverse::Vec& exact) {
    const double size = QuadInverse::norm(exact), off = QuadInverse::distance(got, exact);
    worst_absolute = std::max(worst_absolute, off);
    if (size > 0) relative.push_back(off / size);  // exactly at T there is nothing to be relative to
  }
  double median() {
    if (relative.empty()) return 0;
    std::nth_element(relative.begin(), relative.begin() + static_cast<std::ptrdiff_t>(relative.size() / 2),
                     relative.end());
    return relative[relative.size() / 2];
  }
  double worst() const { return relative.empty() ? 0 : *std::max_element(relative.begin(), relative.end()); }
};

}  // namespace carousel::accel
