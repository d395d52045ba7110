#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "accel/primitive/nearest_ray.h"
#include "accel/structure/accel.h"
#include "core/config/fields/rays.h"
#include "core/types/nearest_sink.h"
#include "core/types/workload.h"

namespace carousel::ringbus {

/// The buffers of hits beside the records of a resource's rays, one a slot (`rays.query.nearest`): arrays by slot, of
/// buffers and of the hits in them. As of the records, new rays are started by ray control, and then the owner's thread
/// alone calls.
class NearestRays {
 public:
  NearestRays(const QueryConfig& query, const accel::Accel& accel, std::uint32_t slots)
      : shared_{accel.root_key(),
                static_cast<std::uint32_t>(query.nearest),
                static_cast<std::uint32_t>(query.buffered()),
                query.rounds,
                leaves_out(query, accel),
                accel.gaussians.get(),
                static_cast<std::uint32_t>(query.response_steps),
                static_cast<std::uint32_t>(query.harmonic_steps)},
        sink_(accel.nearest_hits),
        buffers_(std::size_t{slots} * shared_.buffered),
        found_(query.in_rounds() && !accel.gaussians ? std::size_t{slots} * shared_.nearest : 0) {
    rays_.reserve(slots);
    for (std::size_t slot = 0; slot < slots; ++slot) {
      Hit* const buffer = buffers_.data() + slot * shared_.buffered;
      rays_.emplace_back(shared_, buffer, found_.empty() ? buffer : found_.data() + slot * shared_.nearest);
    }
  }
  NearestRays(const NearestRays&) = delete;
  NearestRays& operator=(const NearestRays&) = delete;

  /// The record in `slot` has been started. A ray that any hit ends has no buffer, nor one that reports all.
  void start(std::uint32_t slot, RayRecord& record) {
    if (!takes_any_hit(record.tag) && (record.tag.flags & kRayAll) == 0) rays_[slot].start(record);
  }
  /// The rays of these slots are being tested against a node or a leaf.
  void visited(const RayRecord* records, std::span<const std::uint32_t> slots) {
    for (const std::uint32_t slot : slots)
      if (accel::NearestRay* const ray = accel::nearest_of(records[slot])) ray->visited();
  }
  /// Appends the result of a ray that is complete, with its closest hit.
  void finish(RayRecord& record, HitBatch& out);

  /// The bytes of the hits that rays have found, besides the first of each, since the last call. They go the way of
  /// completed rays.
  std::uint64_t take_sent_bytes() { return std::exchange(shared_.sent_bytes, 0); }

  const NearestUse& use() const { return shared_.use; }
  /// Over all hits of completed rays: the same for every machine.
  const HitsDigest& digest() const { return shared_.digest; }

 private:
  /// Cull planes and elements that are no boxes have ends of their own.
  static bool leaves_out(const QueryConfig& query, const accel::Accel& accel) {
    const auto moved = [](const accel::InstanceNode& instance) { return !instance.transform.identity; };
    return query.in_rounds() && accel.gaussians == nullptr && query.rounds == QueryConfig::Rounds::kRestart &&
           accel.planes.empty() && accel.elements.empty() && accel.groups.empty() &&
           std::none_of(accel.instances.begin(), accel.instances.end(), moved);
  }

  accel::NearestShared shared_;
  NearestSink* sink_;                    // takes the hits of completed rays; null: nobody does
  std::vector<accel::NearestRay> rays_;  // by slot
  std::vector<Hit> buffers_;             // by slot: `buffered` each
  std::vector<Hit> found_;               // by slot: `nearest` each; empty where one round finds all, and with Gaussians
};

}  // namespace carousel::ringbus
