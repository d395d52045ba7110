#include "report/accuracy/level_text.h"

#include <fmt/format.h>

#include "report/text/number_text.h"

namespace carousel::report {

std::string levels_text(const AccuracyRow& row) {
  return fmt::format("{} + {} + {}", row.triangle, row.box, row.transform);
}

std::string cost_text(const AccuracyRow& row, Clock clock) {
  const double cost = row.cost(clock)->median;
  return clock == Clock::kHost ? fmt::format("{:.0f} ns a ray", cost) : fmt::format("{:.3g} cycles a ray", cost);
}

std::string over_text(const CostRatio& over) {
  return fmt::format("{:+.0f} %", 100 * (over.ratio - 1));
}
std::string interval_text(const CostRatio& over) {
  if (over.low == over.high) return "";
  return fmt::format(" ({:+.1f} to {:+.1f} %)", 100 * (over.low - 1), 100 * (over.high - 1));
}

std::string errors_text(const AccuracyRow& row) {
  return fmt::format("leaks {}, answers {} of {} rays of the scene and {} of the hard cases wrongly",
                     grouped(row.leaks), grouped(row.scene.wrong()), grouped(row.scene.rays),
                     grouped(row.wrong() - row.scene.wrong()));
}

}  // namespace carousel::report
