#include "shading/surface/spawn_point.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/numeric/condition.h"

namespace carousel::shading {

namespace {

// gamma(n) = n u / (1 - n u) bounds n roundings: N. J. Higham, "Accuracy and stability of numerical
// algorithms", SIAM 2002, section 3.1; used for spawned rays as in M. Pharr, W. Jakob, G. Humphreys,
// "Physically based rendering", section "Managing rounding error".
constexpr double gamma(int n) {
  constexpr double kUnit = 0x1p-24;
  return n * kUnit / (1.0 - n * kUnit);
}

float next_up(float x) {
  if (x == 0.0f) return std::bit_cast<float>(std::uint32_t{1});
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return std::bit_cast<float>(x > 0.0f ? bits + 1 : bits - 1);
}

/// The float beyond `x` in the direction of `towards`, one more step further out; nearest if it is 0.
float round_outwards(double x, double towards) {
  const auto nearest = static_cast<float>(x);
  if (!std::isfinite(nearest) || towards == 0.0) return nearest;
  if (towards > 0.0) return next_up(double{nearest} < x ? next_up(nearest) : nearest);
  return -next_up(double{nearest} > x ? next_up(-nearest) : -nearest);
}

/// C. Wächter, N. Binder, "A fast and robust method for avoiding self-intersection", Ray Tracing Gems 2019,
/// chapter 6.
float offset_by_ulps(float p, float n) {
  if (std::abs(p) < 1.0f / 32.0f) return p + n * (1.0f / 65536.0f);
  const auto steps = static_cast<std::int32_t>(256.0f * n);
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(p) + (p < 0.0f ? -steps : steps));
}

}  // namespace

/// Bound of the intersection kernel's own error along the normal, in the space it works in. Its weights are areas with
/// an error of a few u L^2, where L is the distance of the vertices. Divided by the triangle's own area and multiplied
/// by L the error is u L (L / h), h the least height: a large value for slivers, whose t really has such an error. The
/// direction cancels out, since the projected area shrinks as the ray turns away from the normal.
double kernel_error(const TriangleGeometry& g, const DVec3& p) {
  const DVec3 e0 = g.model[1] - g.model[0], e1 = g.model[2] - g.model[1], e2 = g.model[0] - g.model[2];
  double far = 0;
  for (const DVec3& v : g.model) far = std::max(far, glm::dot(v - p, v - p));
  const double longest = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
  const double area2 = glm::length(glm::cross(e0, e1));
  return area2 > 0.0 ? gamma(2) * std::sqrt(far) * (longest / area2) : 0.0;
}

double spawn_distance(const TriangleGeometry& g) {
  // Everything is measured along the normal n: a model-space error e moves the plane distance by at most
  // |R^T n| . |e|, which is far less than |n| . |R| |e| where R shears.
  const DVec3 n = glm::abs(g.normal);
  const DVec3 model_n = glm::abs(glm::transpose(g.linear) * g.normal);
  const DVec3 point = std::abs(g.weights[0]) * glm::abs(g.model[0]) + std::abs(g.weights[1]) * glm::abs(g.model[1]) +
                      std::abs(g.weights[2]) * glm::abs(g.model[2]);
  double distance = gamma(7) * glm::dot(model_n, point);  // the barycentric point in float
  distance += kernel_error(g, g.weights[0] * g.model[0] + g.weights[1] * g.model[1] + g.weights[2] * g.model[2]) *
              glm::length(model_n);

  const bool identity = g.linear == DMat3(1.0) && g.translation == DVec3(0.0);
  if (identity) return distance;
  const DMat3 abs_linear{glm::abs(g.linear[0]), glm::abs(g.linear[1]), glm::abs(g.linear[2])};
  distance += gamma(4) * glm::dot(n, abs_linear * point + glm::abs(g.translation));  // R p + T in float
  // The way back, R^-1 (o - T): the difference, the entries of the inverse, three products and two sums.
  const DMat3 inverse = glm::inverse(g.linear);
  const DMat3 abs_inverse{glm::abs(inverse[0]), glm::abs(inverse[1]), glm::abs(inverse[2])};
  const DVec3 back = abs_inverse * glm::abs(g.position - g.translation);
  if (!(skeel_condition(g.linear) > kConditionForFloat)) return distance + gamma(5) * glm::dot(model_n, back);
  // In double, with the entries to 48 bits, and rounded once at the end (accel/transform/transform.h, level_for()).
  return distance + glm::dot(model_n, gamma(1) * glm::abs(inverse * (g.position - g.translation)) + 0x1p-45 * back);
}

Vec3 spawn_point(const TriangleGeometry& g, Side side, SpawnOffset offset) {
  const DVec3 n = side == Side::kFront ? g.normal : -g.normal;
  const DVec3 from =
      g.error > 0 ? g.position + g.error * glm::length(glm::transpose(g.linear) * g.normal) * n : g.position;
  switch (offset) {
    case SpawnOffset::kEpsilon:
      return Vec3(from) + 1e-4f * Vec3(n);
    case SpawnOffset::kUlp: {
      const Vec3 p(from), normal(n);
      return {offset_by_ulps(p.x, normal.x), offset_by_ulps(p.y, normal.y), offset_by_ulps(p.z, normal.z)};
    }
    case SpawnOffset::kBound:
      break;
  }
  const DVec3 p = from + spawn_distance(g) * n;
  return {round_outwards(p.x, n.x), round_outwards(p.y, n.y), round_outwards(p.z, n.z)};
}

}  // namespace carousel::shading
