#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

namespace {

/// A column of the table of parts: its title and what its numbers are multiplied with, so that they are readable.
struct PartColumn {
  std::string title;
  double times = 1;
};
PartColumn part_column(const std::string& key) {
  if (key == "joules") return {"energy, mJ", 1e3};
  if (key == "nj_per_ray") return {"nJ a ray"};
  if (key == "pj_each") return {"pJ each"};
  if (key == "mm2") return {"area, mm²"};
  return {words(key)};
}

/// The parts of energy or area as one bar, and a table of them. The bar has a colour for each part that is seen in it;
/// what is less stands together.
Html parts_of(const Json& report, const Json& schema, const std::string& section, const char* value,
              const char* title) {
  constexpr std::size_t kColours = 10;
  const double all = number_at(report, section + "." + value);
  const Json* parts = find(report, section + ".parts");
  if (!parts || all <= 0) return {};
  Table shares{section + "-shares", std::string("Shares: ") + title, {{"of"}}},
      table{section + "-parts", title, {{"part"}}};
  const Json& meanings = schema_at(schema, "properties." + section + ".properties.parts");
  std::vector<std::pair<double, std::string>> sizes;
  for (const auto& [key, part] : parts->items()) {
    const double amount = number_at(part, value);
    if (amount <= 0) continue;
    sizes.emplace_back(amount, words(key));
    auto& row = table.rows.emplace_back();
    row.push_back(cell(words(key)));
    for (const auto& [name, number] : part.items()) {
      const PartColumn column = part_column(name);
      if (table.rows.size() == 1) table.columns.push_back({column.title});
      row.push_back(column.times == 1 ? cell(number) : cell(Json(column.times * number.get<double>())));
    }
    row.push_back(share(amount / all));
    row.push_back(cell(text_at(schema_at(meanings, "properties." + key), "description")));
  }
  table.columns.push_back({"share"});
  table.columns.push_back({"meaning"});
  std::stable_sort(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  shares.rows.push_back({cell("the machine")});
  double rest = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (i >= kColours && sizes.size() > kColours + 1) {
      rest += sizes[i].first;
      continue;
    }
    shares.columns.push_back({sizes[i].second, "", "share"});
    shares.rows.front().push_back(share(sizes[i].first / all));
  }
  if (rest > 0) {
    shares.columns.push_back({"all others", "", "share"});
    shares.rows.front().push_back(share(rest / all));
  }
  return Figure{.id = "fig-" + section,
                .kind = "stacked",
                .tables = shares.id,
                .title = title,
                .label = fmt::format("A stacked bar: the shares of the parts, which add up to 100 percent of the {}.",
                                     section),
                .height = 180,
                .still = still_stack(shares)}
             .html() +
         shares.html() + table.html();
}

/// Curves of the energy in each sample of the time series.
Html over_time(const Json& report) {
  const Json* rows = find(report, "time_series.rows");
  if (!rows) return {};
  std::vector<std::string> parts;
  for (const Json& row : *rows)
    if (text_at(row, "unit") == "J") parts.push_back(text_at(row, "quantity"));
  if (parts.empty()) return {};
  return Figure{.id = "fig-energy-time",
                .kind = "series",
                .tables = "J",
                .title = fmt::format("Energy over time, in each {} cycles",
                                     value_text(Json(number_at(report, "time_series.interval")))),
                .label = fmt::format("Curves over time: {}. The table of rows over time has least, mean and greatest.",
                                     fmt::join(parts, ", ")),
                .height = 340}
      .html();
}

}  // namespace

Html energy_section(const Json& report, const Json& schema) {
  if (!find(report, "energy")) return {};
  Html out = markup(
      "<p>A completed ray costs {:.4g} nJ: {:.4g} mJ for the run and {:.4g} W at the clock, which is {:.4g} Mrays a "
      "joule. The machine has {:.4g} mm², and {:.4g} Mrays/s on each of them. Leakage, clocks and the memory's area "
      "are "
      "not counted.</p>\n",
      number_at(report, "energy.nj_per_ray"), 1e3 * number_at(report, "energy.joules"),
      number_at(report, "energy.watts"), 1e-6 * number_at(report, "energy.rays_per_joule"),
      number_at(report, "area.mm2"), number_at(report, "area.mrays_per_second_per_mm2"));
  if (const Json* peak = find(report, "energy.peak")) {
    const double mean = number_at(report, "energy.watts"), watts = number_at(*peak, "watts");
    out += markup("<p>Power is highest in the {} cycles from cycle {} on: {:.4g} W", value_text((*peak)["cycles"]),
                  value_text((*peak)["first_cycle"]), watts);
    if (mean > 0) out += markup(", {:.2f} times the mean of the run", watts / mean);
    out += markup(
        ". There {} takes {} of it. Stretches that begin every {} cycles were compared; one that begins between them "
        "takes at "
        "most {:.4g} W.</p>\n",
        words(text_at(*peak, "part")), percent(number_at(*peak, "part_share")), value_text((*peak)["resolution"]),
        number_at(*peak, "watts_at_most"));
  }
  out += over_time(report);
  out += parts_of(report, schema, "energy", "joules", "Energy by part");
  out += parts_of(report, schema, "area", "mm2", "Area by part");
  if (const Json* trials = find(report, "area.search.trials"))
    out += table_of("area-search", "Splits of the area's budget that were simulated", *trials,
                    schema_at(schema, "properties.area.properties.search.properties.trials.items"))
               .html();
  if (const Json* costs = find(report, "costs"))
    out += table_of("costs-table", "Every number of energy and area, with its source", *costs,
                    schema_at(schema, "properties.costs.items"))
               .html();
  return out;
}

}  // namespace carousel::report::html
