#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/fields/engine.h"
#include "core/config/fields/topology.h"

namespace carousel::config {

/// The clocks that a configuration names.
struct ClockTable {
  const ClocksConfig& clocks;
  std::int64_t core_mhz = 1000;  ///< engine.clock_mhz

  /// The clock of that name in MHz; absent if there is none. `core` and `noc` are there in any case.
  std::optional<std::int64_t> of(std::string_view name) const;
  /// The names of all clocks.
  std::vector<std::string> names() const;
};

/// Fills in the clocks of the machine, and of a graph's nodes and links: those that they name; otherwise noc at links
/// and routers and, with synthetic traffic, at all nodes, of which the others go by core with rays. A name that is no
/// clock is left out; check_rings() says so.
void name_clocks(TopologyConfig& topology, const ClockTable& clocks, bool traffic);

/// A clock by which nodes or links go, by the name that the configuration has for it.
struct UsedClock {
  std::string name;
  std::int64_t mhz = 0;
};
/// The clocks by which parts of the machine go, core first. Clocks of one frequency are one clock, which has the first
/// of their names.
std::vector<UsedClock> used_clocks(const TopologyConfig& topology, std::int64_t core_mhz);

}  // namespace carousel::config
