#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/cycle/parcels/parcel.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The least time from a node's links to its part: what has come to its node is with the part a cycle later.
inline constexpr Cycle kDoorCycles = 1;

/// Where messages of a part enter drawn links, and leave them. Belongs to a relay.
class Door {
 public:
  virtual ~Door() = default;

  /// The time at which the part sends something next; kNever while none is known.
  virtual Cycle next() const = 0;
  /// Appends what the part has sent by `now`, with its stop.
  virtual void collect(Cycle now, std::vector<Parcel>& out) = 0;
  /// Hands a parcel to the part.
  virtual void deliver(Parcel&& parcel, Cycle now) = 0;
};

/// A door of a node that others name.
struct DoorPlace {
  std::uint32_t node = 0;  ///< of the graph
  std::uint32_t door = 0;
};

}  // namespace carousel::ringbus::cycle
