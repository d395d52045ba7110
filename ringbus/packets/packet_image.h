#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

/// A copy of a packet's contents as a link carries it, in words: everything that changes on its way.
using PacketImage = std::vector<std::uint64_t>;

PacketImage image_of(const Packet& packet);
/// Appends an image.
void append_image(const Packet& packet, PacketImage& image);
/// Writes an image back into a packet. The image must be undamaged, as a checksum has told.
void restore(std::span<const std::uint64_t> image, Packet& packet);

}  // namespace carousel::ringbus
