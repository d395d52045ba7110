#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/packed_series.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

Html heat_section(const Json& report, const Json& schema, const Picture& map) {
  const Json* heat = find(report, "heat");
  if (!heat || (*heat)["slowest"].empty()) return {};
  Html out;
  if (!map.mime_type.empty()) {
    const auto side = [&](const char* key) {
      return static_cast<int>(std::clamp(number_at(report, std::string("config.image.") + key), 0.0, 1e6));
    };
    out += markup(
        "<img src=\"data:{};base64,{}\" width=\"{}\" height=\"{}\" alt=\"Map of the cycles that the rays of each pixel "
        "took: dark few, bright many\">\n",
        map.mime_type, base64(map.bytes), side("width"), side("height"));
  }
  out += markup(
      "<p>The rays of a pixel take {} cycles in the mean. <code>carousel run --heat log</code> draws the pixels' "
      "cycles, tests, hops and waiting; <code>carousel follow CONFIG --pixel X,Y</code> tells the life of a ray.</p>\n",
      grouped(static_cast<std::uint64_t>(number_at(*heat, "cycles_mean") + 0.5)));
  return out + table_of("slow-pixels", "Slowest pixels", (*heat)["slowest"],
                        schema_at(schema, "properties.heat.properties.slowest.items"))
                   .html();
}

}  // namespace carousel::report::html
