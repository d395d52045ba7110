#pragma once

#include "report/sections/latency.h"

namespace carousel::report {

/// The latencies of reads. The quantiles are those of report::Latency, in other words.
struct ReadLatency {
  Latency of{};
  const char* unit = "cycles";
};

template <class V>
void describe(V& v, const ReadLatency& r) {
  v.field("mean", r.of.mean, r.unit, "mean latency");
  v.field("p50", r.of.p50, r.unit, "median latency");
  v.field("p95", r.of.p95, r.unit, "latency that 19 of 20 reads did not exceed");
  v.field("p99", r.of.p99, r.unit, "latency that 99 of 100 reads did not exceed");
  v.field("max", r.of.max, r.unit, "greatest latency");
}

}  // namespace carousel::report
