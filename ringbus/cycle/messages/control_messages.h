#pragma once

#include <vector>

#include "core/types/workload.h"
#include "ringbus/rays/ray_id.h"
#include "ringbus/time/channel_list.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Ray control sends a resource new rays whose records have been loaded, for its root collection; or an order, when a
/// resource has stopped.
struct NewRays {
  std::vector<RayId> ids;
  enum class Order : std::uint8_t {
    kTake,     ///< take the rays
    kDiscard,  ///< discard all work and every packet that comes back, and note when that is done
    kResume,   ///< go on without the resource that has stopped
  } order = Order::kTake;
  std::uint64_t records = 0;            ///< loaded for them into ray stores, those of bundles included
  RayBatch rays{};                      ///< instead of IDs: rays that travel to find slots
  std::vector<ResourceId> addresses{};  ///< a resource for each of `rays` with `placement: addressed`, of 2 bytes

  /// An order has 4 bytes.
  std::uint64_t bytes() const {
    return records * sizeof(RayRecord) + 2 * addresses.size() +
           (order == Order::kTake ? 4 * ids.size() : std::uint64_t{4});
  }
};

/// A resource sends shading completed rays and the slots they leave; or a note on its own state.
struct CompletedRays {
  HitBatch rays;
  std::vector<std::uint32_t> slots;
  enum class Note : std::uint8_t {
    kDone,      ///< the rays are complete
    kLastBeat,  ///< it has stopped: nothing will come from it any more
    kDrained,   ///< none of its packets, fetches and any-hit calls is under way
  } note = Note::kDone;
  std::vector<Cycle> placed{};  ///< where rays travel: the times at which they were given those slots

  std::uint64_t hit_bytes = 0;  ///< of hits besides those of the records, with `rays.query.nearest`

  /// A record says where it lay, so the slots need no bytes of their own. A note has 4.
  std::uint64_t bytes() const { return rays.size() * sizeof(RayRecord) + hit_bytes + (note == Note::kDone ? 0 : 4); }
};

struct ControlKinds {
  MessageKind new_rays, completed;
  /// `width` of the wires in bytes a cycle.
  ControlKinds(ChannelList& list, std::uint64_t width)
      : new_rays(list.carry({"new rays", "ray control", "resources", "load ports and wires of IDs", width})),
        completed(list.carry({"completed rays", "resources", "ray control", "ports of completed rays", width})) {}
};

}  // namespace carousel::ringbus::cycle
