#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carousel::report {

struct StressLatency {
  double p50 = 0, p99 = 0, p99_9 = 0, max = 0;
};

/// A queue under a pattern, over all repetitions.
struct StressRow {
  std::string queue, pattern;
  std::uint64_t message_bytes = 0, capacity = 0, threads = 0, messages = 0;
  double rate_median = 0, rate_least = 0, rate_most = 0;
  std::optional<StressLatency> transit, round_trip;
  double fairness = 1;
  double push_refused = 0, pop_refused = 0, blocked = 0;
  std::uint64_t memory_bytes = 0;
  std::string found, detail;
};

/// A queue of a depth inside the ring of a configuration.
struct StressRingRow {
  std::string queue;
  std::uint64_t depth = 0;
  double rate_median = 0, rate_least = 0, rate_most = 0;
  double relative = 0;
  double refused = 0;
  double occupancy_mean = 0;
  bool same_digest = true;
};

/// `carousel stress`.
struct Stress {
  bool incomplete = false;
  std::uint64_t cores = 0, repetitions = 0;
  double seconds = 0;
  std::vector<StressRow> rows;
  std::vector<StressRingRow> ring;
  std::string ring_verdict;

  bool broken() const {
    for (const StressRow& row : rows)
      if (!row.found.empty()) return true;
    for (const StressRingRow& row : ring)
      if (!row.same_digest) return true;
    return false;
  }
};

}  // namespace carousel::report
