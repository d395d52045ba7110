#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/structure/accel.h"
#include "accel/traverse/kernels.h"
#include "core/statistics/bundle_counts.h"
#include "core/types/workload.h"
#include "ringbus/packets/events.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/bundle_builder.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/resource/collections/collection_store.h"
#include "ringbus/resource/hooks.h"
#include "ringbus/resource/ray_stacks.h"
#include "ringbus/resource/settings.h"
#include "ringbus/resource/test_outcome.h"

namespace carousel::ringbus {

/// Collection blocks that must stay free so that draining deepest first cannot run out (DESIGN.md section 4): a packet
/// retired at each level leaves at most width - 1 more blocks than it took, and one more strip's worth is in flight.
/// With bundles an ID may become as many at one level as a bundle has rays.
std::uint32_t reserve_blocks(const CollectionsConfig& collections, const BundlesConfig& bundles, int width,
                             int max_depth);

/// A compute resource without a clock: its slice of the rays, its testers and its share of the collections. An
/// engine decides when each call happens; one thread at a time.
class Resource {
 public:
  /// Keeps references to `accel` and `store`.
  Resource(const ResourceSettings& settings, const accel::Accel& accel, RayStore& store, const ResourceHooks& hooks);

  /// How many tests a new ray waits for at the root.
  static std::int32_t initial_tests(const ResourceSettings& settings, const accel::Accel& accel);

  ResourceId id() const { return store_.owner(); }
  /// Whether `key` is a subtree that is crossed in one visit.
  bool is_treelet(accel::NodeKey key) const { return is_treelet(settings_, accel_, key); }

  /// How many rays may join the root's collection now, limited by collection storage.
  std::size_t admissible() const;
  /// Lets rays that have been loaded, here or elsewhere, join the root's collection.
  /// Needs rays.size() <= admissible().
  void admit(std::span<const RayId> rays);

  enum class Offer { kNothing, kPacket, kStorage };
  /// Fills `packet` from the next collection: by policy, among the ready ones, or with `partial` among all.
  /// kStorage: there is one, but its children might not find room until packets in flight have been retired.
  Offer offer(bool partial, Packet& packet);

  /// Tests the packet's members that live here and writes the answers into it.
  TestOutcome test(Packet& packet);
  /// An any-hit call of the ray in `slot` has been answered: the ray may complete.
  void release(std::uint32_t slot) { add_pending(slot, -1); }
  /// Takes back a packet of its own: hits join the children's collections.
  void retire(Packet& packet);
  /// Takes the members of a membership packet that has reached its home.
  void join(Packet& packet);

  /// Completed rays and the slots they leave, for the engine to take away.
  HitBatch& completed() { return completed_; }
  std::vector<std::uint32_t>& freed_slots() { return freed_slots_; }

  /// Forgets all work: collections, packets under way, rays in slots, however far they are. Returns how many packets
  /// had been issued and not come home; they are not to be retired any more.
  std::uint32_t discard();
  /// From now on `resource` is no home to collections. Before the first test, or after discard().
  void exclude(ResourceId resource) { excluded_ = resource; }

  bool idle() const { return collections_.empty() && issuing_.rays.empty(); }
  const RayStore& rays() const { return store_; }
  const CollectionStore& collections() const { return collections_; }
  std::uint32_t packets_in_flight() const { return in_flight_; }

 private:
  /// In single-shape mode: the block whose shapes are being sent out, one a packet.
  struct Issuing {
    std::vector<RayId> rays;
    accel::NodeKey key;
    std::uint16_t depth = 0;
    float entry = 0;
    std::uint32_t next_shape = 0, shapes = 0;
  };

