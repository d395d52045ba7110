#pragma once

#include <array>

#include "accel/exact/dyadic.h"
#include "scene/model/scene.h"

namespace carousel::accel {

using DyadicVec = std::array<Dyadic, 3>;

inline Dyadic dot(const DyadicVec& a, const DyadicVec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The adjugate of a linear part, whose product with the linear part is the determinant times the identity: the inverse
/// without a division, and so without rounding.
struct ExactAdjugate {
  std::array<DyadicVec, 3> rows;
  Dyadic determinant;

  explicit ExactAdjugate(const scene::Affine& m) {
    const auto at = [&](std::size_t row, std::size_t column) {
      return Dyadic(m.linear[static_cast<int>(column % 3)][static_cast<int>(row % 3)]);
    };
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t c = 0; c < 3; ++c)
        rows[row][c] = at(c + 1, row + 1) * at(c + 2, row + 2) - at(c + 1, row + 2) * at(c + 2, row + 1);
    determinant = dot(rows[0], {at(0, 0), at(1, 0), at(2, 0)});
  }
};

}  // namespace carousel::accel
