#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus {

/// The reads of memory between fill and drain of a run.
struct MemoryReads {
  std::uint64_t reads = 0;  ///< of lines
  std::uint64_t first = 0;  ///< of lines that had not been read before
  double first_share() const { return reads > 0 ? static_cast<double>(first) / static_cast<double>(reads) : 0; }
};

/// Reads between the completion of fill_rays() (steady_state.h) and the time at which the last ray that no other ray
/// causes had begun; of the whole run if that is no time.
MemoryReads reads_between(const cycle::CycleResult& result, std::uint64_t slots);

/// A part of the reads that are first ones from which on the memory's gains are taken for those of cold caches. A line
/// is read for the first time once, and again as often as the frame is large: in four times the pixels, `gpu_stack`
/// reads 1.3 times as many lines for the first time, and a ray reads 2.7 times less
/// (docs/how-it-works/cycle-engine.md).
inline constexpr double kColdShare = 0.25;

/// A gain of the frame, and the lower end of its interval.
struct WarmGain {
  double gain = 0, low = 0;
};

/// True if a class of the way to memory would gain most in a larger frame as well, in which no line is read for the
/// first time. Twice as many parts save half of the time that it limits, t = 2 g / (1 + g) of the frame's. Without the
/// first reads, `first_share` of t is gone, and others save as much as before of what is left.
bool best_when_warm(const WarmGain& memory, double first_share, const std::vector<WarmGain>& others);

/// Classes of parts that gain more while caches are cold: those of the way to memory behind them.
bool gains_of_cold_caches(std::string_view part);

}  // namespace carousel::ringbus
