#pragma once

#include <optional>
#include <stop_token>

#include "core/config/fields/memory.h"
#include "core/numeric/latency_histogram.h"
#include "ringbus/results/dram_use.h"
#include "ringbus/results/memory_request.h"

namespace carousel::ringbus {

/// The work of the memory alone on a list of requests. Times are cycles of the engine.
struct MemoryTraceResult {
  bool complete = true;
  std::uint64_t requests = 0, reads = 0, writes = 0, bytes = 0;
  std::uint64_t cycles = 0;      ///< to the end of the last data
  std::uint64_t last_taken = 0;  ///< the cycle in which the last request went in; with banks: took a place
  LatencyHistogram latency;      ///< latency of reads, from their cycle to the end of their data
  std::optional<DramUse> dram;   ///< with banks
  double wall_seconds = 0;
};

/// Plays requests, in the order of their cycles, to the memory of the configuration, without caches. A read of a pipe
/// takes `memory.dram_latency_cycles` besides the time of its bytes; with banks the way there and back is left out. A
/// request waits until the memory has room for it; it holds up those behind it only as the memory does.
MemoryTraceResult run_memory_trace(const MemoryConfig& config, std::int64_t clock_mhz, const MemoryLog& requests,
                                   std::stop_token stop = {});

}  // namespace carousel::ringbus
