#pragma once

#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "core/config/fields/topology.h"
#include "core/config/fields/workload.h"
#include "core/numeric/latency_histogram.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/stop_ring_use.h"

namespace carousel::ringbus {

/// The counts of a run of synthetic traffic. Latencies, offered and accepted load are of the window.
struct TrafficResult {
  bool complete = true;  ///< false: stopped early
  Cycle cycles = 0;      ///< until the last packet was delivered
  Cycle window_begin = 0, window_end = 0;
  std::uint64_t packets = 0, delivered = 0;  ///< in all
  std::uint64_t flits = 1;                   ///< flits of a packet
  std::uint64_t offered = 0;                 ///< packets created within the window
  std::uint64_t accepted = 0;                ///< packets delivered within the window
  std::uint64_t accepted_flit_hops = 0;      ///< links that their flits crossed
  std::uint64_t routers = 0;                 ///< visited by the packets offered, first and last included
  std::uint64_t travel = 0;                  ///< cycles that these would be on their way if each were alone
  std::uint64_t flit_hops = 0;               ///< links crossed by flits, in the whole run
  LatencyHistogram latency;                  ///< latency of the packets offered
  std::vector<cycle::LinkUse> links;
  std::vector<std::uint64_t> link_packets;  ///< by link
  std::vector<std::uint64_t> link_depths;   ///< by link: packets; between stops, flits for the cycles of its latency
  std::vector<Cycle> busy_in_window;        ///< by link: cycles of the window in which it moved a flit, by its clock
  std::vector<Cycle> link_cycles, link_windows;  ///< by link: the run and the window by its clock
  std::optional<StopRingUse> stops;              ///< of all rings with stops
  double wall_seconds = 0;
  std::size_t threads = 1;

  /// Part of what all links could move within the window that packets delivered in it needed.
  double accepted_of_links() const {
    const double most = std::accumulate(link_windows.begin(), link_windows.end(), 0.0);
    return most == 0 ? 0 : static_cast<double>(accepted_flit_hops) / most;
  }
  double routers_mean() const { return offered == 0 ? 0 : static_cast<double>(routers) / static_cast<double>(offered); }
  /// Mean latency of the packets offered if each were alone: see ringbus/cycle/traffic/traffic_node.h.
  double zero_load_latency(const TrafficConfig& t) const {
    if (offered == 0) return 0;
    return static_cast<double>(t.inject_cycles + t.eject_cycles) +
           static_cast<double>(travel) / static_cast<double>(offered);
  }
};

}  // namespace carousel::ringbus
