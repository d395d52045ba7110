// Bundles at the primitives of leaves (`bundles.leaf: primitives`; US 11308683, col. 29: a bundle may be tested against
// the primitives of a leaf instead of being split there).
#include <bit>

#include "accel/box/bundle_primitives.h"
#include "accel/traverse/kernels.h"
#include "ringbus/resource/traversal/bundled.h"

namespace carousel::ringbus {

/// True if bundles are tested against the primitives of the packet's node, a leaf.
bool BundledTraversal::tests_leaf(const Packet& packet) const {
  return config_.leaf == BundlesConfig::Leaf::kPrimitives && !packet.key.ref.is_inner() && !is_treelet(packet.key);
}

/// Tests each bundle against the primitives, and its rays against those that one of them may hit. A bundle that misses
/// all of them does not touch its rays' records.
void BundledTraversal::test_leaf(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  if (!local.empty()) rays_->test(packet, local, outcome);
  IntersectionCounts counts;
  transforms_ = 0;
  for (const LocalBundle& bundle : bundles_) {
    const std::span<const std::uint32_t> rays = context_.store.rays_of(bundle.slot);
    packet.members[bundle.member].mask = 0;
    const std::uint64_t leaf_tests = counts_.leaf_tests;
    const std::uint32_t met = in_reach(packet.key.ref, bundle, packet.key, counts, outcome);
    if (counts_.leaf_tests > leaf_tests) divide_for_directions(counts, outcome);
    if (met == 0) {
      ++counts_.visits;
      counts_.visit_rays += rays.size();
    } else {
      ++counts_.taken_apart;
      outcome.reads += static_cast<std::uint32_t>(rays.size());
      charge_transforms(rays, packet.key);
      accel::test_strip(context_.accel, packet.key, met, context_.members(rays), {}, counts);
      context_.any_hit.hold_back();
      local.slots.insert(local.slots.end(), rays.begin(), rays.end());
      local.members.resize(local.slots.size(), bundle.member);
      update_range(bundle.slot);
    }
  }
  write_transforms(packet.key, counts, outcome);
  for (const LocalBundle& bundle : bundles_) add_pending(bundle.slot, -1, outcome);
}

/// The primitives of `leaf` that the bundle's rays have to be tested against; `key` is the packet's node.
std::uint32_t BundledTraversal::in_reach(accel::NodeRef leaf, const LocalBundle& local, accel::NodeKey key,
                                         IntersectionCounts& counts, TestOutcome& outcome) {
  const std::uint32_t primitives = leaf.triangles(), all = (1u << primitives) - 1;
  const accel::BundleRecord& bundle = context_.store.bundle(local.slot);
  // The bounds of a bundle that has been split at its instance are of the world.
  if (split_.in_model_space(key) && (bundle.flags & accel::BundleRecord::kInModelSpace) == 0) return all;
  const std::uint32_t met = accel::primitives_in_reach(context_.accel, leaf, bundle);
  counts.bundle += primitives;
  outcome.bundle_passes.first += primitives;
  outcome.bundle_passes.at_once += primitives;
  const auto missed = static_cast<std::uint64_t>(std::popcount(all & ~met));
  counts_.leaf_tests += primitives;
  counts_.leaf_misses += missed;
  if (missed == 0) return met;
  for (const std::uint32_t slot : context_.store.rays_of(local.slot))
    if ((context_.store.record(slot).tag.flags & kRayDone) == 0) counts_.leaf_tests_spared += missed;
  return met;
}

/// As in_reach(), for the leaves that a node holds itself: the lanes of `direct` that a ray of the bundle may hit.
std::uint32_t BundledTraversal::held_in_reach(std::uint32_t direct, const LocalBundle& local, accel::NodeKey key,
                                              IntersectionCounts& counts, TestOutcome& outcome) {
  if (config_.leaf != BundlesConfig::Leaf::kPrimitives) return direct;
  const accel::Node& node = context_.accel.nodes[key.ref.node()];
  std::uint32_t met = 0;
  for (std::uint32_t left = direct; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    // Its primitives are tested together: one that is met keeps the others.
    const BundleCounts before = counts_;
    if (in_reach(context_.accel.held_leaf(node, lane), local, key, counts, outcome) == 0) continue;
    met |= 1u << lane;
    counts_.leaf_misses = before.leaf_misses;
    counts_.leaf_tests_spared = before.leaf_tests_spared;
  }
  return met;
}

}  // namespace carousel::ringbus
