#pragma once

#include "accel/exact/dyadic.h"

namespace carousel::accel {

/// The number (rational + side * sqrt(square)) / denominator, without rounding: the place on a ray of a crossing with a
/// triangle, where side is 0, or with a sphere. Precondition: square >= 0, denominator > 0.
struct ExactRoot {
  Dyadic rational, denominator;
  int side = 0;  ///< -1, 0 or 1
  Dyadic square{};

  /// Sign of this - x; x may be infinite.
  int compare(double x) const;
  /// Sign of this - other.
  int compare(const ExactRoot& other) const;
  /// The nearest `Real` (float or double), ties to even.
  template <class Real>
  Real rounded() const;
  /// The numerator, off by less than 2^-bits of the root.
  Dyadic numerator(unsigned bits) const;
};

}  // namespace carousel::accel
