#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

Html sampled_section(const Json& report, const Json& schema) {
  const Json* sampled = find(report, "sampled");
  if (!sampled) return {};
  const bool audited = sampled->at("cycles_per_ray").contains("whole");
  Table table{"sampled", "Estimates for the whole frame", {{"value"}, {"unit"}, {"estimate"}, {"from"}, {"to"}}};
  if (audited) table.columns.insert(table.columns.end(), {{"whole frame"}, {"error", "fraction"}});
  const auto add = [&](const std::string& name, const Json& value, const std::string& unit) {
    std::vector<Cell> row{cell(name), cell(unit)};
    for (const char* key : {"estimate", "low", "high"}) row.push_back(value_cell(value[key], unit));
    if (audited) row.push_back(value.contains("whole") ? value_cell(value["whole"], unit) : cell(""));
    if (audited) row.push_back(value.contains("error") ? value_cell(value["error"], "fraction") : cell(""));
    table.rows.push_back(std::move(row));
  };
  for (const auto& [key, value] : sampled->items())
    if (value.is_object() && value.contains("estimate"))
      add(words(key), value,
          text_at(schema_at(schema, "properties.sampled.properties." + key + ".properties.estimate"), "unit"));
  for (const Json& use : (*sampled)["uses"]) add("use of " + words(text_at(use, "name")), use, "fraction");
  Html out = markup(
      "<p class=\"notice\"><strong>Sampled:</strong> {} of {} paths were simulated, in {} places drawn over the frame. "
      "The picture holds only these; all other sections are about them alone.</p>\n",
      value_text((*sampled)["paths"]), value_text((*sampled)["frame_paths"]), value_text((*sampled)["strata"]));
  if (sampled->value("too_small", false))
    out += markup(
        "<p class=\"notice\">The sample is too small for this machine: it is mostly fill and drain, and the intervals "
        "are "
        "wide.</p>\n");
  return out + table.html();
}

}  // namespace carousel::report::html
