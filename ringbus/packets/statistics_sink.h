#pragma once

#include <vector>

#include "core/statistics/node_counts.h"
#include "core/statistics/resource_counts.h"
#include "ringbus/packets/events.h"

namespace carousel::ringbus {

/// Everything counted at one resource.
struct ResourceStatistics : ResourceCounts {
  StallCounts stalls;
  IntersectionCounts tests;
  std::vector<BundleCounts> bundles;  ///< by depth in strips; empty without bundles
  std::vector<NodeCounts> nodes;      ///< likewise; empty without packets
  CullCounts culls;

  ResourceStatistics& operator+=(const ResourceStatistics& o);
  friend bool operator==(const ResourceStatistics&, const ResourceStatistics&) = default;
};

/// Adds up the events of one resource.
class StatisticsSink final : public EventSink {
 public:
  void record(const Event& event) override;
  CullCounts* cull_counts() override { return &statistics_.culls; }
  const ResourceStatistics& statistics() const { return statistics_; }

 private:
  void add(const NodeCountsAtDepth& work);

  ResourceStatistics statistics_;
};

}  // namespace carousel::ringbus
