#pragma once

#include <cstdint>

#include "ringbus/results/ray_log.h"
#include "ringbus/results/slice_log.h"

namespace carousel::ringbus {

class RayTimes;

/// The places where one part of a machine notes its slices of time and the life of the followed ray; null: nowhere.
struct Recording {
  SliceLog* slices = nullptr;
  TripTable* trips = nullptr;  ///< with `slices`
  std::uint32_t track = 0;     ///< its first
  RayLog* ray = nullptr;
  std::uint32_t contexts = 0;  ///< tracks of test contexts, as many for each resource
  RayTimes* times = nullptr;   ///< the ledger of all rays' time

  /// A packet is issued. Only with `slices`.
  void issue(std::uint32_t packet, std::span<const PacketMember> members) const {
    trips->issue(packet, ray != nullptr ? ray->ray->find(members).has_value() : slices->wants_next());
  }
};

}  // namespace carousel::ringbus
