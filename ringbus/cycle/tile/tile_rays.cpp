// Rays that come and go beside the ring; and new rays that travel in packets, out of the queue in which they wait,
// through resources with free slots, and home, from where their IDs are admitted.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

void Tile::take_new_rays(Cycle now) {
  while (ports_.new_rays->next() <= now) {
    NewRays rays = ports_.new_rays->take();
    if (rays.order != NewRays::Order::kTake)
      on_order(rays.order, now);
    else if (!rays.rays.empty())
      travelling_.arrive(std::move(rays));
    else if (!logic_.only_forwards())
      logic_.admission.add(std::move(rays.ids));
  }
}

void Tile::hand_over(Cycle now) {
  if (done_.empty()) return;
  if (recording_.ray != nullptr) [[unlikely]]
    note_done(now);
  sink_.record({.kind = EventKind::kComplete, .resource = id_, .rays = static_cast<std::uint32_t>(done_.size())});
  trace_.note(now, StepKind::kComplete, 0, done_.size());
  std::vector<Cycle> placed;
  if (travelling_.on()) placed = travelling_.free(done_slots_, now);
  completed_port_.send(done_, done_slots_, std::move(placed), now);
}

// ---- rays that travel

/// Sends the group that has waited longest round the ring. It goes before the resource's own packets, since it brings
/// work to all.
bool Tile::send_new_rays(Cycle now) {
  if (!travelling_.waiting()) return false;
  // The last packet is left to rays that are under way: only they can free the slots that new ones wait for.
  if (!resource_.idle() && resource_.packets_in_flight() == 0 && issue_.empty()) return false;
  const std::optional<PacketId> id = logic_.free.front();
  if (!id) return false;
  Packet& packet = machine_.packet(*id);
  packet.kind = PacketKind::kRays;
  const bool travels = machine_.topology.hops(packet) > 0;
  if (travels && !may_inject(packet)) return false;
  logic_.free.take();
  occupy_dispatch(now, travelling_.next_rays(), SliceKind::kIssue, *id, false);
  travelling_.load(packet);
  const Cycle loaded = take_slots(packet, now);
  if (!travels || packet.requests.empty()) {
    come_home(*id, now);
    return true;
  }
  ++rays_out_;
  depart(*id, std::max(dispatch_free_, loaded), false);
  return true;
}

/// A packet of another resource brings new rays.
void Tile::visit_with_rays(std::size_t d, Cycle now) {
  const PacketId id = ports_.in[d].take(now).packet;
  Packet& packet = machine_.packet(id);
  occupy_dispatch(now, packet.requests.size(), SliceKind::kPass, id, false);
  const Cycle loaded = take_slots(packet, now);
  depart(id, std::max(dispatch_free_, loaded), false);
}

void Tile::retire_rays(std::size_t d, Cycle now) {
  const PacketId id = ports_.in[d].take(now).packet;
  const Packet& packet = machine_.packet(id);
  occupy_dispatch(now, packet.requests.size() + packet.members.size(), SliceKind::kRetire, id, false);
  --rays_out_;
  come_home(id, now);
}

Cycle Tile::take_slots(Packet& packet, Cycle now) {
  const Cycle loaded = travelling_.take_slots(packet, now);
  if (travelling_.taken() > 0) trace_.note(now, StepKind::kPlace, 0, travelling_.taken());
  return loaded;
}

void Tile::come_home(PacketId id, Cycle now) {
  travelling_.come_home(machine_.packet(id), now);
  if (travelling_.taken() > 0) trace_.note(now, StepKind::kPlace, 0, travelling_.taken());
  logic_.discard(id);
}

}  // namespace carousel::ringbus::cycle
