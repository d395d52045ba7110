// Notes of a port for the timeline and for the life of a ray, where one of them is asked for.
#include "ringbus/native/native_port.h"

namespace carousel::ringbus {

void NativePort::record(NativeRecorder& recorder) {
  recorder_ = &recorder;
  recording_ = recorder.of_resource(resource_.id());
}

void NativePort::note_slice(SliceKind kind, PacketId packet, std::uint64_t begin) {
  const auto rays = static_cast<std::uint32_t>(machine_.packet(packet).members.size());
  recording_.slices->add(
      {begin, recorder_->now(), recording_.trips->of(packet.value), 0, recording_.track, packet.value, rays, kind});
}

/// A packet that has left may come home and be issued anew at once, so its trip is looked up before.
void NativePort::note_sending(std::span<const PacketId> packets) {
  sending_.clear();
  for (const PacketId packet : packets) sending_.push_back(recording_.trips->of(packet.value));
  sending_since_ = recorder_->now();
}

/// The packets of a send share its time.
void NativePort::note_sent(const OutPort& out, std::span<const PacketId> packets) {
  const std::uint64_t each = (recorder_->now() - sending_since_) / packets.size();
  for (std::size_t i = 0; i < packets.size(); ++i, sending_since_ += each)
    recording_.slices->add({sending_since_, sending_since_ + each, sending_[i], 0, recorder_->link_track(out.wire),
                            packets[i].value, 0, SliceKind::kLink});
}

void NativePort::note_visit(PacketId id, bool tested, std::uint64_t begin) {
  if (tested) note_member(RayFact::Kind::kTested, id, machine_.packet(id), begin);
  note_slice(tested ? SliceKind::kVisit : SliceKind::kPass, id, begin);
}

void NativePort::note_admitted(std::span<const RayId> rays) {
  if (recording_.ray == nullptr) return;
  const RayIdLayout& layout = resource_.rays().layout();
  for (const RayId id : rays) {
    RayStore& store = *machine_.stores[layout.owner(id).value];
    if (store.is_bundle(layout.slot(id)) || !recording_.ray->ray->is(store.record(layout.slot(id)).tag)) continue;
    recording_.ray->ray->place(id);
    const std::uint64_t at = recorder_->now();
    recording_.ray->facts.push_back({.kind = RayFact::Kind::kPlaced,
                                     .at = at,
                                     .end = at,
                                     .resource = layout.owner(id).value,
                                     .other = resource_.id().value,
                                     .packet = layout.slot(id)});
    recording_.ray->facts.push_back(
        {.kind = RayFact::Kind::kAdmitted, .at = at, .end = at, .resource = resource_.id().value});
  }
}

/// Returns the time.
std::uint64_t NativePort::note_issued(std::optional<PacketId> id, const Packet& packet) {
  if (id) recording_.issue(id->value, packet.members);
  const std::uint64_t at = recorder_->now();
  note_member(RayFact::Kind::kIssued, id, packet, at);
  return at;
}

/// It may have been tested where it was issued, and is retired there at once unless it travels.
void NativePort::note_leaving(std::optional<PacketId> id, const Packet& packet, bool tested, std::uint64_t begin) {
  if (tested) note_member(RayFact::Kind::kTested, id, packet, begin);
  if (id)
    note_slice(SliceKind::kIssue, *id, begin);
  else
    recording_.slices->add({.begin = begin,
                            .end = recorder_->now(),
                            .track = recording_.track,
                            .rays = static_cast<std::uint32_t>(packet.members.size()),
                            .kind = SliceKind::kIssue});
  if (!id || !logic_.travels(packet)) note_member(RayFact::Kind::kRetired, id, packet, recorder_->now());
}

void NativePort::note_retired(PacketId id, const Packet& packet) {
  note_member(RayFact::Kind::kRetired, id, packet, recorder_->now());
}

void NativePort::note_member(RayFact::Kind kind, std::optional<PacketId> id, const Packet& packet, std::uint64_t at) {
  if (recording_.ray == nullptr) return;
  // A packet that comes back when the ray already has the ID of one of its members is not a packet of the ray.
  if (id && recording_.trips->of(id->value) == 0) return;
  const auto member = recording_.ray->ray->find(packet.members);
  if (!member || (kind == RayFact::Kind::kTested && !resource_.rays().owns(packet.members[*member].ray))) return;
  recording_.ray->facts.push_back({.kind = kind,
                                   .at = at,
                                   .end = kind == RayFact::Kind::kTested ? recorder_->now() : at,
                                   .trip = id ? recording_.trips->of(id->value) : 0,
                                   .resource = resource_.id().value,
                                   .other = packet.home.value,
                                   .packet = id ? id->value : 0,
                                   .rays = static_cast<std::uint32_t>(packet.members.size()),
                                   .key = packet.key,
                                   .depth = packet.depth,
                                   .mask = packet.members[*member].mask});
  if (kind != RayFact::Kind::kTested) return;
  RayStore& store = *machine_.stores[resource_.id().value];  // the ray may have left its slot a moment ago
  recording_.ray->facts.back().hit = store.records()[store.layout().slot(packet.members[*member].ray)].hit;
}

void NativePort::note_done(const HitBatch& done) {
  if (recording_.ray == nullptr) return;
  for (const RayResult& ray : done) {
    if (!recording_.ray->ray->is(ray.tag)) continue;
    recording_.ray->ray->leave();
    const std::uint64_t at = recorder_->now();
    recording_.ray->facts.push_back(
        {.kind = RayFact::Kind::kDone, .at = at, .end = at, .resource = resource_.id().value, .hit = ray.hit});
  }
}

}  // namespace carousel::ringbus
