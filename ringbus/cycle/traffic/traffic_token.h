#pragma once

#include <cstdint>

#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// A packet of synthetic traffic. There is nothing in it but its way.
struct TrafficToken {
  Cycle created = 0;
  std::uint16_t source = 0;
  std::uint16_t skip = 0;         ///< resources to pass before its last one
  std::uint16_t link_cycles = 1;  ///< its flits: the cycles for which it occupies a link
  std::uint32_t hops = 0;         ///< links that it crosses in all; on a ring with stops its flits do, there and back
  std::uint16_t stop = 0;         ///< its destination, where packets are routed
  std::uint16_t channel = 0;      ///< class of the channel that it takes on its link
  std::uint16_t behind = 0;       ///< of a flit: those of its packet that come after it
};

/// A packet has been delivered; its source may have another one on the way.
struct TrafficAck {
  std::uint16_t source = 0;
  std::uint16_t direction = 0;  ///< that the packet had
};

}  // namespace carousel::ringbus::cycle
