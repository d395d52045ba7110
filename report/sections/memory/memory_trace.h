#pragma once

#include <cstdint>

#include "report/sections/memory/dram.h"

namespace carousel::report {

struct RequestLatency {
  Latency of;
};

template <class V>
void describe(V& v, const RequestLatency& r) {
  v.field("mean", r.of.mean, "cycles", "mean latency");
  v.field("p50", r.of.p50, "cycles", "median latency");
  v.field("p95", r.of.p95, "cycles", "latency that 19 of 20 reads did not exceed");
  v.field("p99", r.of.p99, "cycles", "latency that 99 of 100 reads did not exceed");
  v.field("max", r.of.max, "cycles", "greatest latency");
}

/// The memory alone (workload: {memory_trace: FILE}).
struct MemoryTrace {
  std::uint64_t requests = 0, reads = 0, writes = 0, bytes = 0, last_taken_cycle = 0;
  double bytes_per_cycle = 0, gigabytes_per_second = 0;
  RequestLatency latency;
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
