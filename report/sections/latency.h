#pragma once

#include <cstdint>
#include <vector>

#include "core/numeric/latency_histogram.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// A point of the distribution of latencies.
struct LatencyQuantile {
  double part = 0;
  std::uint64_t cycles = 0;
};

template <class V>
void describe(V& v, const LatencyQuantile& r) {
  v.field("part", r.part, "fraction", "part of all packets");
  v.field("cycles", r.cycles, "cycles", "latency that this part of the packets did not exceed");
}

/// Latencies of packets.
struct Latency {
  double mean = 0;
  std::uint64_t p50 = 0, p95 = 0, p99 = 0, max = 0;
  std::vector<LatencyQuantile> quantiles{};
};

/// The mean, quantiles and distribution of a histogram.
inline Latency latency_of(const LatencyHistogram& of) {
  Latency out{of.mean(), of.quantile(0.5), of.quantile(0.95), of.quantile(0.99), of.max()};
  for (const double part : {0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999})
    out.quantiles.push_back({part, of.quantile(part)});
  out.quantiles.push_back({1, of.max()});
  return out;
}

template <class V>
void describe(V& v, const Latency& r) {
  v.field("mean", r.mean, "cycles", "mean latency");
  v.field("p50", r.p50, "cycles", "median latency");
  v.field("p95", r.p95, "cycles", "latency that 19 of 20 packets did not exceed");
  v.field("p99", r.p99, "cycles", "latency that 99 of 100 packets did not exceed");
  v.field("max", r.max, "cycles", "greatest latency");
  v.section("quantiles", r.quantiles, "distribution of the latencies");
}

}  // namespace carousel::report
