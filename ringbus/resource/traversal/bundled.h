#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "accel/box/bundle_intersect.h"
#include "ringbus/resource/traversal/bundle_split.h"
#include "ringbus/resource/traversal/ejected_rays.h"
#include "ringbus/resource/traversal/traversal_method.h"
#include "ringbus/resource/visit/visit_context.h"

namespace carousel::ringbus {

/// `bundles` (US 11308683): a member of a packet may be a bundle of similar rays, which is tested as one where all of
/// its rays fare alike and left to its rays where they do not. Single rays go down as by another method.
///
/// A ray holds one count for each bundle that it is in, and a bundle one for each test that it waits for, so that a
/// bundle that stays together touches one record a visit instead of one a ray. An ID may become as many at one level as
/// a bundle has rays, and a packet's retirement may take that many blocks a child.
class BundledTraversal final : public TraversalMethod {
 public:
  /// `rays` takes single rays down.
  BundledTraversal(const BundlesConfig& config, float scene_size, const VisitContext& context,
                   std::unique_ptr<TraversalMethod> rays);

  std::int32_t tests_at(accel::NodeKey key) const override { return rays_->tests_at(key); }
  std::uint32_t lanes(std::uint32_t n) const override { return rays_->lanes(n); }
  std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const override {
    const std::uint32_t children = rays_->blocks_needed(key, rays);
    return (children + (returns_ && children > 0 ? 1 : 0)) * static_cast<std::uint32_t>(config_.size);
  }
  bool is_treelet(accel::NodeKey key) const override { return rays_->is_treelet(key); }
  void test(Packet& packet, LocalRays& local, TestOutcome& outcome) override;
  void retire(const Packet& packet, CollectionStore& collections) override;
  void discard() override;

 private:
  struct LocalBundle {
    std::uint32_t slot;
    std::uint32_t member;     // index into Packet::members
    std::int32_t change = 0;  // change of its pending count, made when the visit is over
  };

  void find_bundles(LocalRays& local);
  bool stay_bundled(const Packet& packet) const;

  // Where bundles are taken apart: each of their rays is tested as a single one.
  void take_apart(Packet& packet, LocalRays& local, TestOutcome& outcome);
  void end_taken_apart(TestOutcome& outcome);
  void update_range(std::uint32_t slot);

  // Leaves, and those that a node holds itself.
  bool tests_leaf(const Packet& packet) const;
  void test_leaf(Packet& packet, LocalRays& local, TestOutcome& outcome);
  std::uint32_t in_reach(accel::NodeRef leaf, const LocalBundle& local, accel::NodeKey key, IntersectionCounts& counts,
                         TestOutcome& outcome);
  std::uint32_t held_in_reach(std::uint32_t direct, const LocalBundle& local, accel::NodeKey key,
                              IntersectionCounts& counts, TestOutcome& outcome);

  // Where bundles go on.
  void test_bundles(Packet& packet, LocalRays& local, TestOutcome& outcome);
  void test_bundle(Packet& packet, LocalBundle& local, IntersectionCounts& counts, TestOutcome& outcome);
  static void divide_for_directions(IntersectionCounts& counts, TestOutcome& outcome);
  void add_passes(const accel::BundleAnswer& answer, BundlePasses& passes) const;
  void give_back(Packet& packet, LocalBundle& local, bool entered, TestOutcome& outcome);
  void eject_singles(Packet& packet, const LocalRays& local, TestOutcome& outcome);
  std::optional<accel::BundleRecord> bounds_in(std::uint32_t instance, std::span<const std::uint32_t> rays,
                                               IntersectionCounts& counts) const;
  void charge_transforms(std::span<const std::uint32_t> rays, accel::NodeKey key);
  void write_transforms(accel::NodeKey key, IntersectionCounts& counts, TestOutcome& outcome) const;
  void charge_reads(std::span<const std::uint32_t> rays, accel::NodeKey key, TestOutcome& outcome);
  void descend_into_instance(Packet& packet, std::span<const std::uint32_t> rays, const accel::BundleRecord& inside,
                             std::uint8_t mask);

  void add_pending(std::uint32_t slot, std::int32_t change, TestOutcome& outcome);
  void free_own_bundles();

  BundlesConfig config_;
  bool reformed_, returns_;
  const VisitContext context_;
  std::unique_ptr<TraversalMethod> rays_;
  BundleSplitRule split_;
  EjectedRays ejected_;
  std::vector<std::uint32_t> free_bundles_;  // slots of the owner's own; ray control hands out the others
  std::vector<LocalBundle> bundles_;         // bundles of this visit
  BundleCounts counts_;                      // likewise
  std::uint64_t transforms_ = 0;             // likewise: of the bundles' rays, by the engine's account
  // Scratch.
  std::vector<std::uint8_t> masks_;
  std::vector<RayId> again_;
};

}  // namespace carousel::ringbus
