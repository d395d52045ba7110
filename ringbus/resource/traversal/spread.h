#pragma once

#include <vector>

#include "ringbus/resource/traversal/traversal_method.h"
#include "ringbus/resource/visit/visit_context.h"

namespace carousel::ringbus {

/// `traversal: spread` (US 9633468): a ray joins the collections of all children that it hits, at once.
///
/// A packet tests a whole strip, so a ray waits for one test a node: it adds one for each child that it hits and takes
/// one off for the test. A packet's retirement takes at most a block for each child of its node.
class SpreadTraversal : public TraversalMethod {
 public:
  explicit SpreadTraversal(const VisitContext& context) : context_(context) {}

  std::int32_t tests_at(accel::NodeKey) const override { return 1; }
  std::uint32_t lanes(std::uint32_t) const override { return ~0u; }
  std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const override;
  void test(Packet& packet, LocalRays& local, TestOutcome& outcome) final;
  void retire(const Packet& packet, CollectionStore& collections) final;

 protected:
  /// Collections that a ray joins which hits a child of `key`.
  virtual std::int32_t collections_below(accel::NodeKey /*key*/, int /*lane*/) const { return 1; }
  /// Writes the masks of children hit, one a local ray, into the packet and changes the rays' counts.
  virtual void answer(Packet& packet, const LocalRays& local, const std::vector<std::uint8_t>& masks);

  const VisitContext context_;

 private:
  std::vector<std::uint8_t> masks_;  // scratch
  std::vector<RayId> ids_;           // scratch
};

}  // namespace carousel::ringbus
