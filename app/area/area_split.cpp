#include "app/area/area_split.h"

#include <algorithm>
#include <cstdlib>

#include "app/area/machine_area.h"
#include "core/config/load/validate.h"

namespace carousel::app {

namespace {

/// A power of two of a size, rounded up, of at least one.
std::int64_t scaled(std::int64_t size, int step) {
  if (step >= 0) return size << step;
  const std::int64_t by = std::int64_t{1} << -step;
  return std::max<std::int64_t>(1, (size + by - 1) / by);
}
/// The step before this one, from the configuration on.
int nearer(int step) {
  return step > 0 ? step - 1 : step < 0 ? step + 1 : 0;
}

/// False if a part is out of its range, or no part differs from a step nearer.
class Scaling {
 public:
  explicit Scaling(int step) : step_(step), differs_(step == 0) {}

  void apply(std::int64_t& size, std::int64_t most) {
    const std::int64_t before = scaled(size, nearer(step_));
    size = scaled(size, step_);
    differs_ |= size != before;
    fits_ &= size <= most;
  }
  bool fine() const { return fits_ && differs_; }

 private:
  int step_;
  bool differs_, fits_ = true;
};

bool scale_testers(Config& c, const SceneFacts& scene, int step) {
  constexpr std::int64_t kMostUnits = 1024;
  Scaling scaling(step);
  for (const auto [kind, units] : c.testers.units)
    if (has_units(c, scene, kind)) scaling.apply(units.units, kMostUnits);
  return scaling.fine();
}

bool scale_caches(MemoryConfig& memory, int step) {
  constexpr std::int64_t kMostKib = 1 << 20;
  Scaling scaling(step);
  scaling.apply(memory.l2_kib, kMostKib);
  return scaling.fine();
}

bool scale_ports(MemoryConfig& memory, int step) {
  constexpr std::int64_t kMostLines = 64;
  Scaling scaling(step);
  scaling.apply(memory.l2_lines_per_cycle, kMostLines);
  return scaling.fine();
}

/// Also those of a configuration that leaves their number to the program.
bool scale_workers(Config& c, int step) {
  constexpr std::int64_t kMostWorkers = 256;
  std::int64_t workers = shader_workers(c);
  Scaling scaling(step);
  scaling.apply(workers, kMostWorkers);
  c.shading.workers = workers;
  return scaling.fine();
}

}  // namespace

std::optional<Config> machine_of(const LocatedConfig& given, const SceneFacts& scene, const AreaSplit& split) {
  Config scaled = given.config;
  scaled.area.fit = AreaConfig::Fit::kRefuse;
  scaled.area.aim = AreaConfig{}.aim;
  for (const int step : split.steps)
    if (std::abs(step) > AreaSplit::kMostSteps) return std::nullopt;
  if (!scale_testers(scaled, scene, split.steps[AreaSplit::kTesters]) ||
      !scale_caches(scaled.memory, split.steps[AreaSplit::kCaches]) ||
      !scale_ports(scaled.memory, split.steps[AreaSplit::kPorts]) ||
      !scale_workers(scaled, split.steps[AreaSplit::kShaders]))
    return std::nullopt;
  return largest_machine({scaled, given.positions, {}}, scene, true);
}

}  // namespace carousel::app
