#include "ringbus/verdict/pilot_likeness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace carousel::ringbus {

std::string unlikeness(const Foretelling& foretold, const cycle::CycleResult& run) {
  constexpr double kTolerance = 0.02, kBusyTolerance = 0.05;
  const Estimate cycles = foretold.cycles();
  const double ran = static_cast<double>(run.cycles), uncertainty = (cycles.high - cycles.value) / cycles.value;
  if (std::abs(ran / cycles.value - 1) > uncertainty + kTolerance)
    return fmt::format("it foretells {:.0f} cycles for the frame, {:+.1f} % of the run's", cycles.value,
                       100 * (cycles.value / ran - 1));
  const std::vector<double> busy = foretold.busy();
  for (std::size_t i = 0; i < busy.size(); ++i) {
    const cycle::ClassUse& use = run.uses[i];
    if (use.parts <= 0) continue;
    const double here = busy[i] / use.parts / cycles.value, there = static_cast<double>(use.busy) / use.parts / ran;
    if (std::abs(here - there) > std::max(here, there) * uncertainty + kBusyTolerance)
      return fmt::format("its {} is {:.0f} % busy, and the run's {:.0f} %", use.name, 100 * here, 100 * there);
  }
  return "";
}

}  // namespace carousel::ringbus
