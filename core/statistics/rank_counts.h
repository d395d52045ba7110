#pragma once

#include <array>
#include <cstdint>

#include "core/statistics/counters.h"

namespace carousel {

/// The messages of a rank to one other rank, and its waits for them to leave.
struct RankCounts {
  std::uint64_t messages = 0, bytes = 0, packets = 0, rays = 0, results = 0, holds = 0, hold_ns = 0, heartbeats = 0,
                shapes = 0, shape_bytes = 0;

  static constexpr auto counters() {
    using C = RankCounts;
    return std::array{
        Counter{"messages", &C::messages, "messages", "messages sent, those that are only a sign of life included"},
        Counter{"bytes", &C::bytes, "bytes", "their contents"},
        Counter{"packets", &C::packets, "packets", "packets in them"},
        Counter{"rays", &C::rays, "rays", "new rays in them, on the way to their slots"},
        Counter{"results", &C::results, "rays", "completed rays in them, on the way to the rank that shades them"},
        Counter{"holds", &C::holds, "times",
                "looks at something to send that had to wait for earlier messages to leave"},
        Counter{"hold_ns", &C::hold_ns, "ns", "time for which something to send waited so"},
        Counter{"heartbeats", &C::heartbeats, "messages", "messages with nothing in them but a sign of life"},
        Counter{"shapes", &C::shapes, "packets", "packets that brought the data of their shapes along"},
        Counter{"shape_bytes", &C::shape_bytes, "bytes", "those data; they are a part of `bytes`"},
    };
  }
  friend bool operator==(const RankCounts&, const RankCounts&) = default;
};

}  // namespace carousel
