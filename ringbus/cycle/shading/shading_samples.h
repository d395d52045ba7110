#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ringbus/results/counter_samples.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The counters of ray control and shading in the time series: these, and then one a resource, its rays in slots times
/// cycles.
enum class ShadingCounter : std::uint8_t {
  kCompleted,  ///< rays
  kWaiting,    ///< completed rays that wait for a worker, times cycles
  kWorkers,    ///< workers that work, times cycles
  kEnd,
};
constexpr std::size_t counter_index(ShadingCounter counter) {
  return static_cast<std::size_t>(counter);
}
inline constexpr std::size_t kFirstHeldCounter = counter_index(ShadingCounter::kEnd);

/// Ray control and shading as they have been since the last step.
struct ShadingLevels {
  std::uint64_t completed;      ///< rays, since the start
  std::size_t waiting;          ///< rays that wait for a worker
  std::size_t working;          ///< workers
  std::span<const Level> held;  ///< by resource: slots in use
};

/// The counters of ray control and shading over time.
class ShadingSamples {
 public:
  /// `most` readings; 0: none.
  ShadingSamples(std::size_t most, std::size_t resources) : samples_(most, kFirstHeldCounter + resources) {}

  /// To be called at the beginning of every step.
  void take(Cycle now, const ShadingLevels& levels) {
    if (samples_.due(now)) [[unlikely]]
      samples_.until(now, [&](Cycle at, std::span<std::uint64_t> row) { read(at, levels, row); });
    waiting_.hold(now, levels.waiting);
    working_.hold(now, levels.working);
  }
  void close(Cycle end, const ShadingLevels& levels) {
    samples_.close(end, [&](Cycle at, std::span<std::uint64_t> row) { read(at, levels, row); });
  }
  /// After close().
  const CounterSamples& counters() const { return samples_; }

 private:
  void read(Cycle at, const ShadingLevels& levels, std::span<std::uint64_t> row) const {
    row[counter_index(ShadingCounter::kCompleted)] = levels.completed;
    row[counter_index(ShadingCounter::kWaiting)] = waiting_.at(at, levels.waiting);
    row[counter_index(ShadingCounter::kWorkers)] = working_.at(at, levels.working);
    for (std::size_t r = 0; r < levels.held.size(); ++r) row[kFirstHeldCounter + r] = levels.held[r].at(at);
  }

  CounterSamples samples_;
  LevelSum waiting_, working_;
};

}  // namespace carousel::ringbus::cycle
