#include "report/rays/ray_time_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/table_lines.h"

namespace carousel::report {

std::string ray_time_table(const RayTime& time) {
  const RayStageCounts stages = time.stages();
  const std::uint64_t cycles = cycles_of(stages);
  Items items;
  items.add(fmt::format("{:.1f}", ratio(cycles, time.rays())), "cycles a ray");
  for (const Counter<RayStageCounts>& row : kCounters<RayStageCounts>)
    if (const double part = ratio(row.value(stages), cycles); part >= 0.01) items.add(row.name, percent(part));
  Table table;
  items.lines(table, "ray time");
  return table.take();
}

std::string heat_table(const Heat& heat) {
  constexpr std::size_t kShown = 3;
  if (heat.slowest.empty()) return "";
  Items items;
  for (std::size_t i = 0; i < std::min(kShown, heat.slowest.size()); ++i) {
    const PixelHeat& pixel = heat.slowest[i];
    items.add(fmt::format("{},{}:", pixel.x, pixel.y),
              fmt::format("{} cycles of {} rays", grouped(pixel.cycles), pixel.rays));
  }
  items.add(grouped(static_cast<std::uint64_t>(heat.cycles_mean + 0.5)), "a pixel");
  Table table;
  items.lines(table, "slow pixels");
  return table.take();
}

}  // namespace carousel::report