  static bool is_treelet(const ResourceSettings& settings, const accel::Accel& accel, accel::NodeKey key);
  /// Tests a ray waits for when it joins `key`: one a packet that will carry it there.
  static std::int32_t tests_of(const ResourceSettings& settings, const accel::Accel& accel, accel::NodeKey key,
                               int strip_size);
  ResourceId home_of(accel::NodeKey key) const;
  void free_own_bundles();
  std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const;
  bool fits(std::uint32_t needed, std::uint32_t freed) const;
  std::optional<CollectionId> choose(bool partial, bool& storage);
  void fill(Packet& packet, accel::NodeKey key, std::uint16_t depth, std::span<const RayId> rays, std::uint32_t lanes);

  void gather_local(const Packet& packet);
  IntersectionCounts transforms_of(accel::NodeKey key);
  void test_spread(Packet& packet);
  void test_ordered(Packet& packet);
  void find_bundles();
  bool bundles_go_on(const Packet& packet) const;
  bool moved(accel::NodeKey key) const;
  bool too_wide(const accel::BundleRecord& bundle, const accel::Node& node) const;
  void compute_bounds(std::span<const std::uint32_t> rays, std::uint32_t instance, accel::BundleRecord& bundle);
  void charge_reads(std::span<const std::uint32_t> rays, accel::NodeKey key);
  void expand_bundles(Packet& packet);
  void add_pending_expanded();
  void test_whole(Packet& packet);
  void regroup(Packet& packet);
  void descend_into_instance(Packet& packet, std::span<const std::uint32_t> rays, const accel::BundleRecord& inside,
                             std::uint8_t mask);
  void send_alone(Packet& packet, std::uint32_t slot, std::uint8_t mask);
  void add_pending_bundle(std::uint32_t slot, std::int32_t pending_change);
  void add_pending(std::uint32_t slot, std::int32_t pending_change);
  std::uint8_t* any_hit_counters();
  void hold_back(std::span<const std::uint32_t> slots);
  void complete(std::uint32_t slot);
  void retire_spread(Packet& packet);
  void retire_ordered(Packet& packet);
  void record(const Event& event) {
    if (hooks_.events != nullptr) [[unlikely]]
      hooks_.events->record(event);
  }

  ResourceSettings settings_;
  const accel::Accel& accel_;
  ResourceHooks hooks_;
  CullCounts* culls_;
  bool ordered_, single_, bounded_;
  std::uint32_t floor_blocks_;
  std::optional<ResourceId> excluded_;
  RayStore& store_;
  CollectionStore collections_;
  std::optional<RayStacks> stacks_;
  Issuing issuing_;
  std::uint32_t in_flight_ = 0, reserved_blocks_ = 0;
  std::uint32_t rays_held_ = 0;  // rays in its collections or in its packets
  HitBatch completed_;
  std::vector<std::uint32_t> freed_slots_;

  // With bundles (resource_bundles.cpp).
  std::optional<BundleBuilder> builder_;
  bool bundled_, reformed_, rebuilds_;
  float split_below_ = 0;                    // the surface area of a box at which bundles split
  std::vector<std::uint32_t> free_bundles_;  // of the owner's own
  struct LocalBundle {
    std::uint32_t slot, member;
  };
  struct EjectedRay {  // a ray that leaves its bundle for some of a node's children
    std::uint32_t slot;
    std::uint8_t mask;
  };
  std::vector<LocalBundle> local_bundles_;
  std::vector<EjectedRay> leaving_;
  std::vector<std::int32_t> bundle_changes_;  // of the local bundles' pending counts
  std::uint64_t bundle_transforms_ = 0;       // of their rays, in this visit
  RayBatch regrouped_;
  std::vector<std::uint32_t> order_, bundle_slots_;
  std::vector<std::uint8_t> sizes_;
  BundleCounts bundles_;

  // Scratch of the calls, kept so that nothing is allocated per packet.
  std::vector<std::uint32_t> local_slots_, local_members_;
  std::vector<std::uint8_t> masks_, any_hit_calls_;
  std::vector<AnyHitCall> any_hit_rays_;
  std::vector<float> entries_;
  std::vector<RayId> ids_;
  IntersectionCounts tests_;
  std::uint32_t reads_ = 0, bundle_passes_ = 0;
};

}  // namespace carousel::ringbus
