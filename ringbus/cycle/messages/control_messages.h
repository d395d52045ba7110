#pragma once

#include <vector>

#include "core/types/workload.h"
#include "ringbus/rays/ray_id.h"

namespace carousel::ringbus::cycle {

/// From ray control to a resource: new rays whose records have been loaded, for its root collection. Or, when one has
/// stopped, what is to be done about it.
struct NewRays {
  std::vector<RayId> ids;
  enum class Order : std::uint8_t {
    kTake,     ///< the rays
    kDiscard,  ///< all work, and whatever packets come; and say when that is done
    kGoOn,     ///< as before, without the one that stopped
  } order = Order::kTake;
};

/// From a resource to shading: completed rays, and the slots they leave. Or how it is with it.
struct CompletedRays {
  HitBatch rays;
  std::vector<std::uint32_t> slots;
  enum class Note : std::uint8_t {
    kDone,      ///< the rays
    kLastBeat,  ///< of a resource that has stopped: nothing will come from it any more
    kDrained,   ///< none of its packets is under way, and nothing it asked for either
  } note = Note::kDone;
};

}  // namespace carousel::ringbus::cycle
