// Notes of a resource for the timeline and for the life of a ray, where one of them is asked for.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

/// Tracks: the dispatch stage, the contexts, the units.
void Tile::record_parts() {
  if (recording_.slices != nullptr && recording_.ray == nullptr)
    tester_.record(*recording_.slices, recording_.track + 1 + static_cast<std::uint32_t>(contexts_.size()));
}

void Tile::note_dispatch(Cycle begin, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip) {
  recording_.slices->add({begin, dispatch_free_, has_trip ? recording_.trips->of(packet.value) : 0, 0, recording_.track,
                          packet.value, static_cast<std::uint32_t>(ids), kind});
}

void Tile::note_issued(PacketId id, Cycle now) {
  const Packet& packet = machine_.packet(id);
  recording_.issue(id.value, packet.members);
  if (recording_.ray == nullptr || !recording_.ray->ray->find(packet.members)) return;
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

void Tile::note_test(const Context& context, Cycle now) {
  const PacketId id = context.packet;
  recording_.slices->add({context.since, now, recording_.trips->of(id.value), context.begun,
                          recording_.track + 1 + user_of(context), id.value,
                          static_cast<std::uint32_t>(machine_.packet(id).members.size()), SliceKind::kTest});
}

void Tile::note_admitted(std::span<const RayId> rays) {
  for (const RayId ray : rays)
    if (recording_.ray->ray->is(ray))
      recording_.ray->facts.push_back(
          {.kind = RayFact::Kind::kAdmitted, .at = now_, .end = now_, .resource = id_.value});
}

void Tile::note_tested(const Packet& packet, PacketId id, Cycle at, const TestOutcome& outcome) {
  const auto member = recording_.ray->ray->find(packet.members);
  if (!member || !machine_.stores[id_.value]->owns(packet.members[*member].ray)) return;
  NextNode node{machine_.packet(id).key, 0, machine_.packet(id).depth, true};
  if (!outcome.nodes.empty()) {
    const std::uint32_t slot = resource_.rays().layout().slot(packet.members[*member].ray);  // it may have left it
    node =
        outcome
            .nodes[static_cast<std::size_t>(std::ranges::find(resource_.tested(), slot) - resource_.tested().begin())];
  }
  recording_.ray->facts.push_back({.kind = RayFact::Kind::kTested,
                                   .at = at,
                                   .end = at,
                                   .trip = recording_.trips->of(id.value),
                                   .resource = id_.value,
                                   .packet = id.value,
                                   .rays = static_cast<std::uint32_t>(resource_.tested().size()),
                                   .key = node.key,
                                   .depth = node.depth,
                                   .mask = packet.members[*member].mask,
                                   .hit = hit_of(packet.members[*member].ray)});
}

/// The closest hit so far.
Hit Tile::hit_of(RayId ray) const {
  RayStore& store = *machine_.stores[id_.value];
  return store.records()[store.layout().slot(ray)].hit;  // the ray may have left the slot a moment ago
}

void Tile::note_retired(const Packet& packet, PacketId id) {
  const auto member = recording_.ray->ray->find(packet.members);
  if (!member) return;
  recording_.ray->facts.push_back({.kind = RayFact::Kind::kRetired,
                                   .at = now_,
                                   .end = now_,
                                   .trip = recording_.trips->of(id.value),
                                   .resource = id_.value,
                                   .packet = id.value,
                                   .key = packet.key,
                                   .depth = packet.depth,
                                   .mask = packet.members[*member].mask});
}

void Tile::note_done(Cycle now) {
  for (const RayResult& ray : done_)
    if (recording_.ray->ray->is(ray.tag))
      recording_.ray->facts.push_back(
          {.kind = RayFact::Kind::kDone, .at = now, .end = now, .resource = id_.value, .hit = ray.hit});
}

}  // namespace carousel::ringbus::cycle
