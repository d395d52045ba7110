#pragma once

#include <cstdint>

#include "report/sections/memory/dram.h"

namespace carousel::report {

/// The memory alone (workload: {memory_trace: FILE}).
struct MemoryTrace {
  std::uint64_t requests = 0, reads = 0, writes = 0, bytes = 0, last_taken_cycle = 0;
  double bytes_per_cycle = 0, gigabytes_per_second = 0;
  ReadLatency latency;
  std::optional<Dram> dram;
};

template <class V>
void describe(V& v, const MemoryTrace& r) {
  v.field("requests", r.requests, "requests", "requests of the file");
  v.field("reads", r.reads, "requests", "reads among them");
  v.field("writes", r.writes, "requests", "writes among them");
  v.field("bytes", r.bytes, "bytes", "bytes that they asked for");
  v.field("last_taken_cycle", r.last_taken_cycle, "cycle", "cycle in which the last request went in");
  v.field("bytes_per_cycle", r.bytes_per_cycle, "bytes/cycle", "bytes over the run's cycles");
  v.field("gigabytes_per_second", r.gigabytes_per_second, "GB/s", "the same at engine.clock_mhz");
  v.section("latency", r.latency, "latency of reads, from their cycle in the file to the end of their data");
  v.section("dram", r.dram, "DRAM with banks");
}

}  // namespace carousel::report
