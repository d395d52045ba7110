#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/config/fields/topology.h"
#include "core/types/ray.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The ports by which records get into the ray stores, one a resource and as wide as a link.
class LoadPorts {
 public:
  LoadPorts(const LinkConfig& link, std::size_t resources)
      : cycles_(ceil_div(sizeof(RayRecord), static_cast<std::uint64_t>(link.bytes_per_cycle))), free_at_(resources) {}

  /// Loads records into a resource, behind those that are being loaded; returns the cycle in which they are there.
  Cycle load(std::uint32_t resource, std::uint64_t records, Cycle now) {
    Cycle& port = free_at_[resource];
    return port = std::max(port, now) + cycles_ * records;
  }

 private:
  Cycle cycles_;  // that a record takes
  std::vector<Cycle> free_at_;
};

}  // namespace carousel::ringbus::cycle
