#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/packed_series.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

namespace {

constexpr std::size_t kMostPixels = 1u << 18;  // some 10 bytes each in the page
constexpr std::array kQuantities{"rays", "cycles", "tests", "hops", "waiting"};

using Numbers = std::vector<std::vector<double>>;  // by quantity, in the order of the pixels

/// The numbers of heat.csv; none if a row is not as expected.
Numbers numbers_of(std::string_view csv, std::size_t pixels) {
  constexpr std::size_t kPlace = 2;  // x and y stand before them
  Numbers out(kQuantities.size());
  std::size_t at = std::min(csv.find('\n'), csv.size() - 1) + 1;
  while (at < csv.size()) {
    for (std::size_t c = 0; c < kPlace + kQuantities.size(); ++c) {
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(csv.data() + at, csv.data() + csv.size(), value);
      const auto next = static_cast<std::size_t>(end - csv.data());
      if (error != std::errc{} || next == csv.size() || csv[next] != (c + 1 < kPlace + kQuantities.size() ? ',' : '\n'))
        return {};
      if (c >= kPlace) out[c - kPlace].push_back(static_cast<double>(value));
      at = next + 1;
    }
  }
  return out.front().size() == pixels ? out : Numbers{};
}

int side_of(const Json& report, const char* key) {
  return static_cast<int>(std::clamp(number_at(report, std::string("config.image.") + key), 0.0, 1e6));
}

/// Returns the page's numbers; none if there are none, or if there are more than a page should hold.
Numbers shown_numbers(const Json& report, const HeatMap& map) {
  const std::size_t pixels =
      static_cast<std::size_t>(side_of(report, "width")) * static_cast<std::size_t>(side_of(report, "height"));
  return map.rows.empty() || pixels == 0 || pixels > kMostPixels ? Numbers{} : numbers_of(map.rows, pixels);
}

}  // namespace

Html packed_heat(const Json& report, const HeatMap& map) {
  const Numbers numbers = shown_numbers(report, map);
  if (numbers.empty()) return {};
  Json head{{"width", side_of(report, "width")}, {"samples", numbers.front().size()}, {"rows", Json::array()}};
  for (std::size_t i = 0; i < kQuantities.size(); ++i)
    head["rows"].push_back({{"quantity", kQuantities[i]}, {"values", numbers[i]}});
  return packed_series(head, "heat");
}

Html heat_section(const Json& report, const Json& schema, const HeatMap& map) {
  const Json* heat = find(report, "heat");
  if (!heat || (*heat)["slowest"].empty()) return {};
  const std::string most = value_text((*heat)["slowest"].front().value("cycles", Json(0)));
  Html out = markup("<p>The rays of a pixel take {} cycles in the mean, and those of the slowest one {}.</p>\n",
                    grouped(static_cast<std::uint64_t>(number_at(*heat, "cycles_mean") + 0.5)), most);
  const bool lively = !shown_numbers(report, map).empty();
  if (!map.picture.mime_type.empty())
    out += markup(
        "<div class=\"map{}\"><img src=\"data:{};base64,{}\" width=\"{}\" height=\"{}\" alt=\"Map of the cycles that "
        "the "
        "rays of each pixel took: dark few, bright many\">\n<p>Rays of dark pixels took few cycles, those of the "
        "brightest one {}.</p></div>\n",
        lively ? " still" : "", map.picture.mime_type, base64(map.picture.bytes), side_of(report, "width"),
        side_of(report, "height"), most);
  if (lively)
    out += markup("<div id=\"heat-map\"></div>\n");
  else if (map.picture.mime_type.empty())
    out += markup(
        "<p><code>carousel run --heat log</code> draws the cycles, tests, hops and waiting of each pixel.</p>\n");
  out += markup(
      "<p><code>carousel follow config.resolved.yaml --pixel X,Y</code> tells the life of a pixel's ray: its waits, "
      "packets and tests.</p>\n");
  return out + table_of("slow-pixels", "Slowest pixels", (*heat)["slowest"],
                        schema_at(schema, "properties.heat.properties.slowest.items"))
                   .html();
}

}  // namespace carousel::report::html
