#pragma once

#include <cstdint>

#include "core/config/graph/routes.h"

namespace carousel::ringbus {

using config::Routes;

/// Tells whether the node at the end of a link, by its number in the graph, sends what goes to `to` on when its head
/// has come. What changes to a link of another width, or passes from clock to clock, is stored whole: its tail might be
/// late, or wait.
inline bool goes_through(const config::Graph& graph, const Routes& routes, std::uint32_t link, std::uint32_t to) {
  const config::Graph::Link& here = graph.links[link];
  if (here.to == to || graph.nodes[here.to].drawn->forward != Forward::kHead) return false;
  const config::Graph::Link& next = graph.links[routes.link(here.to, to)];
  return next.bytes_per_cycle == here.bytes_per_cycle && next.mhz == here.mhz &&
         graph.nodes[here.to].drawn->mhz == here.mhz;
}

}  // namespace carousel::ringbus
