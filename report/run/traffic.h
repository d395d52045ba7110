#pragma once

#include <cstdint>

namespace carousel::report {

struct Latency {
  double mean = 0;
  std::uint64_t p50 = 0, p95 = 0, p99 = 0, max = 0;
};

struct LinkUse {
  double mean = 0, max = 0;
};

/// A run of synthetic traffic (workload: {traffic: ...}).
struct Traffic {
  std::uint64_t packets = 0, delivered = 0, flits_per_packet = 0;
  std::uint64_t window_begin = 0, window_end = 0;
  std::uint64_t measured = 0;
  double offered = 0, accepted = 0;
  double routers_mean = 0, zero_load_latency = 0;
  Latency latency;
  LinkUse link_utilisation;
  std::uint64_t flit_hops = 0;
};

}  // namespace carousel::report
