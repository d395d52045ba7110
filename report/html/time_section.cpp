#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"

namespace carousel::report::html {

namespace {

/// Rows of the whole machine with the same unit share a chart. Joules have theirs beside the energy of the run.
std::map<std::string, std::vector<std::string>> charts_of(const Json& rows) {
  std::map<std::string, std::vector<std::string>> out;
  for (const Json& row : rows)
    if (text_at(row, "part") == "machine" && text_at(row, "unit") != "J")
      out[text_at(row, "unit")].push_back(text_at(row, "quantity"));
  return out;
}

}  // namespace

Html time_section(const Json& report) {
  const Json* series = find(report, "time_series");
  const Json* rows = find(report, "time_series.rows");
  if (!rows || rows->empty()) return {};
  const std::string unit = text_at(*series, "unit");
  const Json& interval = (*series)["interval"];
  Html out = markup("<p>{} samples of {} {} each.</p>\n", value_text((*series)["samples"]), value_text(interval), unit);
  int number = 0;
  for (const auto& [of, quantities] : charts_of(*rows))
    out += Figure{.id = fmt::format("fig-time-{}", number++),
                  .kind = "series",
                  .tables = of,
                  .title = fmt::format("The whole machine over time: {}", of),
                  .label = fmt::format("Curves over time: {}. The table below has least, mean and greatest of each.",
                                       fmt::join(quantities, ", ")),
                  .height = 340}
               .html();
  out += Figure{.id = "fig-time-parts",
                .kind = "parts_over_time",
                .tables = "",
                .title = "Every part over time",
                .label = "Heat map of a quantity by part and time; the table below has least, mean and greatest.",
                .height = 420}
             .html();
  Table table{"series-table",
              "Rows over time",
              {{"part"}, {"quantity"}, {"unit"}, {"least"}, {"mean"}, {"greatest"}, {"greatest at", unit}}};
  for (const Json& row : *rows) {
    double least = 0, most = 0, sum = 0;
    std::size_t at = 0, i = 0;
    for (const Json& value : row["values"]) {
      const double v = value.get<double>();
      if (i == 0 || v < least) least = v;
      if (i == 0 || v > most) most = v, at = i;
      sum += v;
      ++i;
    }
    if (i == 0) continue;
    table.rows.push_back({cell(text_at(row, "part")), cell(text_at(row, "quantity")), cell(text_at(row, "unit")),
                          cell(Json(least)), cell(Json(sum / static_cast<double>(i))), cell(Json(most)),
                          cell(Json(static_cast<double>(at) * interval.get<double>()))});
  }
  return out + table.html();
}

}  // namespace carousel::report::html
