#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"

namespace carousel::report::html {

namespace {

/// The parts of energy or area as one bar, and a table of them.
Html parts_of(const Json& report, const Json& schema, const std::string& section, const char* value,
              const char* title) {
  const double all = number_at(report, section + "." + value);
  const Json* parts = find(report, section + ".parts");
  if (!parts || all <= 0) return {};
  Table shares{section + "-shares", std::string("Shares: ") + title, {{"of"}}},
      table{section + "-parts", title, {{"part"}}};
  const Json& meanings = schema_at(schema, "properties." + section + ".properties.parts");
  bool named = false;
  shares.rows.push_back({cell("the machine")});
  for (const auto& [key, part] : parts->items()) {
    if (number_at(part, value) <= 0) continue;
    shares.columns.push_back({words(key), "", "share"});
    shares.rows.front().push_back(share(number_at(part, value) / all));
    auto& row = table.rows.emplace_back();
    row.push_back(cell(words(key)));
    for (const auto& [name, number] : part.items()) {
      if (!named) table.columns.push_back({words(name)});
      row.push_back(cell(number));
    }
    named = true;
    row.push_back(share(number_at(part, value) / all));
    row.push_back(cell(text_at(schema_at(meanings, "properties." + key), "description")));
  }
  table.columns.push_back({"share"});
  table.columns.push_back({"meaning"});
  return Figure{.id = "fig-" + section,
                .kind = "stacked",
                .tables = shares.id,
                .title = title,
                .label = fmt::format("A stacked bar: the shares of the parts, which add up to 100 percent of the {}.",
                                     section),
                .height = 180}
             .html() +
         shares.html() + table.html();
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
  out += parts_of(report, schema, "energy", "joules", "Energy by part");
  out += parts_of(report, schema, "area", "mm2", "Area by part");
  if (const Json* costs = find(report, "costs"))
    out += table_of("costs-table", "Every number of energy and area, with its source", *costs,
                    schema_at(schema, "properties.costs.items"))
               .html();
  return out;
}

}  // namespace carousel::report::html
