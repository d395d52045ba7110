#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/config/fields/shading.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The instruction cache of a shader worker (`shading.instruction_cache`): direct-mapped, in front of a store that
/// answers each miss after a constant time. A line that is under way is not asked for again.
class InstructionCache {
 public:
  explicit InstructionCache(const InstructionCacheConfig& config)
      : line_bytes_(static_cast<std::uint64_t>(config.line_bytes)),
        miss_(static_cast<Cycle>(config.miss_cycles)),
        lines_(static_cast<std::size_t>(config.bytes / config.line_bytes)) {}

  /// The cycle in which the instruction at `address` is there. Calls come in the order of time.
  Cycle fetch(std::uint64_t address, Cycle now) {
    if (lines_.empty()) return now;
    const std::uint64_t line = address / line_bytes_;
    Line& place = lines_[line % lines_.size()];
    if (place.number != line + 1) {
      place = {line + 1, now + miss_};
      ++misses_;
    }
    return std::max(now, place.there);
  }
  std::uint64_t misses() const { return misses_; }
  std::uint64_t bytes() const { return misses_ * line_bytes_; }

 private:
  struct Line {
    std::uint64_t number = 0;  // and one; 0: empty
    Cycle there = 0;
  };
  std::uint64_t line_bytes_;
  Cycle miss_;
  std::vector<Line> lines_;
  std::uint64_t misses_ = 0;
};

}  // namespace carousel::ringbus::cycle
