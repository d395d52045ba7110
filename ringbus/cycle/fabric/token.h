#pragma once

#include <cstdint>

#include "core/config/fields/graph.h"
#include "ringbus/packets/packet.h"

namespace carousel::ringbus::cycle {

/// A packet on a link: its ID, and what the resources on its way need to know, so that a resource that owns none of its
/// rays need not look into it. This saves time of the host only: the simulated resource looks into it all the same.
struct Token {
  static_assert(config::kMaxResources <= 256 && config::kMaxLanes <= 256);

  PacketId packet;
  std::uint16_t skip = 0;         ///< resources to pass before the next one that has work with it; routed: stops
  std::uint16_t rays = 0;         ///< members
  std::uint32_t link_cycles = 1;  ///< cycles for which it occupies a link
  std::uint32_t entries = 0;      ///< IDs and results that dispatch reads if it looks into it
  bool answers = false;           ///< it is an answer, on its way to the packet's owner
  bool passes = false;            ///< the resource that hears it has none of its rays
  std::uint8_t stop = 0;          ///< the resource to which it goes next, where packets are routed
  std::uint8_t lane = 0;          ///< and the packet's direction
  std::uint32_t size_bytes = 0;

  std::uint64_t bytes() const { return size_bytes; }
};

}  // namespace carousel::ringbus::cycle
