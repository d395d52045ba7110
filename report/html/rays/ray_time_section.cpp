#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/statistics/ray_stage_counts.h"
#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/html/still.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

namespace {

/// The stages as charts name them, as what a ray is doing; others, of later programs, by their keys.
constexpr std::pair<std::string_view, const char*> kStages[] = {{"slot", "waiting for a slot"},
                                                                {"load", "being loaded"},
                                                                {"collection", "waiting in collections"},
                                                                {"issue", "in issue queues"},
                                                                {"shapes", "waiting for shapes"},
                                                                {"input", "in input queues"},
                                                                {"dispatch", "in dispatch"},
                                                                {"others", "behind tests of other rays"},
                                                                {"test", "in test"},
                                                                {"egress", "waiting for a link"},
                                                                {"link", "on links"},
                                                                {"home", "on the way home"},
                                                                {"opacity", "waiting for opacity"},
                                                                {"to_shading", "on the way to shading"},
                                                                {"shade_queue", "waiting for a shader worker"},
                                                                {"shading", "in shading"}};

std::string stage_words(std::string_view name) {
  for (const auto& [key, text] : kStages)
    if (key == name) return text;
  return words(name);
}

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

/// The bars of `kinds` without scripts, as parts of the longest: `table` has a row's name, rays and all cycles first,
/// and its stages then. Stages without a hue of their own are added up.
Html still_kinds(const Table& table) {
  constexpr std::size_t kFirst = 3, kMost = 10;
  double longest = 0;
  for (const auto& row : table.rows) longest = std::max(longest, row[kFirst - 1].number.get<double>());
  if (longest <= 0) return {};
  Table shares{"", "", {{"rays"}, {"all"}}};
  const std::size_t shown = std::min(kMost, table.columns.size() - kFirst);
  for (std::size_t c = 0; c < shown; ++c) shares.columns.push_back({table.columns[kFirst + c].title});
  shares.columns.push_back({"all others"});
  for (const auto& row : table.rows) {
    std::vector<Cell> cells{row[0], {row[kFirst - 1].text}};
    double rest = row[kFirst - 1].number.get<double>();
    for (std::size_t c = 0; c < shown; ++c) {
      const double cycles = row[kFirst + c].number.get<double>();
      cells.push_back(share(cycles / longest));
      rest -= cycles;
    }
    cells.push_back(share(rest > 1e-9 * longest ? rest / longest : 0));
    shares.rows.push_back(std::move(cells));
  }
  return still_stack(shares);
}

}  // namespace

std::string longest_stages(const Json& report) {
  const Json* time = find(report, "ray_time");
  const double cycles = time ? number_at(*time, "cycles") : 0;
  if (cycles <= 0) return {};
  const auto stages = stages_of(*time);
  const auto part = [&](std::size_t i) { return number_at(*time, stages[i].name) / cycles; };
  std::string out = fmt::format("A ray spends {} of its {} cycles {}", percent(part(0)),
                                value_text(Json(number_at(*time, "latency"))), stage_words(stages[0].name));
  if (stages.size() > 1 && part(1) >= 0.05)
    out += fmt::format(", and {} {}", percent(part(1)), stage_words(stages[1].name));
  return out + ".";
}

Html ray_time_section(const Json& report) {
  const Json* time = find(report, "ray_time");
  const double cycles = time ? number_at(*time, "cycles") : 0;
  if (cycles <= 0) return {};
  const auto stages = stages_of(*time);
  Table bars{"ray-time", "Where a ray's cycles go", {{"stage"}, {"cycles a ray", "cycles"}, {"share"}, {"meaning"}}};
  for (const auto& stage : stages)
    bars.rows.push_back({cell(stage_words(stage.name)), cell(Json(of_a_ray(*time, stage.name))),
                         share(number_at(*time, stage.name) / cycles), cell(stage.meaning)});
  Table kinds{"ray-time-kinds", "Cycles a ray, by kind and bounce", {{"rays"}, {"number", "rays"}, {"all", "cycles"}}};
  for (const auto& stage : stages) kinds.columns.push_back({stage_words(stage.name), "cycles", stage.meaning});
  for (const Json& row : (*time)["by_kind"]) {
    std::vector<Cell> cells{cell(fmt::format("{}, bounce {}", text_at(row, "kind"), number_at(row, "bounce"))),
                            cell(row["rays"]), cell(Json(of_a_ray(row, "cycles")))};
    for (const auto& stage : stages) cells.push_back(cell(Json(of_a_ray(row, stage.name))));
    kinds.rows.push_back(std::move(cells));
  }
  return markup(
             "<p>A ray takes {} cycles from its making until it has been shaded, in the mean of {} rays. Each of "
             "them is in one stage, that which led to its next test; the stages add up to the cycle.</p>\n",
             value_text((*time)["latency"]), value_text((*time)["rays"])) +
         Figure{.id = "fig-ray-time",
                .kind = "bars",
                .tables = bars.id,
                .title = bars.caption,
                .label = "Bars: cycles a ray in each stage, longest first.",
                .height = bars_height(bars),
                .still = still_bars(bars, 1)}
             .html() +
         bars.html() +
         (kinds.rows.empty()
              ? Html()
              : Figure{.id = "fig-ray-time-kinds",
                       .kind = "amounts",
                       .tables = kinds.id,
                       .title = kinds.caption,
                       .label = "Bars: cycles a ray of each kind and bounce, in pieces, a piece a stage.",
                       .height = bars_height(kinds) + 60,
                       .still = still_kinds(kinds)}
                    .html()) +
         kinds.html();
}

}  // namespace carousel::report::html
