#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Packets and messages that resources have sent, by the kind that their header names: what the next resource does.
struct PacketKindCounts {
  std::uint64_t load = 0, join = 0, box = 0, triangle = 0, procedural = 0, result = 0;

  static constexpr auto counters() {
    using C = PacketKindCounts;
    return std::array{
        Counter{"load", &C::load, "packets", "new rays that look for slots"},
        Counter{"join", &C::join, "packets", "rays on their way to a collection, or a packet that has brought them"},
        Counter{"box", &C::box, "packets", "rays to be tested against boxes, or through a treelet"},
        Counter{"triangle", &C::triangle, "packets", "rays to be tested against triangles"},
        Counter{"procedural", &C::procedural, "packets", "rays to be tested against procedural primitives"},
        Counter{"result", &C::result, "packets",
                "results alone: answers on a bus, and messages with packets.results: message"},
    };
  }
  friend bool operator==(const PacketKindCounts&, const PacketKindCounts&) = default;
};

}  // namespace carousel
