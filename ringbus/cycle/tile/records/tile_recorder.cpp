#include "ringbus/cycle/tile/records/tile_recorder.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

// Tracks: the dispatch stage, the contexts, the units.
void TileRecorder::note_dispatch(Cycle begin, Cycle end, std::size_t ids, SliceKind kind, PacketId packet,
                                 bool has_trip) {
  recording_.slices->add({begin, end, has_trip ? recording_.trips->of(packet.value) : 0, 0, recording_.track,
                          packet.value, static_cast<std::uint32_t>(ids), kind});
}

void TileRecorder::note_issued(PacketId id, Cycle now) {
  const Packet& packet = machine_.packet(id);
  recording_.issue(id.value, packet.members);
  if (!has_ray() || !recording_.ray->ray->find(packet.members)) return;
  recording_.ray->facts.push_back({.kind = RayFact::Kind::kIssued,
                                   .at = now,
                                   .end = now,
                                   .trip = recording_.trips->of(id.value),
                                   .resource = id_.value,
                                   .other = packet.home.value,
                                   .packet = id.value,
                                   .rays = static_cast<std::uint32_t>(packet.members.size()),
                                   .key = packet.key,
                                   .depth = packet.depth});
}

void TileRecorder::note_context(PacketId id, std::size_t context, Cycle since, Cycle begun, Cycle end) {
  recording_.slices->add({since, end, recording_.trips->of(id.value), begun,
                          recording_.track + 1 + static_cast<std::uint32_t>(context), id.value,
                          static_cast<std::uint32_t>(machine_.packet(id).members.size()), SliceKind::kTest});
}

void TileRecorder::note_tested_rays(PacketId id, std::span<const PacketMember> members, Cycle since, Cycle begun,
                                    Cycle now, std::span<const WalkTime> walks) {
  if (hears(id)) {
    times_->begin_heard_visit(history(id), since, begun, now);
  } else {
    history(id).tested(id_.value, begun, now);
    times_->begin_visit(history(id));
  }
  RayStore& store = *machine_.stores[id_.value];
  std::size_t ray = 0;
  for (const PacketMember& member : members) {
    if (!store.owns(member.ray)) continue;
    const std::uint32_t slot = store.layout().slot(member.ray);  // it may have left it
    const RayTag& tag = store.record(slot).tag;
    const Cycle in_test = times_->tested(slot, tag, member.joined, now);
    if (walks.empty()) continue;
    const WalkTime& walk = walks[ray++];
    times_->walked(slot, tag, walk.strips, in_test, walk.in_test, now - walk.end);
  }
  times_->end_visit();
}

void TileRecorder::note_admitted(std::span<const RayId> rays, Cycle now) {
  for (const RayId ray : rays)
    if (recording_.ray->ray->is(ray))
      recording_.ray->facts.push_back({.kind = RayFact::Kind::kAdmitted, .at = now, .end = now, .resource = id_.value});
}

void TileRecorder::note_tested(const Packet& packet, PacketId id, Cycle at, const TestOutcome& outcome,
                               const Resource& resource) {
  const auto member = recording_.ray->ray->find(packet.members);
  if (!member || !machine_.stores[id_.value]->owns(packet.members[*member].ray)) return;
  NextNode node{machine_.packet(id).key, 0, machine_.packet(id).depth, true};
  if (!outcome.nodes.empty()) {
    const std::uint32_t slot = resource.rays().layout().slot(packet.members[*member].ray);  // it may have left it
    const auto place = std::ranges::find(resource.tested(), slot) - resource.tested().begin();
    node = outcome.nodes[static_cast<std::size_t>(place)];
  }
  recording_.ray->facts.push_back({.kind = RayFact::Kind::kTested,
                                   .at = at,
                                   .end = at,
                                   .trip = recording_.trips->of(id.value),
                                   .resource = id_.value,
                                   .packet = id.value,
                                   .rays = static_cast<std::uint32_t>(resource.tested().size()),
                                   .key = node.key,
                                   .depth = node.depth,
                                   .mask = packet.members[*member].mask,
                                   .hit = hit_of(packet.members[*member].ray)});
}

/// The closest hit so far.
Hit TileRecorder::hit_of(RayId ray) const {
  RayStore& store = *machine_.stores[id_.value];
  return store.records()[store.layout().slot(ray)].hit;  // the ray may have left the slot a moment ago
}

void TileRecorder::note_retired(const Packet& packet, PacketId id, Cycle now) {
  const auto member = recording_.ray->ray->find(packet.members);
  if (!member) return;
  recording_.ray->facts.push_back({.kind = RayFact::Kind::kRetired,
                                   .at = now,
                                   .end = now,
                                   .trip = recording_.trips->of(id.value),
                                   .resource = id_.value,
                                   .packet = id.value,
                                   .key = packet.key,
                                   .depth = packet.depth,
                                   .mask = packet.members[*member].mask});
}

void TileRecorder::note_completed(const HitBatch& rays, Cycle now) {
  for (const RayResult& ray : rays)
    if (recording_.ray->ray->is(ray.tag))
      recording_.ray->facts.push_back(
          {.kind = RayFact::Kind::kDone, .at = now, .end = now, .resource = id_.value, .hit = ray.hit});
}

}  // namespace carousel::ringbus::cycle
