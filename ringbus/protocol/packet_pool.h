#pragma once

#include <vector>

#include "ringbus/packets/packet.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

/// All packets of a machine, `per_direction` a resource and direction, ordered by owner, then direction. Each has room
/// for `rays` members, and with `ordered` traversal for the next node of each.
std::vector<Packet> make_packets(const Topology& topology, std::uint32_t per_direction, std::size_t rays, bool ordered);

}  // namespace carousel::ringbus
