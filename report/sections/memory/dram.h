#pragma once

#include <cstdint>
#include <vector>

#include "core/statistics/dram_counts.h"
#include "report/sections/memory/read_latency.h"

namespace carousel::report {

struct DramChannel {
  DramCounts counts;
  std::uint64_t bytes = 0;
  double utilisation = 0;
  ReadLatency latency{.unit = "DRAM cycles"};
};

template <class V>
void describe(V& v, const DramChannel& r) {
  describe(v, r.counts);
  v.field("bytes", r.bytes, "bytes", "bytes moved");
  v.field("utilisation", r.utilisation, "fraction", "fraction of the time in which its data wires were busy");
  v.section("latency", r.latency, "latency of reads, from the taking of a place in the queue to the end of their data");
}

/// DRAM with banks (memory.dram.preset).
struct Dram {
  std::uint64_t cycles = 0, period_ps = 0;
  double peak_bytes_per_second = 0, row_hit_fraction = 0, refresh_fraction = 0;
  std::vector<DramChannel> channels;
};

template <class V>
void describe(V& v, const Dram& r) {
  v.field("cycles", r.cycles, "DRAM cycles", "length of the run");
  v.field("period_ps", r.period_ps, "ps", "period of the DRAM's clock");
  v.field("peak_bytes_per_second", r.peak_bytes_per_second, "bytes/s", "bandwidth of all channels");
  v.field("row_hit_fraction", r.row_hit_fraction, "fraction", "row hits over all transactions");
  v.field("refresh_fraction", r.refresh_fraction, "fraction", "fraction of the time in which banks were refreshed");
  v.section("channels", r.channels, "each channel");
}

}  // namespace carousel::report
