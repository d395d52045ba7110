#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// Latencies of packets.
struct Latency {
  double mean = 0;
  std::uint64_t p50 = 0, p95 = 0, p99 = 0, max = 0;
};

template <class V>
void describe(V& v, const Latency& r) {
  v.field("mean", r.mean, "cycles", "mean latency");
  v.field("p50", r.p50, "cycles", "median latency");
  v.field("p95", r.p95, "cycles", "latency that 19 of 20 packets did not exceed");
  v.field("p99", r.p99, "cycles", "latency that 99 of 100 packets did not exceed");
  v.field("max", r.max, "cycles", "greatest latency");
}

}  // namespace carousel::report
