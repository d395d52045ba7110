#include "scene/model/gaussians.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace carousel::scene {

std::optional<Mat3> spread_of(const double (&rotation)[4], const DVec3& deviations) {
  const glm::dquat turn(rotation[3], rotation[0], rotation[1], rotation[2]);
  const double length = glm::length(turn);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  const double largest = std::max({deviations.x, deviations.y, deviations.z});
  const double smallest = std::min({deviations.x, deviations.y, deviations.z});
  constexpr double kFlattest = 0x1p-14;
  if (!(smallest >= 0) || !(largest * kFlattest >= double{std::numeric_limits<float>::min()}) ||
      !(largest <= double{std::numeric_limits<float>::max()}))
    return std::nullopt;
  DMat3 out = glm::mat3_cast(turn / length);
  for (int axis = 0; axis < 3; ++axis) out[axis] *= std::max(deviations[axis], largest * kFlattest);
  return Mat3(out);
}

Vec3 color_of_harmonics(const Vec3& degree_0) {
  constexpr double kValue = 0.2820947917738781;  // of the harmonic: 1 / (2 sqrt(pi))
  return Vec3(DVec3(degree_0) * kValue + 0.5);
}

}  // namespace carousel::scene
