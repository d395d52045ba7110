#include "scene/gltf/pose/slerp.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace carousel::scene {

namespace {

/// atan(x) for x in [0, 1], by two halvings of the angle and Taylor's series, whose first term left out is below 1e-17.
double arc_tangent(double x) {
  for (int i = 0; i < 2; ++i) x /= 1 + std::sqrt(1 + x * x);
  const double square = x * x;
  double sum = 0;
  for (int n = 23; n > 0; n -= 2) sum = 1.0 / n - square * sum;
  return 4 * x * sum;
}

/// sin(x) / x for x in [0, pi / 2], by Taylor's series, whose first term left out is below 1e-17.
double sine_over(double x) {
  const double square = x * x;
  double sum = 1;
  for (int n = 22; n > 0; n -= 2) sum = 1 - square / (n * (n + 1)) * sum;
  return sum;
}

}  // namespace

glm::dvec4 slerp(const glm::dvec4& a, const glm::dvec4& b, double t) {
  const glm::dvec4 near = glm::dot(a, b) < 0 ? -b : b;
  // Half the angle between the two has this tangent, which is accurate for small angles as well.
  const double apart = glm::length(near - a), together = glm::length(near + a);
  const double angle = 2 * arc_tangent(apart < together ? apart / together : 1);
  const double whole = sine_over(angle);
  const double s = 1 - t;
  return glm::normalize(a * (s * sine_over(s * angle) / whole) + near * (t * sine_over(t * angle) / whole));
}

}  // namespace carousel::scene
