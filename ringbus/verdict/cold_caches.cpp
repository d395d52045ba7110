#include "ringbus/verdict/cold_caches.h"

#include <algorithm>
#include <array>

#include "ringbus/verdict/steady_state.h"

namespace carousel::ringbus {

MemoryReads reads_between(const cycle::CycleResult& result, std::uint64_t slots) {
  const auto begin = std::find_if(result.progress.begin(), result.progress.end(),
                                  [&](const auto& sample) { return sample.completed >= fill_rays(slots); });
  if (!result.all_begun || begin == result.progress.end() || begin->at >= result.all_begun->at)
    return {result.memory.lines, result.first_reads};
  return {result.all_begun->reads - begin->reads, result.all_begun->first_reads - begin->first_reads};
}

bool gains_of_cold_caches(std::string_view part) {
  constexpr std::array<std::string_view, 7> kParts{"memory_bandwidth", "memory_latency", "dram_queue",      "l2_mshrs",
                                                   "l1_mshrs",         "prefetch",       "prefetch_streams"};
  return std::find(kParts.begin(), kParts.end(), part) != kParts.end();
}

}  // namespace carousel::ringbus
