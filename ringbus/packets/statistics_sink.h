#pragma once

#include <array>
#include <vector>

#include "ringbus/packets/events.h"

namespace carousel::ringbus {

/// What one resource did, in counts.
struct ResourceStatistics {
  std::uint64_t rays_admitted = 0, rays_completed = 0;
  std::uint64_t packets_issued = 0, packet_rays = 0, packets_retired = 0;
  std::uint64_t hops = 0;                       ///< packets sent on
  std::uint64_t visits = 0, bubbles = 0;        ///< packets seen; those with no local ray
  std::uint64_t local_rays = 0, seen_rays = 0;  ///< members tested here; members of all packets seen
  std::uint64_t memberships = 0;                ///< ray IDs that joined collections at retirement
  std::array<std::uint64_t, 6> stalls{};        ///< by StallReason
  IntersectionCounts tests;
  std::uint64_t reads = 0;            ///< records of rays and bundles read for tests
  std::vector<BundleCounts> bundles;  ///< by depth in strips; empty without bundles
  CullCounts culls;

  ResourceStatistics& operator+=(const ResourceStatistics& o);
  friend bool operator==(const ResourceStatistics&, const ResourceStatistics&) = default;
};

/// The statistics sink: adds up events.
class StatisticsSink final : public EventSink {
 public:
  void record(const Event& event) override;
  CullCounts* cull_counts() override { return &statistics_.culls; }
  const ResourceStatistics& statistics() const { return statistics_; }

 private:
  ResourceStatistics statistics_;
};

}  // namespace carousel::ringbus
