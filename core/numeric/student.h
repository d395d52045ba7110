#pragma once

#include <boost/math/distributions/students_t.hpp>

namespace carousel {

/// Standard errors to either side of a mean that hold it with 95 % of confidence: the quantile of Student's
/// distribution (Student, "The probable error of a mean", Biometrika 6, 1908). `freedom`: its degrees, above 0.
inline double student_95(double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), 0.975);
}

}  // namespace carousel
