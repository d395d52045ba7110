#include "ringbus/native/native_machine.h"

namespace carousel::ringbus {

NativeMachine::NativeMachine(const Config& config, const accel::Accel& accel, float scene_size,
                             const LinkMaker& own_links)
    : shared(config, accel, scene_size) {
  // One resource sends on a wire and one receives, and one thread at a time plays a resource.
  require_parties(config.topology.link.queue, "topology.link.queue", Parties::kOne, Parties::kOne);
  for (const Topology::Wire& wire : shared.topology.wires())
    links.push_back(own_links ? own_links(config, links.size(), wire.from, wire.to, shared.packets)
                              : make_link(config, links.size(), wire.from, wire.to, shared.packets));
}

}  // namespace carousel::ringbus
