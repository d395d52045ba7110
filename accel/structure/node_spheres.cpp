#include "accel/structure/node_spheres.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

constexpr double kSlack = 0x1p-18;   // a part of the distance, see the header
constexpr double kLeast = 0x1p-120;  // where reciprocals overflow

}  // namespace

std::uint32_t intersect_spheres(const NodeSpheres& spheres, int count, const Vec3& origin, const Vec3& direction,
                                float tmin, float tmax, float* entry) {
  const DVec3 o(origin), d(direction);
  const double a = glm::dot(d, d);
  std::uint32_t mask = 0;
  for (int lane = 0; lane < count; ++lane) {
    const DVec3 to = DVec3(spheres.centre[0][lane], spheres.centre[1][lane], spheres.centre[2][lane]) - o;
    const double t = glm::dot(to, d) / a, radius = spheres.radius[lane];
    const double far = std::sqrt(glm::dot(to, to)) + radius, r = radius + kSlack * far + kLeast;
    const DVec3 aside = to - t * d;
    const double half_chord2 = r * r - glm::dot(aside, aside);
    // Comparisons that NaN passes: it comes of infinities, and then nothing is known.
    if (half_chord2 < 0) continue;
    const double half_chord = std::sqrt(half_chord2 / a), in = t - half_chord, out = t + half_chord;
    if (out < tmin || in > tmax) continue;
    mask |= 1u << lane;
    entry[lane] = in > tmin ? rounded_down(in) : tmin;
  }
  return mask;
}

}  // namespace carousel::accel
