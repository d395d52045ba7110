#include "ringbus/resource/traversal/ordered.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "accel/primitive/nearest_ray.h"
#include "accel/traverse/kernels.h"
#include "ringbus/resource/visit/count_children.h"
#include "ringbus/resource/visit/last_first.h"

namespace carousel::ringbus {

void OrderedTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  const TransformCharge charge(context_, local.slots, packet.key.instance);
  if (context_.blocks == nullptr)
    test_at({packet.key, 0, packet.depth, true}, local, packet, outcome);
  else
    test_each_at_its_own(packet, local, outcome);
  charge.write(outcome.counts);
}

void OrderedTraversal::test_at(const NextNode& node, const LocalRays& local, Packet& packet, TestOutcome& outcome) {
  const accel::RayMembers members = context_.members(local.slots);
  if (node.key.ref.is_inner()) {
    masks_.resize(local.size());
    entries_.resize(accel::kMaxWidth * local.size());
    accel::test_strip(context_.accel, node.key, packet.lanes, members, {masks_.data(), packet.nearest, entries_.data()},
                      outcome.counts);
    count_children(masks_, outcome);
  } else {
    masks_.assign(local.size(), 0);
    accel::test_strip(context_.accel, node.key, packet.lanes, members, {}, outcome.counts);
  }
  context_.any_hit.hold_back();
  for (std::size_t i = 0; i < local.size(); ++i) {
    const std::uint32_t slot = local.slots[i];
    const float* entry = entries_.data() + accel::kMaxWidth * i;
    last_first(order_, masks_[i], entry, [&](int lane) {
      stacks_.push(slot, {context_.accel.child_key(node.key, lane), entry[lane],
                          static_cast<std::uint16_t>(node.depth + 1), true});
    });
    const NextNode next = next_of(slot);
    packet.next[local.members[i]] = advance(slot, next);
    if (next.any) continue;
    stacks_.clear(slot);
    context_.completion.add_pending(slot, -1);
  }
}

NextNode OrderedTraversal::next_of(std::uint32_t slot) {
  const RayRecord& ray = context_.store.record(slot);
  if ((ray.tag.flags & kRayDone) != 0) return {};
  accel::NearestRay* const nearest = accel::nearest_of(ray);
  if (nearest == nullptr) return stacks_.pop(slot, ray.hit.t);
  nearest->visited();
  for (NextNode next; (next = stacks_.pop(slot, ray.hit.t)).any;)
    if (!nearest->set_aside({next.key, next.entry, next.depth})) return next;
  const std::optional<accel::WaitingNode> next = nearest->go_on();
  return next ? NextNode{next->key, next->entry, next->depth, true} : NextNode{};
}

NextNode OrderedTraversal::advance(std::uint32_t slot, NextNode next) {
  if (context_.blocks == nullptr) return next;
  at_[slot] = next.any ? next : root();
  if (next.any) next.key = context_.blocks->name(next.key);
  return next;
}

void OrderedTraversal::test_each_at_its_own(Packet& packet, const LocalRays& local, TestOutcome& outcome) {
  nodes_.clear();
  runs_.clear();
  for (const std::uint32_t slot : local.slots) nodes_.push_back(at_[slot]);
  by_node_.resize(local.size());
  std::iota(by_node_.begin(), by_node_.end(), 0u);
  const auto place = [&](std::uint32_t i) { return std::tuple(nodes_[i].depth, nodes_[i].key.bits()); };
  std::stable_sort(by_node_.begin(), by_node_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  for (std::size_t i = 0; i < by_node_.size();) {
    const NextNode node = nodes_[by_node_[i]];
    together_.slots.clear();
    together_.members.clear();
    for (; i < by_node_.size() && nodes_[by_node_[i]].key == node.key; ++i) {
      together_.slots.push_back(local.slots[by_node_[i]]);
      together_.members.push_back(local.members[by_node_[i]]);
    }
    const TestOutcome before = outcome;
    test_at(node, together_, packet, outcome);
    runs_.push_back(
        {node.depth,
         {1, together_.size(), outcome.counts.box - before.counts.box, outcome.counts.triangle - before.counts.triangle,
          outcome.children - before.children, outcome.misses - before.misses}});
  }
  outcome.nodes = nodes_;
  outcome.runs = runs_;
}

void OrderedTraversal::retire(const Packet& packet, CollectionStore& collections) {
  for (std::size_t i = 0; i < packet.members.size(); ++i) {
    const NextNode& next = packet.next[i];
    if (next.any) collections.add(next.key, next.depth, next.entry, {&packet.members[i].ray, 1});
  }
}

void OrderedTraversal::discard() {
  for (std::uint32_t slot = 0; slot < context_.store.slots(); ++slot) stacks_.clear(slot);
  std::fill(at_.begin(), at_.end(), root());
}

}  // namespace carousel::ringbus
