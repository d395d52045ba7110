#include "ringbus/verdict/pilot_likeness.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace carousel::ringbus {

double Likeness::off() const {
  double most = std::abs(deviation);
  for (const UnlikePart& part : parts) most = std::max(most, std::abs(part.foretold - part.ran));
  return most;
}

std::string Likeness::veto(const std::function<bool(std::string_view part)>& does_matter) const {
  constexpr double kLittle = 0.15;
  if (other_cycles)
    return fmt::format("it foretells {:.0f} cycles for the frame, {:+.1f} % of the run's", cycles,
                       100 * (1 / (1 + deviation) - 1));
  bool one = false;
  for (const auto& [name, foretold, ran] : parts) {
    if (!does_matter(name)) continue;
    if (one || std::abs(foretold - ran) > kLittle)
      return fmt::format("its {} is {:.0f} % busy, and the run's {:.0f} %", name, 100 * foretold, 100 * ran);
    one = true;
  }
  return "";
}

Likeness likeness(const Foretelling& foretold, const cycle::CycleResult& run) {
  constexpr double kTolerance = 0.02, kBusyTolerance = 0.05;
  const Estimate cycles = foretold.cycles();
  const double ran = static_cast<double>(run.cycles), uncertainty = (cycles.high - cycles.value) / cycles.value;
  Likeness out{cycles.value, ran / cycles.value - 1, uncertainty};
  out.other_cycles = std::abs(out.deviation) > uncertainty + kTolerance;
  const std::vector<double> busy = foretold.busy();
  for (std::size_t i = 0; i < busy.size(); ++i) {
    const cycle::ClassUse& use = run.uses[i];
    if (use.parts <= 0) continue;
    const double here = busy[i] / use.parts / cycles.value, there = static_cast<double>(use.busy) / use.parts / ran;
    if (std::abs(here - there) > std::max(here, there) * uncertainty + kBusyTolerance)
      out.parts.push_back({use.name, here, there});
  }
  return out;
}

}  // namespace carousel::ringbus
