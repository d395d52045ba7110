#include "report/run/verdict_table.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/table_lines.h"

namespace carousel::report {

std::string verdict_table(const Bottleneck& found) {
  // Facts of the verdict stand between semicolons: a line each, and long lists break at their items.
  Table facts;
  for (std::size_t begin = 0; begin <= found.verdict.size();) {
    const std::size_t end = std::min(found.verdict.find("; ", begin), found.verdict.size());
    wrapped_lines(facts, begin == 0 ? "bottleneck" : "", found.verdict.substr(begin, end - begin), ", ");
    begin = end + 2;
  }
  std::string out = facts.take();
  const auto named = std::find_if(found.gains.begin(), found.gains.end(),
                                  [&](const BottleneckGain& gain) { return gain.name == found.limits; });
  if (named != found.gains.end() && named->frame > 0)
    out += fmt::format("{:<13}by {} of the frame, from its start\n", "", percent(named->frame));
  else if (found.rays > 0 && !found.whole_frame)
    out += fmt::format("{:<13}by {} of the frame's rays, which foretell its cycles to {:+.1f} %\n", "",
                       grouped(found.rays), 100 * found.deviation);
  if (found.phases.size() < 2) return out;
  for (const BottleneckPhase& phase : found.phases)
    out += fmt::format(
        "{:<13}{} to {} of the rays, {} of the time: {}\n", &phase == found.phases.data() ? "phases" : "",
        percent(phase.begin), percent(phase.end), percent(phase.time),
        phase.limits.empty() ? "no class alone"
                             : fmt::format("{}, {} gains {}", phase.limits, phase.action, percent(phase.gain)));
  return out;
}

std::string noise_table(const CycleNoise& noise) {
  return fmt::format(
      "{:<13}{} to {} cycles with another seed of the picture, {} more or less, by {} seeds of {} paths\n", "noise",
      grouped(noise.low), grouped(noise.high), percent(noise.fraction), noise.seeds, grouped(noise.paths));
}

std::string charges_table(const std::vector<Charge>& charges) {
  std::string names;
  for (const Charge& charge : charges) names += (names.empty() ? "" : ", ") + charge.name;
  Table table;
  wrapped_lines(table, "not charged", names, ", ");
  return table.take();
}

std::string spared_table(const EffectsSpared& spared) {
  std::string out =
      fmt::format("{:<13}spared {} of the cycles: all effects would cost {} cycles ({} to {})\n", "effects",
                  percent(spared.fraction), grouped(spared.cycles_with_all), grouped(spared.low), grouped(spared.high));
  if (spared.measured)
    out += fmt::format("{:<13}measured {} cycles, foretold to {:+.1f} %\n", "", grouped(*spared.measured),
                       100 * spared.error.value_or(0));
  return out;
}

}  // namespace carousel::report
