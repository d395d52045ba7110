#pragma once

#include <algorithm>
#include <cstdint>

#include "core/config/fields/memory.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// Names the resources that get the shapes of a packet together with its issuer (`memory.fetch: multicast`): those
/// behind the same L2 that have rays of it.
class Multicast {
 public:
  Multicast(const MemoryConfig& memory, ResourceId here, std::size_t resources)
      : on_(memory.fetch == MemoryConfig::Fetch::kMulticast),
        here_(here.value),
        first_(here.value / static_cast<std::uint32_t>(memory.shared_by) *
               static_cast<std::uint32_t>(memory.shared_by)),
        end_(std::min(static_cast<std::uint32_t>(resources), first_ + static_cast<std::uint32_t>(memory.shared_by))) {}

  /// A bit for each, by its number among the clients of the L2.
  std::uint64_t others(const Topology& topology, const Packet& packet) const {
    std::uint64_t others = 0;
    for (std::uint32_t r = first_; on_ && r < end_; ++r)
      if (r != here_ && topology.wanted(packet, ResourceId(r))) others |= std::uint64_t{1} << (r - first_);
    return others;
  }

 private:
  bool on_;
  std::uint32_t here_, first_, end_;
};

}  // namespace carousel::ringbus::cycle
