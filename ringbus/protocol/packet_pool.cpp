#include "ringbus/protocol/packet_pool.h"

namespace carousel::ringbus {

std::vector<Packet> make_packets(const Topology& topology, std::uint32_t per_direction, std::size_t rays,
                                 bool ordered) {
  std::vector<Packet> packets(topology.resources() * topology.directions() * per_direction);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    Packet& p = packets[i];
    p.owner = ResourceId(static_cast<std::uint32_t>(i / (topology.directions() * per_direction)));
    p.direction = static_cast<std::uint16_t>(i / per_direction % topology.directions());
    p.members.reserve(rays);
    p.owners.resize((topology.resources() + 63) / 64);
    if (ordered) p.next.reserve(rays);
  }
  return packets;
}

}  // namespace carousel::ringbus
