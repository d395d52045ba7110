#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/config/fields/bundles.h"
#include "core/config/fields/collections.h"
#include "core/config/fields/packets.h"
#include "core/config/fields/rays.h"
#include "core/types/ids.h"
#include "core/types/workload.h"
#include "ringbus/queues/pooled_queue.h"
#include "ringbus/rays/bundle_builder.h"
#include "ringbus/rays/placement_rule.h"
#include "ringbus/rays/rank_share.h"
#include "ringbus/rays/ray_group.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/rays/remote_placing.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// The parts of the configuration and of the machine that ray control follows.
struct RayControlSettings {
  Placement placement = Placement::kBalanced;
  bool local = false;              ///< a group's rays live where the group is issued
  std::size_t group_rays = 32;     ///< packets.rays
  std::int32_t initial_tests = 1;  ///< that a ray waits for at the root
  BundlesConfig bundles;
  float scene_size = 1;                     ///< scale of the distances between the origins of a bundle
  RankShare share{};                        ///< the part of the machine that this process plays
  std::vector<std::uint32_t> manager_of{};  ///< by resource, as the plan of the topology
  std::vector<ResourceId> own{};            ///< the resources whose rays it places, in order; empty: all
};

RayControlSettings ray_control_settings(const RaysConfig& rays, const CollectionsConfig& collections,
                                        const PacketsConfig& packets, const BundlesConfig& bundles,
                                        std::int32_t initial_tests, float scene_size);

/// Gives new rays slots and IDs, in slots that completed rays freed.
///
/// A group is as many rays as a packet carries. Its rays are spread over the resources, so that every packet finds work
/// everywhere, and its IDs go to one resource, which issues them from its root collection. With `home: local` and with
/// independent resources a whole group lives where it is issued. With bundles a group is as many bundles and single
/// rays as a packet carries IDs, and each bundle has one owner. With first_taker and addressed placement the rays
/// travel instead, and resources ask for slots as packets pass. With several ranks a rank's rays are issued by
/// resources of its own arc, and go to slots that it leases from all resources. Where packet processes serve resources,
/// a group goes to the one whose resources have most room, and its rays to these. With several pools of shader workers
/// each has one, for its own resources. Any thread may call.
class RayControl {
 public:
  /// `stores` by resource.
  RayControl(const RayControlSettings& settings, std::span<const std::unique_ptr<RayStore>> stores);

  /// Rays for resources of other ranks go to `remote`. Before the first submit(); needed with several ranks.
  void place_by(RemotePlacing& remote) { remote_ = &remote; }
  /// Groups go to each resource through a queue of this design with so many places. Needed where resources and those
  /// who submit are on several threads; before the first submit(). Threads that submit take turns, so that the queue
  /// has one producer at a time, but with several ranks it has as many as call deliver().
  void queue_groups(QueueKind kind, std::size_t places);
  /// Hands a group to its issuer, for RemotePlacing. False: its queue is full, and the group is as it was.
  bool deliver(ResourceId issuer, RayGroup& group);

  /// From now on `resource` gets no rays, and neither do the resources that it serves as a packet process. Returns the
  /// slots that are lost. To be called before the first submit(), or after discard().
  std::size_t exclude(ResourceId resource);
  /// Takes back all slots and forgets all rays. Needs that no ID is in use and no other thread calls.
  void discard();
  /// Places a batch, behind the rays that still wait for slots.
  void submit(const RayBatch& rays);
  /// Places waiting rays as far as slots allow. Returns true if it placed any.
  bool place_waiting();
  /// Moves the groups for `resource` to the end of `out`, oldest first.
  void collect(ResourceId resource, std::vector<RayGroup>& out);

  /// Puts a ray that has travelled to `resource` into a slot there; empty when none is free.
  std::optional<RayId> load(ResourceId resource, const RayRequest& request);
  /// Gives back the slots of completed rays and of dissolved bundles.
  void free(ResourceId resource, std::span<const std::uint32_t> slots);

  bool rays_travel() const { return rays_travel_; }
  /// An estimate while other threads run.
  // Relaxed: the slots themselves are taken under the lock.
  std::size_t free_slots(ResourceId resource) const {
    return slots_[resource.value].count.load(std::memory_order_relaxed);
  }
  std::size_t free_slots() const;
  /// The slots of `resource` that this rank hands out: all of them, or those that it leases.
  std::size_t slots(ResourceId resource) const {
    const auto [begin, end] = own_slots(resource);
    return end - begin;
  }
  /// The rank that has put the ray of a slot there, and shades it.
  std::uint32_t lessee(ResourceId resource, std::uint32_t slot) const {
    return local_ ? share_.rank_of(resource) : share_.lessee(slot, stores_[resource.value]->slots());
  }
  /// How many tests a new ray waits for.
  std::int32_t initial_tests() const { return initial_tests_; }
  /// How often rays had to wait because there were too few free slots.
  std::uint64_t slot_waits() const { return slot_waits_.load(std::memory_order_relaxed); }
  /// Rays that travel wait where they are sent from.
  void count_slot_wait() { slot_waits_.fetch_add(1, std::memory_order_relaxed); }
  /// The traffic of the queues to the resources, all together. Call it while no other thread calls.
  QueueUse groups_sent() const;
  /// How often a slot was handed out.
  std::uint64_t slots_used() const { return slots_used_.load(std::memory_order_relaxed); }

