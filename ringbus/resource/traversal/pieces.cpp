#include "ringbus/resource/traversal/pieces.h"

#include <algorithm>

namespace carousel::ringbus {

void PieceTraversal::prepare(Packet& packet) const {
  packet.exits.clear();
  if (!all_at_once_) packet.next.assign(packet.members.size(), NextNode{});
}

void PieceTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  from_.clear();
  nodes_.clear();
  exits_.clear();
  for (const std::uint32_t member : local.members) {
    const PacketGroup place = packet.place_of(member);
    from_.push_back(place.key);
    nodes_.push_back({place.key, 0, place.depth, true});
  }
  const accel::RayMembers members = context_.members(local.slots);
  // An engine's own tracer also counts the transforms.
  SubtreeTracer& tracer = context_.subtree_tracer != nullptr ? *context_.subtree_tracer : walk_;
  tracer.trace_treelets(from_, members, exits_, outcome.counts);
  context_.any_hit.hold_back();
  if (!packet.groups.empty()) outcome.nodes = nodes_;
  auto exit = exits_.begin();
  for (std::uint32_t i = 0; i < local.size(); ++i) {
    const std::uint32_t slot = local.slots[i];
    const RayRecord& record = context_.store.record(slot);
    const bool done = (record.tag.flags & kRayDone) != 0;
    left_.clear();
    for (; exit != exits_.end() && exit->member == i; ++exit) {
      if (done || exit->next.entry > record.hit.t) continue;
      left_.push_back(exit->next);
      left_.back().depth = static_cast<std::uint16_t>(left_.back().depth + nodes_[i].depth);
    }
    outcome.children += static_cast<std::uint32_t>(left_.size());
    outcome.misses += left_.empty();
    if (all_at_once_)
      go_on_at_all(slot, local.members[i], packet);
    else
      go_on_at_one(slot, local.members[i], packet, outcome);
  }
}

void PieceTraversal::go_on_at_all(std::uint32_t slot, std::uint32_t member, Packet& packet) {
  for (const NextNode& next : left_) packet.exits.push_back({member, next});
  context_.completion.add_pending(slot, static_cast<std::int32_t>(left_.size()) - 1);
}

void PieceTraversal::go_on_at_one(std::uint32_t slot, std::uint32_t member, Packet& packet, TestOutcome& outcome) {
  std::vector<NextNode>& stack = stacks_[slot];
  const RayRecord& record = context_.store.record(slot);
  if ((record.tag.flags & kRayDone) != 0) stack.clear();
  // The last to be visited first.
  std::reverse(left_.begin(), left_.end());
  if (order_ == ChildOrder::kNearest)
    std::stable_sort(left_.begin(), left_.end(),
                     [](const NextNode& a, const NextNode& b) { return a.entry > b.entry; });
  // The next piece goes into the packet at once, and never onto the stack.
  std::uint64_t moved = left_.empty() ? 0 : left_.size() - 1;
  NextNode next;
  if (!left_.empty()) {
    next = left_.back();
    stack.insert(stack.end(), left_.begin(), left_.end() - 1);
  }
  while (!next.any && !stack.empty()) {
    ++moved;
    if (!(stack.back().entry > record.hit.t)) next = stack.back();
    stack.pop_back();
  }
  outcome.reads += static_cast<std::uint32_t>((moved * kEntryBytes + kAccessBytes - 1) / kAccessBytes);
  packet.next[member] = next;
  if (!next.any) context_.completion.add_pending(slot, -1);
}

void PieceTraversal::retire(const Packet& packet, CollectionStore& collections) {
  for (const PacketExit& exit : packet.exits)
    collections.add(exit.next.key, exit.next.depth, exit.next.entry, {&packet.members[exit.member].ray, 1});
  for (std::size_t i = 0; i < packet.next.size() && i < packet.members.size(); ++i)
    if (const NextNode& next = packet.next[i]; next.any)
      collections.add(next.key, next.depth, next.entry, {&packet.members[i].ray, 1});
}

void PieceTraversal::discard() {
  for (std::vector<NextNode>& stack : stacks_) stack.clear();
}

}  // namespace carousel::ringbus
