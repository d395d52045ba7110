#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "accel/certificate/case_values.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/properties.h"
#include "accel/certificate/triangle_cases.h"
#include "accel/certificate/triangle_oracle.h"
#include "accel/exact/exact_triangle.h"

namespace carousel::accel {

namespace {

constexpr float kLargestFloat = std::numeric_limits<float>::max();

/// The position, in the ray's range, of a crossing that the oracle knows.
struct Range {
  bool inside,
      at_an_end;  ///< at_an_end: outside by so little that the nearest float is the end, and either answer is right

  Range(const TriangleOracle& oracle, const Ray& ray) {
    const float last = std::min(ray.tmax, kLargestFloat);
    const bool early = oracle.hit() && oracle.compare_t(ray.tmin) < 0,
               late = oracle.hit() && oracle.compare_t(last) > 0;
    inside = oracle.hit() && !early && !late;
    at_an_end = (early && oracle.t_is_nearest(ray.tmin)) || (late && oracle.t_is_nearest(last));
  }
};

std::string described(const TriangleOracle& oracle) {
  if (!oracle.hit()) return "not crossed";
  return fmt::format("crossed at t = {:.17g}, u = {:.17g}, v = {:.17g}", oracle.t(), oracle.u(), oracle.v());
}

void judge_triangle(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                    CaseStory* story) {
  const std::optional<TriangleCase> judged = judged_triangle(values);
  if (!judged) return;
  const Ray& ray = judged->ray;
  const Corners& corners = judged->corners;
  const TriangleOracle oracle(ray, corners);
  const Range range(oracle, ray);
  OneLeaf leaf({&corners, 1});
  for (std::size_t i = 0; i < levels.size(); ++i) {
    // Boxes in double miss nothing at any exponent, so that only the triangle test is judged.
    AccuracyConfig level = levels[i];
    level.box = BoxLevel::kDouble;
    const Hit hit = leaf.hit(ray, level);
    Judgement& judgement = out[i];
    judgement.applies = !range.at_an_end;
    judgement.broken = !range.at_an_end && hit.valid() != range.inside;
    if (hit.valid() && range.inside) judgement.error = ulps_between(hit.t, oracle.t());
    if (story != nullptr) *story = {text(hit), described(oracle)};
    if (level.triangle != TriangleLevel::kExact) continue;
    NearestCrossing crossing{};
    const bool crossed = exact_triangle(ray, corners, crossing);
    judgement.broken |= crossed != oracle.hit();
    if (crossed && oracle.hit())
      judgement.broken |=
          !oracle.t_is_nearest(crossing.t) || !oracle.u_is_nearest(crossing.u) || !oracle.v_is_nearest(crossing.v);
    if (hit.valid() && crossed) judgement.broken |= hit.t < crossing.t || hit.u != crossing.u || hit.v != crossing.v;
    if (story != nullptr && crossed)
      story->kernel += fmt::format("; by itself crossed at t = {}, u = {}, v = {}", text(crossing.t), text(crossing.u),
                                   text(crossing.v));
  }
}

}  // namespace

Property triangle_property() {
  return {"triangle",
          3,
          "a triangle is hit where the exact ray crosses it; exact: t, u and v are the nearest floats",
          "ulp of t",
          {AccuracyKey::kTriangle},
          ray_and({{"a", 3}, {"b", 3}, {"c", 3}}),
          [](const AccuracyConfig& level) { return level.triangle == TriangleLevel::kExact; },
          make_triangle,
          judge_triangle};
}

}  // namespace carousel::accel
