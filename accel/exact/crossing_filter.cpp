#include "accel/exact/crossing_filter.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace carousel::accel {

// No bound below has to account for underflow: every vertex is a multiple of 2^-298, so volumes are of 2^-745 and
// numerators of 2^-894, and no term of theirs is denormal. Nor does anything overflow: vertices stay below 2^258.
FilteredCrossing filtered_crossing(const Ray& ray, const std::array<Vec3, 3>& model, const scene::Affine& m) {
  constexpr double kEps = 0x1p-53;  // relative error of one rounding
  DVec3 p[3];
  double large = 0, size = 0;
  for (int k = 0; k < 3; ++k) {
    for (int row = 0; row < 3; ++row) {
      // Products of two floats are exact; the difference and three sums round.
      const double offset = double(m.translation[row]) - ray.origin[row];
      double x = offset, terms = std::fabs(offset);
      for (int c = 0; c < 3; ++c) {
        const double product = double(m.linear[c][row]) * model[static_cast<std::size_t>(k)][c];
        x += product;
        terms += std::fabs(product);
      }
      p[k][row] = x;
      large = std::max(large, std::fabs(x));
      size = std::max(size, terms);
    }
  }
  const double e = 5 * kEps * size;  // bounds the error of a vertex's coordinate
  const DVec3 d(ray.direction);
  const double along = std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z);
  // A volume is six products d p p: two a component of d. Each is off by what e makes of it and by five roundings.
  const double volume_error = 1.01 * along * (4 * e * large + 2 * e * e + 12 * kEps * large * large);
  const DVec3 n12 = glm::cross(p[1], p[2]);
  const double v[3] = {glm::dot(d, n12), glm::dot(d, glm::cross(p[2], p[0])), glm::dot(d, glm::cross(p[0], p[1]))};
  const double least = std::min({v[0], v[1], v[2]}), most = std::max({v[0], v[1], v[2]});
  FilteredCrossing out;
  if (least < -volume_error && most > volume_error) {
    out.verdict = FilteredCrossing::Verdict::kMiss;
    return out;
  }
  if (!(least > volume_error || most < -volume_error)) return out;
  const double sum = v[0] + v[1] + v[2], sum_error = 4 * volume_error;  // three volumes' and two roundings
  if (!(std::fabs(sum) > 2 * sum_error)) return out;
  // Six products p p p, in the same way.
  const double p2 = large * large;
  const double numerator_error = 1.01 * (18 * e * p2 + 18 * e * e * large + 6 * e * e * e + 32 * kEps * p2 * large);
  const double t = glm::dot(p[0], n12) / sum;
  const double error =
      1.01 * ((numerator_error + std::fabs(t) * sum_error) / (std::fabs(sum) - sum_error) + 2 * kEps * std::fabs(t));
  out.verdict = FilteredCrossing::Verdict::kHit;
  out.t_lo = t - error;
  out.t_hi = t + error;
  return out;
}

}  // namespace carousel::accel
