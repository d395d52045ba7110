#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/statistics/ray_stage_counts.h"
#include "core/types/ids.h"
#include "core/types/workload.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/results/packet_history.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus {

/// The cycles of all rays of one kind and bounce.
struct RayTimeRow {
  RayKind kind = RayKind::kCamera;
  std::uint8_t bounce = 0;
  std::uint64_t rays = 0;
  RayStageCounts stages;
  friend bool operator==(const RayTimeRow&, const RayTimeRow&) = default;
};

/// What the rays of one pixel took, all its samples and bounces together.
struct PixelCost {
  std::uint64_t cycles = 0;   ///< from each ray's making until it had been shaded
  std::uint64_t tests = 0;    ///< strips that they were tested against
  std::uint64_t hops = 0;     ///< links that their packets crossed before they were tested
  std::uint64_t in_test = 0;  ///< cycles in RayStage::kTest
  std::uint64_t rays = 0;
  friend bool operator==(const PixelCost&, const PixelCost&) = default;
};

/// Sums by kind, bounce and stage that one agent adds to. Each stage has the times at which rays leave it less those at
/// which they enter it, by whatever agents, modulo 2^64. When all rays are done, the sums of all agents are right.
class RayTimeTable {
 public:
  using Row = std::array<std::uint64_t, kCounters<RayStageCounts>.size()>;

  static std::size_t index_of(const RayTag& tag) {
    return std::size_t{tag.bounce} * kRayKinds + static_cast<std::size_t>(tag.kind);
  }
  Row& of(const RayTag& tag) { return at(index_of(tag)); }
  Row& at(std::size_t index) {
    if (index >= rows_.size()) rows_.resize(index + 1);
    return rows_[index];
  }
  void enter(const RayTag& tag, RayStage stage, Cycle at) { of(tag)[static_cast<std::size_t>(stage)] -= at; }
  void leave(const RayTag& tag, RayStage stage, Cycle at) { of(tag)[static_cast<std::size_t>(stage)] += at; }
  void move(const RayTag& tag, RayStage from, RayStage to, Cycle at) {
    leave(tag, from, at);
    enter(tag, to, at);
  }
  const std::vector<Row>& rows() const { return rows_; }

 private:
  std::vector<Row> rows_;  // by bounce, then kind
};

/// The part of one resource in the ledger of all rays' time: that of its own rays in their slots.
///
/// A ray may wait in several collections at once. Each of its tests accounts for the cycles since the one before: by
/// the way of the packet in which it was tested, back to the time at which it joined that packet's collection, or to
/// the test before, if that was later. So each cycle is accounted for once, by what led to the ray's next test.
class ResourceTimes {
 public:
  ResourceTimes(std::uint32_t resource, std::uint32_t slots) : resource_(resource), slots_(slots) {}

  /// A ray has got `slot`.
  void placed(std::uint32_t slot, Cycle now) { slots_[slot] = {.since = now}; }
  /// The same of a ray that has found its slot by itself.
  void found(std::uint32_t slot, const RayTag& tag, Cycle now) {
    placed(slot, now);
    table_.leave(tag, RayStage::kSlot, now);
  }

  /// Members of a packet that live here have been tested. Its history ends with that, at `now` of tested(). end_visit()
  /// follows.
  void begin_visit(const PacketHistory& history);
  /// The same of a packet that others hear at the same time: its history, which they read, ends on the medium.
  /// `since`, `begun`: it took a context, and its tests began.
  void begin_heard_visit(const PacketHistory& history, Cycle since, Cycle begun, Cycle now);
  /// One of these members. `joined`: as in PacketMember. Returns its cycles in test since the test before.
  Cycle tested(std::uint32_t slot, const RayTag& tag, std::uint32_t joined, Cycle now);
  void end_visit() { add_whole(); }