 private:
  struct alignas(128) SlotList {
    std::mutex mutex;
    std::vector<std::uint32_t> free;  // last freed, first used: its record is still in cache
    std::vector<std::uint32_t> free_bundles;
    std::atomic<std::size_t> count{0};
  };
  struct alignas(128) Inbox {
    std::vector<RayGroup> groups;  // without a queue
    std::unique_ptr<PooledQueue<RayGroup>> queue;
    RayGroup* next = nullptr;  // empty, for the next group
  };

  void free_all();
  std::pair<std::uint32_t, std::uint32_t> own_slots(ResourceId resource) const;
  std::uint32_t resources() const { return static_cast<std::uint32_t>(stores_.size()); }
  void lease_some(ResourceId resource, std::span<const RayRequest> rays, std::vector<RayId>& ids);
  std::size_t place(std::span<const RayRequest> rays);
  bool place_all_waiting();
  void submit_bundles(const RayBatch& rays);
  std::size_t place_bundles(std::span<const RayRequest> rays);
  std::size_t load_bundle(ResourceId resource, std::span<const RayRequest> rays, std::vector<RayId>& ids);
  std::size_t load_some(ResourceId resource, std::span<const RayRequest> rays, std::vector<RayId>& ids);
  std::size_t place_spread(std::span<const RayRequest> rays, const std::vector<ResourceId>& owners,
                           std::vector<RayId>& ids);
  bool may_send(ResourceId resource);
  void send(ResourceId resource, RayGroup&& group);
  ResourceId next_resource() {
    if (excluded_ == own_[turn_ % own_.size()]) ++turn_;
    return own_[turn_++ % own_.size()];
  }
  /// The next in turn among the resources that this rank plays.
  ResourceId next_issuer() {
    return share_.alone() ? next_resource() : ResourceId(share_.arc_begin() + turn_++ % share_.arc_size());
  }
  ResourceId emptiest() const { return emptiest(owners_.front()); }
  ResourceId emptiest(const std::vector<ResourceId>& of) const;
  std::size_t enough_slots() const;
  std::size_t free_slots(const std::vector<ResourceId>& of) const;
  /// The resources that rays of a group of `issuer` may go to.
  const std::vector<ResourceId>& owners(ResourceId issuer) const {
    return owners_.size() == 1 ? owners_.front() : owners_[issuer.value];
  }
  ResourceId emptiest_manager();
  ResourceId next_of(const std::vector<ResourceId>& owners) {
    return owners_.size() == 1 ? next_resource() : owners[turn_++ % owners.size()];
  }
  std::size_t place_by_rule(std::span<const RayRequest> rays, std::vector<RayId>& ids);
  ResourceId chosen(const RayRequest& ray);

  Placement placement_;
  const PlacementRule* rule_;  // a plugin's; null: one of the program
  bool rays_travel_, local_;
  RankShare share_;
  RemotePlacing* remote_ = nullptr;
  std::vector<ResourceId> own_;  // the resources whose rays it places
  std::size_t group_rays_, enough_slots_;
  std::int32_t initial_tests_;
  std::span<const std::unique_ptr<RayStore>> stores_;
  std::vector<std::vector<ResourceId>> owners_;  // of each one's groups; a single entry: of all
  std::vector<ResourceId> managers_;             // packet processes that serve resources
  std::unique_ptr<SlotList[]> slots_;
  std::unique_ptr<Inbox[]> inboxes_;
  std::atomic<std::uint64_t> slot_waits_{0}, slots_used_{0};

  ScheduleMutex waiting_mutex_;  // guards the members below
  RayBatch waiting_;             // oldest at waiting_head_
  std::size_t waiting_head_ = 0;
  std::optional<BundleBuilder> builder_;
  std::vector<std::uint8_t> waiting_bundles_;  // the number of rays of each bundle; 1 for a single ray
  std::size_t waiting_bundles_head_ = 0;
  std::vector<std::uint32_t> order_, members_;  // scratch
  std::vector<std::uint8_t> sizes_;             // scratch
  std::vector<std::size_t> free_now_;           // scratch
  std::uint32_t turn_ = 0;
  std::optional<ResourceId> excluded_;
  std::atomic<bool> any_waiting_{false};
};

}  // namespace carousel::ringbus
