#pragma once

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

#include "core/types/vec.h"

namespace carousel {

/// The condition number of R. D. Skeel, "Scaling for numerical stability in Gaussian elimination", Journal of the ACM
/// 26 (1979): the largest row sum of |R^-1||R|, entry by entry. R^-1 (o - T), computed in arithmetic of rounding u, is
/// off by a few u times this number, relative to the size of the model that R places. It is 1 for a scaling, at most 3
/// for a rotation, also one that is scaled afterwards, and about the ratio of the scales for a scaling that is turned
/// afterwards. Infinite or not a number where R has no inverse.
inline double skeel_condition(const DMat3& linear) {
  const DMat3 inverse = glm::inverse(linear);
  double largest = 0;
  for (int row = 0; row < 3; ++row) {
    double sum = 0;
    for (int column = 0; column < 3; ++column)
      for (int k = 0; k < 3; ++k) sum += std::fabs(inverse[k][row]) * std::fabs(linear[column][k]);
    largest = std::max(largest, sum);
    if (std::isnan(sum)) return sum;
  }
  return largest;
}

/// Up to this condition a ray is brought to model space in float: its origin then moves by less than a thousandth of
/// the model. An instance beyond it is transformed in double (accel/transform/transform.h).
inline constexpr double kConditionForFloat = 0x1p10;
/// Up to this one double moves it no farther than float does where R is a rotation. Beyond it nothing is promised.
inline constexpr double kConditionForDouble = 0x1p27;

}  // namespace carousel
