#include "scene/gltf/pose/track.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "scene/gltf/pose/slerp.h"

namespace carousel::scene {

namespace {

glm::dvec4 unit_quaternion(const float* v) {
  return glm::normalize(glm::dvec4(v[0], v[1], v[2], v[3]));
}

}  // namespace

std::vector<double> Track::at(double seconds) const {
  const bool cubic = interpolation == Interpolation::kCubicSpline;
  const std::size_t stride = cubic ? 3 * width : width;
  const auto value = [&](std::size_t key) { return &values[key * stride + (cubic ? width : 0)]; };
  const auto alone = [&](std::size_t key) { return std::vector<double>(value(key), value(key) + width); };
  const auto after = static_cast<std::size_t>(std::ranges::upper_bound(times, seconds) - times.begin());
  if (after == 0) return alone(0);
  const std::size_t k = after - 1;
  if (after == times.size() || interpolation == Interpolation::kStep) return alone(k);

  const double from = times[k], length = times[after] - from, t = (seconds - from) / length;
  const float *const a = value(k), *const b = value(after);
  std::vector<double> out(width);
  if (!cubic) {
    if (rotation) {
      const glm::dvec4 q = slerp(unit_quaternion(a), unit_quaternion(b), t);
      return {q.x, q.y, q.z, q.w};
    }
    for (std::size_t i = 0; i < width; ++i) out[i] = (1 - t) * a[i] + t * b[i];
    return out;
  }
  const double t2 = t * t, t3 = t2 * t;
  const float *const leaving = a + width, *const arriving = b - width;
  for (std::size_t i = 0; i < width; ++i)
    out[i] = (2 * t3 - 3 * t2 + 1) * a[i] + length * (t3 - 2 * t2 + t) * leaving[i] + (3 * t2 - 2 * t3) * b[i] +
             length * (t3 - t2) * arriving[i];
  return out;
}

}  // namespace carousel::scene