  /// Without packets: the ray has been in `stage` since what was noted last. Its test, in the future as yet, may end at
  /// `until`.
  void spent(std::uint32_t slot, const RayTag& tag, RayStage stage, Cycle until) {
    Slot& ray = slots_[slot];
    table_.of(tag)[static_cast<std::size_t>(stage)] += until - ray.since;
    if (stage == RayStage::kTest) ray.in_test += until - ray.since, ++ray.tests;
    ray.since = until;
  }
  /// The visit took the ray through `strips` strips by itself. Of the `of` cycles that tested() has returned, it was
  /// `test` in test, and was done in the last `after`; in the others it waited for shapes.
  void walked(std::uint32_t slot, const RayTag& tag, std::uint32_t strips, Cycle of, Cycle test, Cycle after);
  /// The ray is handed over to shading.
  void done(std::uint32_t slot, const RayTag& tag, Cycle now) {
    spent(slot, tag, RayStage::kOpacity, now);
    table_.enter(tag, RayStage::kReturn, now);
  }

  struct Slot {
    Cycle since = 0;
    std::uint64_t in_test = 0;
    std::uint32_t tests = 0, hops = 0;
    bool under_way = false;  ///< it has joined a collection
  };
  const Slot& of(std::uint32_t slot) const { return slots_[slot]; }
  const RayTimeTable& table() const { return table_; }

 private:
  void add_whole();

  std::uint32_t resource_;
  std::vector<Slot> slots_;
  RayTimeTable table_;
  const PacketHistory* visited_ = nullptr;  // of the packet of the present visit
  PacketHistory heard_;                     // scratch
  // Its history, for rays that were tested last before it was issued: its cycles by stage, and the stages that have
  // any.
  RayTimeTable::Row whole_{};
  std::vector<std::uint8_t> stages_;
  // Such rays one after another, of one row, for which it has yet to be added.
  std::size_t whole_row_ = 0;
  std::uint64_t whole_rays_ = 0;
};

/// The ledger of all rays' time: a part for each resource, one for shading, and the histories of all packets.
class RayTimes {
 public:
  /// `heat`: one a pixel, or none; it must outlive the run.
  RayTimes(std::size_t resources, std::uint32_t slots, std::size_t packets, const Workload& workload,
           std::span<PixelCost> heat)
      : histories_(packets), workload_(workload), heat_(heat) {
    for (std::uint32_t r = 0; r < resources; ++r) resources_.emplace_back(r, slots);
  }

  ResourceTimes& of(ResourceId id) { return resources_[id.value]; }
  std::vector<PacketHistory>& histories() { return histories_; }

  // By shading alone.
  void placed(ResourceId resource, std::uint32_t slot, const RayTag& tag, Cycle now) {
    resources_[resource.value].placed(slot, now);
    table_.leave(tag, RayStage::kSlot, now);
  }
  void made(std::span<const RayRequest> rays, Cycle at) {
    for (const RayRequest& ray : rays) {
      table_.enter(ray.tag, RayStage::kSlot, at);
      if (PixelCost* pixel = pixel_of(ray.tag)) pixel->cycles -= at;
    }
  }
  void taken(ResourceId resource, const HitBatch& rays, std::span<const std::uint32_t> slots, Cycle now);
  void begin_shading(const RayTag& tag, Cycle now) { table_.move(tag, RayStage::kShadeQueue, RayStage::kShading, now); }
  void shaded(const HitBatch& rays, Cycle now);

  /// When all rays are done: by bounce, then kind.
  std::vector<RayTimeRow> rows() const;

 private:
  PixelCost* pixel_of(const RayTag& tag) const {
    if (heat_.empty()) return nullptr;
    const auto pixel = workload_.path_memory(tag).pixel;
    return pixel ? &heat_[*pixel] : nullptr;
  }

  std::deque<ResourceTimes> resources_;
  std::vector<PacketHistory> histories_;
  RayTimeTable table_;               // of shading
  std::vector<std::uint64_t> rays_;  // shaded, by bounce, then kind
  const Workload& workload_;
  std::span<PixelCost> heat_;
};

}  // namespace carousel::ringbus
