#pragma once

#include <vector>

#include "core/config/fields/collections.h"
#include "ringbus/resource/traversal/ray_stacks.h"
#include "ringbus/resource/traversal/traversal_method.h"
#include "ringbus/resource/visit/visit_context.h"

namespace carousel::ringbus {

/// `traversal: ordered`: a ray is in one collection at a time, that of the node that comes next: the nearest child that
/// it hits, or with `order: stored` the first one of its node. The other nodes wait on a short stack beside its record,
/// and its owner writes the next node into the packet.
///
/// With VisitContext::blocks the collection is that of the block of memory in which the next node stands. The owner
/// writes the block into the packet and keeps the node beside the record; a visit takes the rays that are at the same
/// node together, the nodes nearest to the root first.
///
/// A ray waits for one test until it has no node left. A packet's retirement may take a block for each of its rays.
class OrderedTraversal final : public TraversalMethod {
 public:
  OrderedTraversal(const VisitContext& context, ChildOrder order)
      : context_(context),
        order_(order),
        stacks_(context.store.slots(), context.accel.width, context.accel.max_depth),
        at_(context.blocks != nullptr ? context.store.slots() : 0, root()) {}

  std::int32_t tests_at(accel::NodeKey) const override { return 1; }
  std::uint32_t lanes(std::uint32_t) const override { return ~0u; }
  std::uint32_t blocks_needed(accel::NodeKey, std::uint32_t rays) const override { return rays; }
  void prepare(Packet& packet) const override { packet.next.assign(packet.members.size(), NextNode{}); }
  void test(Packet& packet, LocalRays& local, TestOutcome& outcome) override;
  void retire(const Packet& packet, CollectionStore& collections) override;
  void discard() override;

 private:
  NextNode root() const { return {context_.accel.root_key(), 0, 0, true}; }
  void test_at(const NextNode& node, const LocalRays& local, Packet& packet, TestOutcome& outcome);
  void test_each_at_its_own(Packet& packet, const LocalRays& local, TestOutcome& outcome);
  /// The node that the ray in `slot` visits after the one that it has been tested against.
  NextNode next_of(std::uint32_t slot);
  /// The ray in `slot` goes on to `next`; what its packet says of that.
  NextNode advance(std::uint32_t slot, NextNode next);

  const VisitContext context_;
  ChildOrder order_;
  RayStacks stacks_;
  std::vector<NextNode> at_;         // with blocks, one a slot: the node at which its ray is, or a new one will be
  std::vector<std::uint8_t> masks_;  // scratch: one a local ray
  std::vector<float> entries_;       // scratch: kMaxWidth a local ray
  // Scratch of a visit with blocks.
  std::vector<NextNode> nodes_;
  std::vector<std::uint32_t> by_node_;
  LocalRays together_;
  std::vector<NodeCountsAtDepth> runs_;
};

}  // namespace carousel::ringbus
