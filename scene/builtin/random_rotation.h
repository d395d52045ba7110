#pragma once

#include <cmath>
#include <numbers>

#include <glm/gtc/quaternion.hpp>

#include "core/numeric/trigonometry.h"
#include "core/types/vec.h"
#include "scene/builtin/hash_random.h"

namespace carousel::scene {

/// A rotation drawn evenly from all of them: Shoemake, "Uniform random rotations", Graphics Gems III, 1992.
inline Mat3 random_rotation(HashRandom& random) {
  const float tau = 2 * std::numbers::pi_v<float>;
  const float u = random.uniform(), a = tau * random.uniform(), b = tau * random.uniform();
  const float r = std::sqrt(1 - u), s = std::sqrt(u);
  return glm::mat3_cast(glm::quat(s * cos_float(b), r * sin_float(a), r * cos_float(a), s * sin_float(b)));
}

}  // namespace carousel::scene
