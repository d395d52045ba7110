#include "report/html/studies/sweep_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/page.h"

namespace carousel::report::html {

namespace {

Json list_at(const Json& sweep, const char* key) {
  return sweep.contains(key) ? sweep[key] : Json::array();
}

bool greater_is_better(const Json& sweep, const Json& result) {
  const Json names = list_at(sweep, "greater_is_better");
  return std::find(names.begin(), names.end(), result) != names.end();
}

/// A row a point: digest, status, keys, results.
Table points_table(const Json& sweep) {
  Table table{"points", "All points", {{"point"}, {"status"}}};
  table.open = true;
  for (const char* part : {"keys", "results"})
    for (const Json& name : list_at(sweep, part)) table.columns.push_back({name.get<std::string>()});
  for (const Json& point : list_at(sweep, "points")) {
    auto& row = table.rows.emplace_back();
    row.push_back(cell(text_at(point, "point")));
    row.push_back(cell(text_at(point, "status")));
    for (const char* part : {"keys", "results"})
      for (const Json& name : list_at(sweep, part)) {
        const Json& values = point.at(part);
        const auto found = values.find(name.get<std::string>());
        row.push_back(found == values.end() || found->is_null() ? cell("–") : cell(*found));
      }
  }
  return table;
}

Table effects_table(const Json& sweep) {
  Table table{"effects",
              "Main effects on all results",
              {{"result"}, {"key"}, {"value"}, {"points"}, {"effect"}, {"low"}, {"high"}, {"mean"}}};
  for (const Json& effect : list_at(sweep, "main_effects"))
    for (const Json& level : effect["levels"]) {
      const auto bound = [&](const char* key) { return level.contains(key) ? cell(level[key]) : cell("–"); };
      const Json& value = level["level"];
      // A value is a name here, even where it is a number.
      table.rows.push_back({cell(text_at(effect, "result")), cell(text_at(effect, "key")),
                            cell(value.is_string() ? value.get<std::string>() : value.dump()), cell(level["points"]),
                            cell(level["effect"]), bound("low"), bound("high"), cell(effect["mean"])});
    }
  return table;
}

/// The point that is best in a result; null if none has a number there.
const Json* best_in(const Json& sweep, const std::string& result) {
  const Json* best = nullptr;
  const bool greater = greater_is_better(sweep, result);
  for (const Json& point : sweep["points"]) {
    const auto value = point["results"].find(result);
    if (value == point["results"].end() || !value->is_number()) continue;
    const double here = value->get<double>();
    if (best == nullptr) {
      best = &point;
      continue;
    }
    const double there = (*best)["results"][result].get<double>();
    if (greater ? here > there : here < there) best = &point;
  }
  return best;
}

std::string keys_text(const Json& point) {
  std::string out;
  for (const auto& [key, value] : point["keys"].items())
    out += (out.empty() ? "" : ", ") + key + " = " + (value.is_string() ? value.get<std::string>() : value.dump());
  return out;
}

/// The Pareto front of the chosen results: its points, the first of which is best in the first result.
Html front_of(const Json& sweep) {
  const Json* pareto = find(sweep, "pareto");
  if (!pareto || (*pareto)["points"].empty()) return {};
  const Json& goals = (*pareto)["goals"];
  const std::string a = text_at(goals[0], "result"), b = text_at(goals[1], "result");
  Table table{"front", fmt::format("Pareto front of {} and {}", a, b), {{"keys"}, {a}, {b}, {"point"}}};
  table.open = true;
  for (const Json& digest : (*pareto)["points"])
    for (const Json& point : sweep["points"])
      if (point["point"] == digest)
        table.rows.push_back({cell(keys_text(point)), cell(point["results"].value(a, Json())),
                              cell(point["results"].value(b, Json())), cell(text_at(point, "point"))});
  const std::size_t all = sweep["points"].size();
  Html out = markup("<p class=\"verdict\">{}</p>\n",
                    table.rows.size() == 1
                        ? fmt::format("One point is best in both {} and {}: {}.", a, b, table.rows[0][0].text)
                        : fmt::format("Of {} points, {} are a trade-off of {} and {}.", all, table.rows.size(), a, b));
  return out + table.html();
}

Html glance_of(const Json& sweep) {
  std::size_t done = 0, failed = 0, missing = 0;
  for (const Json& point : sweep["points"]) {
    const std::string status = text_at(point, "status");
    ++(status == "done" ? done : status == "failed" ? failed : missing);
  }
  Html out;
  if (missing > 0)
    out += markup("<p class=\"notice\"><strong>Incomplete:</strong> {} points have not run.</p>\n", missing);
  out += front_of(sweep);
  for (const Json& name : list_at(sweep, "results")) {
    if (sweep.contains("pareto")) break;
    const std::string result = name.get<std::string>();
    const Json* best = best_in(sweep, result);
    if (best == nullptr) continue;
    out += markup("<p class=\"verdict\">The {} {}, {}, are those of {}.</p>\n",
                  greater_is_better(sweep, result) ? "most" : "least", result, value_text((*best)["results"][result]),
                  keys_text(*best));
    break;
  }
  out += markup(
      "<p>{} points: {} done, {} failed, {} to run. Configuration: <code>{}</code>. The numbers as <a "
      "href=\"sweep.csv\">CSV</a> and <a href=\"sweep.json\">JSON</a>.</p>\n",
      sweep["points"].size(), done, failed, missing, text_at(sweep, "config"));
  return out;
}

Html failures_of(const Json& sweep) {
  Table table{"failures", "Points without a result", {{"point"}, {"keys"}, {"kind"}, {"error"}}};
  for (const Json& point : sweep["points"])
    if (point.contains("error"))
      table.rows.push_back({cell(text_at(point, "point")), cell(keys_text(point)), cell(text_at(point, "error.kind")),
                            cell(text_at(point, "error.text"))});
  return table.html();
}

}  // namespace

std::string sweep_page(const Json& sweep, const std::string& folder, bool asks) {
  const Table points = points_table(sweep), effects = effects_table(sweep);
  const auto figure = [](const char* id, const char* kind, const char* tables, const char* title, const char* label) {
    return Figure{.id = id, .kind = kind, .tables = tables, .title = title, .label = label, .height = 420}.html();
  };
  const Html plot = figure("fig-sweep", "sweep_plot", "points", "Any key or result over any other",
                           "Scatter or line plot of two columns of the table of all points, chosen above the plot.");
  const Html pareto =
      figure("fig-pareto", "sweep_pareto", "points", "Pareto front of two results",
             "Scatter plot of two results, with a line through the points that no other point betters in one of them "
             "without being worse in the other.");
  const Html means =
      figure("fig-effects", "sweep_effects", "effects", "Main effects on a result",
             "Dots with intervals of 95 percent, a line a value of a key: the difference of its points from the mean.");
  const Html about = markup(
      "<p>An effect is the difference of a value's mean from the mean of all points, the other keys accounted for. Its "
      "interval (95 %) comes from the part that the additive model leaves unexplained.</p>\n");
  const Html between = markup(
      "<p>Between the points of the grid around it a result is taken in proportion, by logarithms where it and the "
      "key's values allow. {}</p>\n<div id=\"between-points\"></div>\n",
      asks ? "The button runs the chosen point itself, into the folder asked of the sweep."
           : "With carousel serve the page also runs the chosen point itself.");
  const bool any = !points.rows.empty() && !list_at(sweep, "results").empty();
  return page_of("Carousel: sweep of " + text_at(sweep, "config"), "carousel sweep",
                 {{"glance", "At a glance", glance_of(sweep)},
                  {"pareto", "Pareto front", any && sweep["results"].size() > 1 ? pareto : Html()},
                  {"plots", "Keys and results", any ? plot : Html()},
                  {"between", "Between the points", any ? between : Html()},
                  {"effects", "Main effects", effects.rows.empty() ? Html() : about + means + effects.html()},
                  {"points", "Points", points.html()},
                  {"failures", "Failures", failures_of(sweep)}},
                 {{"sweep",
                   {{"folder", folder},
                    {"keys", list_at(sweep, "keys")},
                    {"results", list_at(sweep, "results")},
                    {"asks", asks},
                    {"greater_is_better", list_at(sweep, "greater_is_better")},
                    {"pareto", sweep.contains("pareto") ? sweep["pareto"]["goals"] : Json::array()}}}},
                 {}, asks);
}

}  // namespace carousel::report::html
