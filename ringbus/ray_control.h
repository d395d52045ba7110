#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/config.h"
#include "core/ids.h"
#include "core/workload.h"

namespace carousel::ringbus {

/// A group of new rays on its way to a resource.
struct RayGroup {
  RayBatch rays;
  std::vector<ResourceId> addresses;   ///< addressed placement: one a ray; otherwise empty
};

/// Gives new rays a place: cuts batches into groups of one packet and hands each group to a resource, which
/// gives its rays slots (balanced, round_robin) or sends them round the ring for all to take their share
/// (first_taker, addressed). Any thread may call.
class RayControl {
 public:
  RayControl(const Config& config);

  /// Places a batch. The rays wait at their resource until it has slots for them.
  void submit(const RayBatch& rays);
  /// Takes the groups that wait at `resource`, oldest first, into `out` (appended).
  void collect(ResourceId resource, std::vector<RayGroup>& out);
  /// `resource` took `rays` new rays that travelled to it.
  void taken(ResourceId resource, std::size_t rays) { load(resource).fetch_add(static_cast<std::int64_t>(rays), std::memory_order_relaxed); }
  /// `resource` freed `rays` slots.
  void freed(ResourceId resource, std::size_t rays) { load(resource).fetch_sub(static_cast<std::int64_t>(rays), std::memory_order_relaxed); }

  bool rays_travel() const { return rays_travel_; }
  /// Whether a travelling ray bound for `address` (for anyone, when null) would probably find a slot.
  bool has_room(const ResourceId* address) const;
  /// Rays placed and not yet completed at `resource`.
  std::int64_t load_of(ResourceId resource) const { return inboxes_[resource.value].load.load(std::memory_order_relaxed); }

 private:
  struct alignas(128) Inbox {
    std::mutex mutex;
    std::vector<RayGroup> groups;
    // Relaxed throughout: an estimate that steers placement, it guards no data.
    std::atomic<std::int64_t> load{0};
    std::atomic<bool> any{false};
  };
  std::atomic<std::int64_t>& load(ResourceId r) { return inboxes_[r.value].load; }
  ResourceId choose();

  Placement placement_;
  bool rays_travel_;
  std::size_t group_rays_;
  std::int64_t slots_;
  std::atomic<std::uint32_t> turn_{0};
  std::uint32_t resources_;
  std::unique_ptr<Inbox[]> inboxes_;
};

}  // namespace carousel::ringbus
