#include "ringbus/verdict/cycle_noise.h"

#include <cmath>
#include <numeric>

#include "core/numeric/student.h"

namespace carousel::ringbus {

std::optional<CycleNoise> cycle_noise(const std::vector<double>& cycles, bool whole) {
  if (cycles.size() < 3) return std::nullopt;
  const double n = static_cast<double>(cycles.size()), mean = std::accumulate(cycles.begin(), cycles.end(), 0.0) / n;
  double squares = 0;
  for (const double one : cycles) squares += (one - mean) * (one - mean);
  const double t = student_95(n - 1);
  return CycleNoise{t * std::sqrt(2 * squares / (n - 1)) / mean, cycles.size() - 1, whole};
}

}  // namespace carousel::ringbus
