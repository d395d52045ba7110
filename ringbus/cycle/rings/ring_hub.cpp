#include "ringbus/cycle/rings/ring_hub.h"

#include <utility>

namespace carousel::ringbus::cycle {

RingHub::RingHub(ResourceId node, const TopologyConfig& config, const Topology& topology, std::vector<InPort> in,
                 std::vector<OutPort> out)
    : Hub(std::move(in), std::move(out)),
      number_(node.value - topology.resources()),
      docks_(node, config, topology, in_, out_, {0, kNever}, 0) {}

void RingHub::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) {
    look_at(now);
    now_ = now;
    docks_.step(now);
  }
}

}  // namespace carousel::ringbus::cycle
