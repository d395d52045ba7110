#include "ringbus/protocol/packet_pool.h"

#include "ringbus/resource/traversal/make_traversal.h"

namespace carousel::ringbus {

std::vector<Packet> make_packets(const Config& config, const Topology& topology, std::uint32_t per_direction) {
  std::vector<Packet> packets(topology.resources() * topology.directions() * per_direction);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    Packet& p = packets[i];
    p.owner = ResourceId(static_cast<std::uint32_t>(i / (topology.directions() * per_direction)));
    p.direction = static_cast<std::uint16_t>(i / per_direction % topology.directions());
    p.members.reserve(static_cast<std::size_t>(config.packets.rays));
    p.owners.resize((topology.resources() + 63) / 64);
    if (one_collection_a_ray(config.collections.traversal))
      p.next.reserve(static_cast<std::size_t>(config.packets.rays));
  }
  return packets;
}

}  // namespace carousel::ringbus
