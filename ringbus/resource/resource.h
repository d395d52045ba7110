#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "accel/structure/accel.h"
#include "core/types/workload.h"
#include "ringbus/packets/events.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/resource/collections/collection_store.h"
#include "ringbus/resource/homes.h"
#include "ringbus/resource/hooks.h"
#include "ringbus/resource/offering.h"
#include "ringbus/resource/settings.h"
#include "ringbus/resource/storage_rule.h"
#include "ringbus/resource/traversal/traversal_method.h"
#include "ringbus/resource/visit/any_hit_hold.h"
#include "ringbus/resource/visit/completion.h"
#include "ringbus/resource/visit/local_rays.h"
#include "ringbus/resource/visit/test_outcome.h"

namespace carousel::ringbus {

/// A compute resource without a clock: its slice of the rays, its testers and its share of the collections. An engine
/// decides when each call happens; one thread at a time.
class Resource {
 public:
  using Offer = ringbus::Offer;

  /// Keeps references to `accel` and `store`.
  Resource(const ResourceSettings& settings, const accel::Accel& accel, RayStore& store, const ResourceHooks& hooks);
  Resource(const Resource&) = delete;
  Resource& operator=(const Resource&) = delete;
  ~Resource();

  /// How many tests a new ray waits for at the root.
  static std::int32_t initial_tests(const ResourceSettings& settings, const accel::Accel& accel);

  ResourceId id() const { return store_.owner(); }
  /// True if one visit takes rays through the whole subtree below `key`.
  bool is_treelet(accel::NodeKey key) const { return traversal_->is_treelet(key); }

  /// How many rays may join the root's collection now, limited by collection storage.
  std::size_t admissible() const { return storage_.admissible(); }
  /// Lets rays that have been loaded, here or elsewhere, join the root's collection. Needs rays.size() <= admissible().
  void admit(std::span<const RayId> rays);
  /// Fills `packet` from the next collection: by policy, among the ready ones, or with `partial` among all.
  Offer offer(bool partial, Packet& packet) { return offering_.offer(partial, packet); }

  /// Spilled entries that have moved, with ResourceHooks::spills_take_time.
  SpillMoves& spills() { return collections_.spills(); }
  /// For engines with a clock: see CollectionStore.
  void ripen(std::uint64_t now) { collections_.ripen(now); }
  std::optional<std::uint64_t> next_ripe() { return collections_.next_ripe(); }

  /// Tests the packet's members that live here and writes the answers into it.
  TestOutcome test(Packet& packet);
  /// The slots of the rays that the last test() tested one by one.
  std::span<const std::uint32_t> tested() const { return local_.slots; }
  /// An any-hit call of the ray in `slot` has been answered: the ray may complete.
  void release(std::uint32_t slot) { completion_.add_pending(slot, -1); }
  /// Takes back a packet of its own: members that hit join the children's collections. Returns how many memberships
  /// that makes.
  std::size_t retire(Packet& packet);
  /// Takes back some members of a packet, `part`, as retire() does; the packet is not back yet and goes on without
  /// them.
  std::size_t retire_part(Packet& part);
  /// Takes the members of a membership packet that has reached its home.
  void join(Packet& packet);

  /// Completed rays and the slots they leave, for the engine to take away.
  HitBatch& completed() { return completion_.completed(); }
  std::vector<std::uint32_t>& freed_slots() { return completion_.freed_slots(); }

  /// Forgets all work: collections, packets under way, rays in slots, however far they are. Returns how many packets
  /// had been issued and were not back; they must not be retired any more.
  std::uint32_t discard();
  /// From now on `resource` is no home to collections. Before the first test, or after discard().
  void exclude(ResourceId resource) { homes_.exclude(resource); }

  bool idle() const { return collections_.empty() && !offering_.busy(); }
  const RayStore& rays() const { return store_; }
  const CollectionStore& collections() const { return collections_; }
  std::uint32_t packets_in_flight() const { return offering_.in_flight(); }

 private:
  std::size_t join_children(Packet& packet, EventKind kind);
  void record(const Event& event) {
    if (events_ != nullptr) [[unlikely]]
      events_->record(event);
  }

  std::uint64_t decoded_blocks(const Packet& packet, const TestOutcome& outcome) const;

  EventSink* events_;
  const accel::Accel& accel_;
  RayStore& store_;
  accel::NodeKey root_;
  std::size_t packet_rays_;
  CollectionStore collections_;
  Homes homes_;
  StorageRule storage_;
  Completion completion_;
  AnyHitHold any_hit_;
  std::unique_ptr<TraversalMethod> traversal_;
  Offering offering_;
  LocalRays local_;         // rays of the visit, kept so that nothing is allocated per packet
  std::vector<RayId> ids_;  // scratch
};

}  // namespace carousel::ringbus
