#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "core/statistics/ray_stage_counts.h"
#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/html/still.h"

namespace carousel::report::html {

namespace {

/// Cycles a ray in one stage, of one row of the section.
double of_a_ray(const Json& row, const char* stage) {
  const double rays = number_at(row, "rays");
  return rays > 0 ? number_at(row, stage) / rays : 0;
}

/// The stages in which rays spend any time, longest first.
std::vector<Counter<RayStageCounts>> stages_of(const Json& time) {
  std::vector<Counter<RayStageCounts>> out;
  for (const Counter<RayStageCounts>& row : kCounters<RayStageCounts>)
    if (number_at(time, row.name) > 0) out.push_back(row);
  std::stable_sort(out.begin(), out.end(),
                   [&](const auto& a, const auto& b) { return number_at(time, a.name) > number_at(time, b.name); });
  return out;
}

}  // namespace

Html ray_time_section(const Json& report) {
  const Json* time = find(report, "ray_time");
  const double cycles = time ? number_at(*time, "cycles") : 0;
  if (cycles <= 0) return {};
  const auto stages = stages_of(*time);
  Table bars{"ray-time", "Where a ray's cycles go", {{"stage"}, {"cycles a ray", "cycles"}, {"share"}, {"meaning"}}};
  for (const auto& stage : stages)
    bars.rows.push_back({cell(words(stage.name)), cell(Json(of_a_ray(*time, stage.name))),
                         share(number_at(*time, stage.name) / cycles), cell(stage.meaning)});
  Table kinds{"ray-time-kinds", "Cycles a ray, by kind and bounce", {{"rays"}, {"number", "rays"}, {"all", "cycles"}}};
  for (const auto& stage : stages) kinds.columns.push_back({words(stage.name), "cycles", stage.meaning});
  for (const Json& row : (*time)["by_kind"]) {
    std::vector<Cell> cells{cell(fmt::format("{}, bounce {}", text_at(row, "kind"), number_at(row, "bounce"))),
                            cell(row["rays"]), cell(Json(of_a_ray(row, "cycles")))};
    for (const auto& stage : stages) cells.push_back(cell(Json(of_a_ray(row, stage.name))));
    kinds.rows.push_back(std::move(cells));
  }
  return markup(
             "<p>A ray takes {:.1f} cycles from its making until it has been shaded, in the mean of {} rays. Each of "
             "them is in one stage, that which led to its next test; the stages add up to the cycle.</p>\n",
             number_at(*time, "latency"), value_text((*time)["rays"])) +
         Figure{.id = "fig-ray-time",
                .kind = "bars",
                .tables = bars.id,
                .title = bars.caption,
                .label = "Bars: cycles a ray in each stage, longest first.",
                .height = bars_height(bars),
                .still = still_bars(bars, 1)}
             .html() +
         bars.html() + kinds.html();
}

}  // namespace carousel::report::html
