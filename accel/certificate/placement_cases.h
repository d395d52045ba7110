#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "accel/certificate/adversarial_numbers.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Rotation about an axis of any length: Rodrigues' formula.
inline DMat3 rotation(const DVec3& axis, double degrees) {
  const DVec3 a = glm::normalize(axis);
  const double angle = degrees * std::numbers::pi / 180, s = std::sin(angle), c = std::cos(angle);
  const DMat3 cross({0, a.z, -a.y}, {-a.z, 0, a.x}, {a.y, -a.x, 0});
  return c * DMat3(1.0) + s * cross + (1 - c) * glm::outerProduct(a, a);
}

/// M = T S Rot in double, rounded once: rotate, then scale, then translate.
inline scene::Affine rotate_scale_translate(const DVec3& axis, double degrees, const DVec3& scale, const DVec3& t) {
  return {Mat3(DMat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z) * rotation(axis, degrees)), Vec3(t)};
}

/// The three examples of US 12394134.
inline std::array<scene::Affine, 3> patent_placements() {
  return {rotate_scale_translate({-0.484658, 0.310767, -0.817637}, 166, {5.062899, 1.343523, 1.331195},
                                 {-6139.630859, -918.470093, 49161.503906}),
          rotate_scale_translate({0.506287, 0.219681, 0.833915}, 328, {-1.337073, -0.625314, 1.900729},
                                 {2.952133, 1.276896, -44.617302}),
          rotate_scale_translate({-0.490687, 0.033258, -0.870701}, 243, {4.662860, 0.188493, 0.213617},
                                 {-12816.281250, 16287.140625, -115868.531250})};
}

/// Rotated and unevenly scaled, mirrored or not, from near singular to plain; up to a million units away.
template <class Random>
scene::Affine placement_case(Random& random) {
  const std::uint32_t kind = random.below(8);
  const DVec3 away = log_uniform(random, 1e-2, 1e6) * random_direction(random);
  if (kind == 0) return patent_placements()[random.below(3)];
  if (kind == 1) return {Mat3(1.0f), Vec3(away)};
  DVec3 scale(1);
  if (kind < 6)
    for (int a = 0; a < 3; ++a) scale[a] = log_uniform(random, 0.1, 10) * (random.below(4) ? 1 : -1);
  scene::Affine m = rotate_scale_translate(random_direction(random), 360.0 * random.uniform(), scale, away);
  if (kind == 7) {
    const double thin = log_uniform(random, 1e-6, 1);
    const DMat3 sheared({1, random.uniform(), -random.uniform()}, {0, thin, 0}, {random.uniform(), 0, 1});
    m.linear = Mat3(DMat3(m.linear) * sheared);
  }
  return m;
}

}  // namespace carousel::accel
