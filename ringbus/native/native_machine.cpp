#include "ringbus/native/native_machine.h"

namespace carousel::ringbus {

NativeMachine::NativeMachine(const Config& config, const accel::Accel& accel, float scene_size,
                             const LinkMaker& own_links, Transport* transport)
    : shared(config, accel, scene_size, std::nullopt,
             transport == nullptr ? RankShare()
                                  : RankShare(transport->rank(), transport->ranks(), config.topology.resources)) {
  // One resource sends on a wire and one receives, and one thread at a time plays a resource.
  require_parties(config.topology.link.queue, "topology.link.queue", Parties::kOne, Parties::kOne);
  if (!shared.share.alone()) gate = std::make_unique<RankGate>(config, *transport, shared, completed);
  for (const Topology::Wire& wire : shared.topology.wires()) {
    if (gate && !gate->here(wire)) {
      links.push_back(gate->make_link(static_cast<std::uint32_t>(links.size()),
                                      static_cast<std::size_t>(config.topology.link.depth)));
      continue;
    }
    links.push_back(own_links ? own_links(config, links.size(), wire.from, wire.to, shared.packets)
                              : make_link(config, links.size(), wire.from, wire.to, shared.packets));
  }
}

}  // namespace carousel::ringbus
