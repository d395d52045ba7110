#include "report/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/text/number_text.h"

namespace carousel::report {

namespace {

std::string levels_text(const AccuracyRow& row) {
  return fmt::format("{} + {} + {}", row.triangle, row.box, row.transform);
}

const AccuracyRow* fastest(const std::vector<AccuracyRow>& rows, bool safe_only) {
  const AccuracyRow* best = nullptr;
  for (const AccuracyRow& row : rows)
    if ((row.safe || !safe_only) && (best == nullptr || row.ns_per_ray.median < best->ns_per_ray.median)) best = &row;
  return best;
}

}  // namespace

void mark_frontier(std::vector<AccuracyRow>& rows) {
  for (AccuracyRow& row : rows) {
    row.frontier = std::none_of(rows.begin(), rows.end(), [&](const AccuracyRow& other) {
      const double time = row.ns_per_ray.median, other_time = other.ns_per_ray.median;
      return (other_time < time && other.wrong() <= row.wrong()) || (other_time <= time && other.wrong() < row.wrong());
    });
  }
}

std::string accuracy_verdict(const std::vector<AccuracyRow>& rows) {
  if (rows.empty()) return "";
  const AccuracyRow& first = *fastest(rows, false);
  const AccuracyRow* const safe = fastest(rows, true);
  const std::string cost_of_first = fmt::format(
      "{} ({:.0f} ns a ray) leaks {} and answers {} of {} rays of the scene wrongly", levels_text(first),
      first.ns_per_ray.median, grouped(first.leaks), grouped(first.scene.wrong()), grouped(first.scene.rays));
  if (safe == nullptr) return "No combination is safe for this scene; the fastest, " + cost_of_first + ".";
  if (safe == &first)
    return fmt::format("The cheapest safe level for this scene is also the fastest: {} ({:.0f} ns a ray).",
                       levels_text(first), first.ns_per_ray.median);
  return fmt::format(
      "The cheapest safe level for this scene is {} at {:.0f} ns a ray, {:+.0f} % over the fastest; that one, {}.",
      levels_text(*safe), safe->ns_per_ray.median, 100 * (safe->ns_per_ray.median / first.ns_per_ray.median - 1),
      cost_of_first);
}

double log_log_slope(const std::vector<SamplingRow>& rows) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const SamplingRow& row : rows) {
    if (row.rmse <= 0) continue;
    const double a = std::log(static_cast<double>(row.samples)), b = std::log(row.rmse);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  const double determinant = n * xx - x * x;
  return determinant > 0 ? (n * xy - x * y) / determinant : 0;
}

}  // namespace carousel::report
