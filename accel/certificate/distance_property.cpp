// The distance that the watertight test reports, computed in double (accel/primitive/precise_crossing-inl.h), against
// the exact one. With eps = 2^-53, and each corner's offset from the ray's origin, the shear, its product and the
// difference rounded once, a sheared corner's X is off by at most 4 eps Sx, Sx = |x| + |s z|. An edge's value, two
// products of two of those and a difference, is off by 10 eps M, M = Sx Sy' + Sy Sx'. As the exact values U weigh the
// corners' distances t_k so that sum U_k (t_k - t) = 0, the errors of the values move t by at most
//   mu rho,  mu = 10 eps sum M / |sum U|,  rho = max |t_k - t|,
// and the roundings of t_k (3), of the products, the sums and the quotient (6) by 16 eps max |t_k| at most, weights
// being positive or as good as that where mu <= u. One rounding to float and one of the entry into the triangle's box
// come on top: 2 u |t|.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "accel/certificate/case_values.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/properties.h"
#include "accel/certificate/triangle_cases.h"
#include "accel/certificate/triangle_oracle.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

struct DistanceBound {
  double weights;  ///< mu
  double off;      ///< most that the distance may be off

  DistanceBound(const Ray& ray, const Corners& p, const TriangleOracle& oracle) {
    constexpr double kEps = 0x1p-53;
    int kz = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::fabs(ray.direction[axis]) > std::fabs(ray.direction[kz])) kz = axis;
    const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    const double dz = ray.direction[kz];
    double x[3], y[3], largest = 0, rho = 0, sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double z = double{p[k][kz]} - ray.origin[kz];
      x[k] = std::fabs(double{p[k][kx]} - ray.origin[kx]) + std::fabs(ray.direction[kx] / dz * z);
      y[k] = std::fabs(double{p[k][ky]} - ray.origin[ky]) + std::fabs(ray.direction[ky] / dz * z);
      largest = std::max(largest, std::fabs(z / dz));
      rho = std::max(rho, std::fabs(z / dz - oracle.t()));
    }
    for (std::size_t k = 0; k < 3; ++k) sum += x[k] * y[(k + 1) % 3] + y[k] * x[(k + 1) % 3];
    weights = 10 * kEps * sum / std::fabs(oracle.facing() / dz);
    off = 1.01 * (2 * kUnitRoundoff * std::fabs(oracle.t()) + 16 * kEps * largest + weights * rho) + 0x1p-148;
  }
};

void judge_distance(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                    CaseStory* story) {
  const std::optional<TriangleCase> judged = judged_triangle(values);
  if (!judged) return;
  const Ray& ray = judged->ray;
  const Corners& corners = judged->corners;
  const TriangleOracle oracle(ray, corners);
  if (!oracle.hit() || oracle.compare_t(ray.tmin) < 0 || oracle.compare_t(std::min(ray.tmax, 0x1.fffffep127f)) > 0)
    return;
  const DistanceBound bound(ray, corners, oracle);
  if (!(bound.weights <= kUnitRoundoff)) return;
  OneLeaf leaf({&corners, 1});
  for (std::size_t i = 0; i < levels.size(); ++i) {
    AccuracyConfig level = levels[i];
    level.box = BoxLevel::kDouble;  // whose entries are rounded once
    const Hit hit = leaf.hit(ray, level);
    if (story != nullptr) *story = {text(hit), fmt::format("t = {:.17g}, within {:.3g}", oracle.t(), bound.off)};
    if (!hit.valid()) continue;
    out[i].applies = true;
    out[i].broken = !(std::fabs(hit.t - oracle.t()) <= bound.off);
    out[i].error = ulps_between(hit.t, oracle.t());
  }
}

}  // namespace

Property distance_property() {
  return {"distance",
          8,
          "the distance of a triangle that is met is off by two roundings of a float, and by what double makes of it",
          "ulp of t",
          {AccuracyKey::kTriangle},
          ray_and({{"a", 3}, {"b", 3}, {"c", 3}}),
          [](const AccuracyConfig& level) { return level.triangle != TriangleLevel::kFast; },
          make_triangle,
          judge_distance};
}

}  // namespace carousel::accel
