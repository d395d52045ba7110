#pragma once

#include <cstddef>

#include "ringbus/cycle/tile/records/round_trips.h"
#include "ringbus/cycle/tile/stages/collection_room.h"
#include "ringbus/cycle/tile/stages/dispatch_stage.h"
#include "ringbus/cycle/tile/stages/packet_needs.h"
#include "ringbus/protocol/port_logic.h"

namespace carousel::ringbus::cycle {

/// The end of a packet at its owner: its hits join collections, and the packet is free again.
class Retirement {
 public:
  /// Keeps references. `sort_ids_per_cycle`: how fast IDs that join collections are sorted; 0: in no time.
  Retirement(const Machine& machine, Resource& resource, PortLogic& logic, const PacketNeeds& needs,
             std::int64_t sort_ids_per_cycle, DispatchStage& dispatch, CollectionRoom& room, TileRecorder& recorder)
      : resource_(resource),
        logic_(logic),
        needs_(needs),
        sort_rate_(static_cast<Cycle>(sort_ids_per_cycle)),
        dispatch_(dispatch),
        room_(room),
        recorder_(recorder),
        trips_(machine.first_packet(resource.id()).value,
               machine.topology.directions() * machine.packets_per_direction) {}

  /// The packets of this resource that are under way.
  RoundTrips& trips() { return trips_; }
  const RoundTrips& trips() const { return trips_; }

  /// Dispatch has read `entries` of the packet.
  void retire(PacketId id, Packet& packet, std::size_t entries, Cycle now) {
    recorder_.step(now, StepKind::kRetire, id.value, packet.members.size());
    recorder_.retired(packet, id, now);
    trips_.return_home(id.value, now);
    sort_ids(logic_.retire(id, packet), entries, id, now);
    room_.write_spilled(now);
  }
  /// Members of packet `id` come back before the rest of it.
  void retire_part(PacketId id, Packet& part, Cycle now) {
    recorder_.step(now, StepKind::kRetire, id.value, part.members.size());
    recorder_.retired(part, id, now, true);
    const std::size_t entries = needs_.read_at_owner(part);
    if (entries > 0) dispatch_.occupy(now, entries, SliceKind::kRetire, id);
    sort_ids(resource_.retire_part(part), entries, id, now);
    room_.write_spilled(now);
  }
  /// The `members` of a packet of another resource have reached their home and join collections here.
  void join(PacketId id, Packet& packet, Cycle now) {
    const std::size_t ids = packet.members.size();
    resource_.join(packet);
    sort_ids(ids, ids, id, now);
    room_.write_spilled(now);
  }
  /// The packet comes to nothing, since a resource has stopped.
  void discard(PacketId id, Cycle now) {
    trips_.forget(now);
    logic_.discard(id);
  }

 private:
  /// The `joined` ray IDs that join collections are put in order of what comes next (US 9633468). Dispatch, which has
  /// just read `entries` of the packet, goes on until that is done.
  void sort_ids(std::size_t joined, std::size_t entries, PacketId packet, Cycle now) {
    if (sort_rate_ == 0) return;
    const Cycle read = dispatch_.cycles(entries), sorted = ceil_div(joined, sort_rate_);
    if (sorted > read) dispatch_.hold(now, sorted - read, 0, SliceKind::kRetire, packet);
  }

  Resource& resource_;
  PortLogic& logic_;
  const PacketNeeds& needs_;
  Cycle sort_rate_;
  DispatchStage& dispatch_;
  CollectionRoom& room_;
  TileRecorder& recorder_;
  RoundTrips trips_;
};

}  // namespace carousel::ringbus::cycle
