#include "report/run/verdict_table.h"

#include <fmt/format.h>

#include "report/text/number_text.h"

namespace carousel::report {

std::string verdict_table(const Bottleneck& found) {
  std::string out = fmt::format("{:<13}{}\n", "bottleneck", found.verdict);
  if (found.rays > 0 && !found.whole_frame)
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

}  // namespace carousel::report
