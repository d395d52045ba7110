#include "ringbus/cycle/tile/stages/ray_entry.h"

#include <algorithm>
#include <optional>
#include <span>

namespace carousel::ringbus::cycle {

bool RayEntry::admit(Cycle now) {
  const bool loaded = travelling_.admit(now, logic_.admission);
  if (logic_.admission.empty()) return loaded;
  const bool moved = logic_.admission.admit(resource_, [&](std::span<const RayId> rays) {
    recorder_.step(now, StepKind::kNewRays, 0, rays.size());
    recorder_.admitted(rays, now);
  });
  room_.write_spilled(now);
  room_.set_short_of_room(logic_.admission.short_of_room());
  return moved;
}

/// New rays go before the resource's own packets, since they bring work to all.
bool RayEntry::send(Cycle now, bool issue_is_empty) {
  if (!travelling_.waiting()) return false;
  // The last packet is left to rays that are under way: only they can free the slots that new ones wait for.
  if (!resource_.idle() && resource_.packets_in_flight() == 0 && issue_is_empty) return false;
  const std::optional<PacketId> id = logic_.free.front();
  if (!id) return false;
  Packet& packet = machine_.packet(*id);
  packet.kind = PacketKind::kRays;
  const bool travels = machine_.topology.hops(packet) > 0;
  if (travels && !egress_.may_inject(packet)) return false;
  logic_.free.take();
  dispatch_.occupy(now, travelling_.next_rays(), SliceKind::kIssue, *id, false);
  travelling_.load(packet);
  const Cycle loaded = take_slots(packet, now);
  if (!travels || packet.requests.empty()) {
    return_home(*id, now);
    return true;
  }
  ++packets_out_;
  egress_.depart(*id, std::max(dispatch_.free_at(), loaded), false);
  return true;
}

void RayEntry::visit(PacketId id, Cycle now) {
  Packet& packet = machine_.packet(id);
  dispatch_.occupy(now, packet.requests.size(), SliceKind::kPass, id, false);
  const Cycle loaded = take_slots(packet, now);
  egress_.depart(id, std::max(dispatch_.free_at(), loaded), false);
}

void RayEntry::retire(PacketId id, Cycle now) {
  const Packet& packet = machine_.packet(id);
  dispatch_.occupy(now, packet.requests.size() + packet.members.size(), SliceKind::kRetire, id, false);
  --packets_out_;
  return_home(id, now);
}

Cycle RayEntry::take_slots(Packet& packet, Cycle now) {
  const Cycle loaded = travelling_.take_slots(packet, now);
  note_placed(now);
  return loaded;
}

void RayEntry::return_home(PacketId id, Cycle now) {
  travelling_.retire_at_owner(machine_.packet(id), now);
  note_placed(now);
  logic_.discard(id);
}

}  // namespace carousel::ringbus::cycle
