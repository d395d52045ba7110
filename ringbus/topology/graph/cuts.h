#pragma once

#include <cstdint>
#include <vector>

#include "core/config/graph/graph.h"

namespace carousel::ringbus {

/// The links between two halves of a graph's resources. Of an odd number one half has one more.
struct Cut {
  std::uint64_t bytes_per_cycle = 0;  ///< of all its links, there and back
  std::vector<std::uint32_t> links;
  bool exact = true;  ///< no other halves have fewer bytes; else none were found
};

/// The narrowest cut into halves. Routers stand on either side. Up to 20 nodes all halves are tried. Of larger graphs
/// pairs of resources change sides as long as that narrows the cut (B. Kernighan, S. Lin, An efficient heuristic
/// procedure for partitioning graphs, Bell System Technical Journal 49 (1970)), and routers go where it is narrower.
/// That starts with the halves by number, and with those that are nearest to some of the resources.
Cut narrowest_halves(const config::Graph& graph);

}  // namespace carousel::ringbus
