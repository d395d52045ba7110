#include "report/run/part_table.h"

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/ratio.h"

namespace carousel::report {

std::string part_table(const PartCounts<Parts>& parts) {
  std::string out;
  Parts::for_each([&]<class P>(std::size_t) {
    using Counts = typename P::Counts;
    if (!parts.of<P>()) return;
    std::string counts;
    for (const Counter<Counts>& row : kCounters<Counts>)
      counts += fmt::format("{}{} {}", counts.empty() ? "" : "   ", row.name, grouped(row.value(*parts.of<P>())));
    out += fmt::format("{:<13}{}\n", P::kName, counts);
  });
  return out;
}

std::string warp_table(const std::vector<Resource>& resources) {
  WarpCounts sum;
  std::uint64_t lanes = 0;  // of all steps
  for (const Resource& r : resources) {
    if (!r.units || !r.units->warps) continue;
    sum += r.units->warps->counts;
    lanes += r.units->warps->lanes * r.units->warps->counts.steps;
  }
  if (sum.warps == 0) return "";
  return fmt::format(
      "{:<13}{} of lanes with a ray   {} with a test   {} of lines read   {:.2f} bytes of stack spilled a ray\n",
      "warps", percent(ratio(sum.ray_cycles, sum.lane_cycles)), percent(ratio(sum.tested, lanes)),
      percent(ratio(sum.lines_read, sum.lines_wanted)), ratio(sum.spilled_bytes, sum.rays));
}

}  // namespace carousel::report
