#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "ringbus/cycle/fabric/ports.h"

namespace carousel::ringbus::cycle {

/// The counters of a link in the time series: one after another for each port of the node that it leaves.
enum class PortCounter : std::uint8_t { kBusy, kBytes, kEnd };
constexpr std::size_t counter_index(PortCounter counter, std::size_t port, std::size_t first) {
  return first + port * static_cast<std::size_t>(PortCounter::kEnd) + static_cast<std::size_t>(counter);
}

/// Fills in the counters of the links that leave a node, from `first` on.
inline void read_ports(std::span<const OutPort> ports, Cycle at, std::size_t first, std::span<std::uint64_t> row) {
  for (std::size_t i = 0; i < ports.size(); ++i) {
    row[counter_index(PortCounter::kBusy, i, first)] = ports[i].busy(at);
    row[counter_index(PortCounter::kBytes, i, first)] = ports[i].bytes();
  }
}

}  // namespace carousel::ringbus::cycle
