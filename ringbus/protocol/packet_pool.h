#pragma once

#include <vector>

#include "core/config/config.h"
#include "ringbus/packets/packet.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

/// All packets of a machine, `per_direction` a resource and direction, ordered by owner, then direction.
std::vector<Packet> make_packets(const Config& config, const Topology& topology, std::uint32_t per_direction);

}  // namespace carousel::ringbus
