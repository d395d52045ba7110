#pragma once

#include <cstdint>

#include "ringbus/packets/packet.h"

namespace carousel::ringbus::cycle {

/// A packet on a link: its ID, and what the resources it passes need to know, so that those that own none of its
/// rays need not look into it. That is an economy of the host's: the simulated resource looks all the same.
struct Token {
  PacketId packet;
  std::uint16_t skip = 0;         ///< resources to pass before one that has work with it
  std::uint16_t link_cycles = 1;  ///< for which it occupies a link
  std::uint16_t rays = 0;         ///< members
};

}  // namespace carousel::ringbus::cycle
