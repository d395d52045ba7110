// A part as a plugin, a router of drawn networks, `topology.routes: columns_first`: which link takes a packet on.
#include <cmath>
#include <cstddef>

#include "ringbus/plugin/bring.h"

namespace {

using carousel::RouterNode, carousel::RouterQuestion;

/// A packet goes along its column until it is in the row of its destination, and then along the row, as in the mesh of
/// Knights Landing (A. Sodani et al., IEEE Micro 36, 2016). No way turns from a row into a column, so links that wait
/// for one another form no circle. Nodes without a place, and nodes beside the mesh, have the shortest ways.
std::size_t columns_first(const RouterQuestion& question) {
  const RouterNode &at = question.nodes[question.at], &to = question.nodes[question.to];
  if (!at.placed || !to.placed) return question.shortest;
  const bool turn = at.y_mm == to.y_mm;  // from here on along the row
  for (std::size_t i = 0; i < question.links.size(); ++i) {
    const RouterNode& next = question.nodes[question.links[i].to];
    const bool same = turn ? next.y_mm == at.y_mm : next.x_mm == at.x_mm;
    const double before = turn ? to.x_mm - at.x_mm : to.y_mm - at.y_mm,
                 after = turn ? to.x_mm - next.x_mm : to.y_mm - next.y_mm;
    if (next.placed && same && std::abs(after) < std::abs(before)) return i;
  }
  return question.shortest;
}

}  // namespace

extern "C" const carousel::PluginInfo* carousel_plugin() {
  static const carousel::PluginInfo info = carousel::plugin("columns first", "1.0", [](carousel::PluginParts& parts) {
    carousel::ringbus::bring_router(parts, "columns_first", {.choose = columns_first});
  });
  return &info;
}
