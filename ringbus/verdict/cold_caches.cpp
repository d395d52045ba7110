#include "ringbus/verdict/cold_caches.h"

#include <algorithm>
#include <array>

#include "core/numeric/worth_naming.h"
#include "ringbus/verdict/steady_state.h"

namespace carousel::ringbus {

MemoryReads reads_between(const cycle::CycleResult& result, std::uint64_t slots) {
  const auto begin = std::find_if(result.progress.begin(), result.progress.end(),
                                  [&](const auto& sample) { return sample.completed >= fill_rays(slots); });
  if (!result.all_begun || begin == result.progress.end() || begin->at >= result.all_begun->at)
    return {result.memory.lines, result.first_reads};
  return {result.all_begun->reads - begin->reads, result.all_begun->first_reads - begin->first_reads};
}

bool best_when_warm(const WarmGain& memory, double first_share, const std::vector<WarmGain>& others) {
  const auto limits = [](double gain) { return 2 * gain / (1 + gain); };
  const double warm = 1 - first_share * std::min(1.0, limits(memory.gain));  // the time of the frame then
  const auto of_memory = [&](double gain) {
    const double saved = (1 - first_share) * std::min(1.0, limits(gain)) / 2;
    return saved / (warm - saved);
  };
  const double gain = of_memory(memory.gain);
  if (gain < kWorthIt || of_memory(memory.low) <= 0) return false;
  return std::all_of(others.begin(), others.end(), [&](const WarmGain& other) {
    const double saved = other.gain / (1 + other.gain);
    return saved < warm && saved / (warm - saved) <= gain;
  });
}

bool gains_of_cold_caches(std::string_view part) {
  constexpr std::array<std::string_view, 7> kParts{"memory_bandwidth", "memory_latency", "dram_queue",      "l2_mshrs",
                                                   "l1_mshrs",         "prefetch",       "prefetch_streams"};
  return std::find(kParts.begin(), kParts.end(), part) != kParts.end();
}

}  // namespace carousel::ringbus
