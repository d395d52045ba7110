#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Use of a channel of DRAM with banks.
struct DramCounts {
  std::uint64_t reads = 0, writes = 0, row_hits = 0, row_misses = 0, row_conflicts = 0, refreshes = 0;
  std::uint64_t refresh_cycles = 0;

  static constexpr auto counters() {
    using C = DramCounts;
    return std::array{
        Counter{"reads", &C::reads, "transactions", "reads of 32 bytes"},
        Counter{"writes", &C::writes, "transactions", "writes of 32 bytes"},
        Counter{"row_hits", &C::row_hits, "transactions", "requests whose row was open"},
        Counter{"row_misses", &C::row_misses, "transactions", "requests whose bank had no open row"},
        Counter{"row_conflicts", &C::row_conflicts, "transactions", "requests whose bank had another row open"},
        Counter{"refreshes", &C::refreshes, "refreshes", "refreshes of all banks"},
        Counter{"refresh_cycles", &C::refresh_cycles, "DRAM cycles", "time in which the banks were refreshed"},
    };
  }
  friend bool operator==(const DramCounts&, const DramCounts&) = default;
};

}  // namespace carousel
