#include "ringbus/resource/traversal/ordered.h"

#include "accel/traverse/kernels.h"
#include "ringbus/resource/traversal/last_first.h"
#include "ringbus/resource/visit/count_children.h"

namespace carousel::ringbus {

void OrderedTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  const TransformCharge charge(context_, local.slots, packet.key.instance);
  const accel::RayMembers members = context_.members(local.slots);
  if (packet.key.ref.is_inner()) {
    masks_.resize(local.size());
    entries_.resize(accel::kMaxWidth * local.size());
    accel::test_strip(context_.accel, packet.key, packet.lanes, members,
                      {masks_.data(), packet.nearest, entries_.data()}, outcome.counts);
    count_children(masks_, outcome);
  } else {
    masks_.assign(local.size(), 0);
    accel::test_strip(context_.accel, packet.key, packet.lanes, members, {}, outcome.counts);
  }
  context_.any_hit.hold_back(local.slots);
  for (std::size_t i = 0; i < local.size(); ++i) {
    const std::uint32_t slot = local.slots[i];
    const float* entry = entries_.data() + accel::kMaxWidth * i;
    last_first(order_, masks_[i], entry, [&](int lane) {
      stacks_.push(slot, {context_.accel.child_key(packet.key, lane), entry[lane],
                          static_cast<std::uint16_t>(packet.depth + 1), true});
    });
    const RayRecord& ray = context_.store.record(slot);
    const bool done = (ray.tag.flags & kRayDone) != 0;
    const NextNode next = done ? NextNode{} : stacks_.pop(slot, ray.hit.t);
    packet.next[local.members[i]] = next;
    if (next.any) continue;
    stacks_.clear(slot);
    context_.completion.add_pending(slot, -1);
  }
  charge.write(outcome.counts);
}

void OrderedTraversal::retire(const Packet& packet, CollectionStore& collections) {
  for (std::size_t i = 0; i < packet.members.size(); ++i) {
    const NextNode& next = packet.next[i];
    if (next.any) collections.add(next.key, next.depth, next.entry, {&packet.members[i].ray, 1});
  }
}

void OrderedTraversal::discard() {
  for (std::uint32_t slot = 0; slot < context_.store.slots(); ++slot) stacks_.clear(slot);
}

}  // namespace carousel::ringbus
