#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

/// What a packet holds, as a link carries it: everything that changes on its way, in words.
using PacketImage = std::vector<std::uint64_t>;

PacketImage image_of(const Packet& packet);
/// The reverse. `image` must be whole, as a checksum has told.
void restore(std::span<const std::uint64_t> image, Packet& packet);

}  // namespace carousel::ringbus
