#pragma once

#include <cstdint>

#include "core/config/graph/routes.h"

namespace carousel::ringbus {

using config::Routes;

/// Tells whether the node at the end of a link, by its number in the graph, sends what goes to `to` on when its head
/// has come. What changes to a link of another width is stored whole: its tail might be late, or wait.
inline bool goes_through(const config::Graph& graph, const Routes& routes, std::uint32_t link, std::uint32_t to) {
  const std::uint32_t node = graph.links[link].to;
  return node != to && graph.nodes[node].drawn->forward == Forward::kHead &&
         graph.links[routes.link(node, to)].bytes_per_cycle == graph.links[link].bytes_per_cycle;
}

}  // namespace carousel::ringbus
