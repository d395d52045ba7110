#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/numeric/divisor.h"
#include "core/statistics/cache_counts.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// A line that a request looks up. The cache numbers its requests.
struct LineLookUp {
  std::uint64_t line = 0;
  std::uint32_t request = 0;
};

/// A bank of a cache. CacheBanks knows how many lines it looks up in a cycle and how many it may fetch at once.
struct CacheBank {
  std::uint64_t looked_up = 0;     ///< its ports are taken up to this line of time
  Cycle busy_until = 0;            ///< the first cycle after the last in which a line was looked up
  std::uint32_t on_their_way = 0;  ///< lines that come from memory
  std::deque<LineLookUp> waiting;  ///< the first has to be fetched, and cannot be yet
};

/// The banks of a cache, which hold the lines in turn. The ports of each look up so many lines a cycle, in the order of
/// requests, and its miss registers (`memory.l2_mshrs`) bound the lines that are on their way to it from memory.
class CacheBanks {
 public:
  /// Keeps a reference to `counts`, of which it counts the waits for ports and the cycles in which they are busy.
  CacheBanks(const MemoryConfig& config, CacheCounts& counts)
      : banks_(static_cast<std::size_t>(config.l2_banks)),
        parts_(static_cast<std::uint64_t>(config.line_bytes) / fetched_bytes(config)),
        port_lines_(static_cast<std::uint64_t>(config.l2_lines_per_cycle)),
        mshrs_(static_cast<std::uint64_t>(config.l2_mshrs)),
        counts_(counts) {}

  CacheBank& of(std::uint64_t line) { return banks_.size() == 1 ? banks_[0] : banks_[line / parts_ % banks_.size()]; }
  /// Takes a port of the bank for the next line. Returns the end of the cycle in which it is looked up.
  Cycle take_port(CacheBank& bank, Cycle now) {
    bank.looked_up = std::max(bank.looked_up, now * port_lines_.value()) + 1;
    const Cycle end = port_lines_.ceiling(bank.looked_up);
    counts_.port_waits += end > now + 1;
    counts_.port_busy += end > bank.busy_until;
    bank.busy_until = end;
    return end;
  }
  /// Returns whether a miss register of the bank is free.
  bool can_fetch(const CacheBank& bank) const { return mshrs_ == 0 || bank.on_their_way < mshrs_; }

 private:
  std::vector<CacheBank> banks_;
  std::uint64_t parts_;  // lines of the messages in a line of the cache
  Divisor port_lines_;   // a cycle
  std::uint64_t mshrs_;  // miss registers of a bank; 0: no bound
  CacheCounts& counts_;
};

}  // namespace carousel::ringbus::cycle
