// A part as a plugin, the dispatch of a resource, `testers.dispatch: fullest_first`: which of the packets that wait in
// its window it takes.
#include <cstddef>
#include <span>

#include "ringbus/plugin/bring.h"

namespace {

using carousel::WaitingPacket;

/// The packet with most rays of those that can go on, and of these one whose shapes are there.
std::size_t fullest_first(std::span<const WaitingPacket> packets) {
  std::size_t best = packets.size();
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (!packets[i].may_go) continue;
    if (best == packets.size() || packets[i].rays > packets[best].rays ||
        (packets[i].rays == packets[best].rays && packets[i].has_shapes && !packets[best].has_shapes))
      best = i;
  }
  return best;
}

}  // namespace

extern "C" const carousel::PluginInfo* carousel_plugin() {
  static const carousel::PluginInfo info = carousel::plugin("fullest first", "1.0", [](carousel::PluginParts& parts) {
    carousel::ringbus::bring_dispatch(parts, "fullest_first", {.choose = fullest_first});
  });
  return &info;
}
