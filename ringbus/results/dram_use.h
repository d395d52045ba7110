#pragma once

#include <cstdint>
#include <vector>

#include "core/numeric/latency_histogram.h"
#include "core/statistics/dram_counts.h"

namespace carousel::ringbus {

/// The use of a DRAM with banks over a run.
struct DramUse {
  struct Channel {
    DramCounts counts;
    LatencyHistogram latencies;  ///< read latency from the taking of a place to the end of the data, in DRAM cycles
    std::uint64_t bytes = 0;
    double utilisation = 0;  ///< part of the time in which its data wires are busy
    friend bool operator==(const Channel&, const Channel&) = default;
  };
  std::uint64_t cycles = 0, period_ps = 0;  ///< DRAM cycles
  double peak_bytes_per_second = 0;         ///< bandwidth of all channels
  std::vector<Channel> channels;
  friend bool operator==(const DramUse&, const DramUse&) = default;
};

}  // namespace carousel::ringbus
