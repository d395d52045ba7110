#pragma once

#include <cstddef>
#include <cstdint>

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

}  // namespace carousel::ringbus::cycle
