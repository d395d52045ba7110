#include "ringbus/packets/statistics_sink.h"

#include <algorithm>

#include "core/numeric/grow.h"

namespace carousel::ringbus {

ResourceStatistics& ResourceStatistics::operator+=(const ResourceStatistics& o) {
  ResourceCounts& counts = *this;
  counts += o;
  stalls += o.stalls;
  tests += o.tests;
  bundles.resize(std::max(bundles.size(), o.bundles.size()));
  for (std::size_t depth = 0; depth < o.bundles.size(); ++depth) bundles[depth] += o.bundles[depth];
  nodes.resize(std::max(nodes.size(), o.nodes.size()));
  for (std::size_t depth = 0; depth < o.nodes.size(); ++depth) nodes[depth] += o.nodes[depth];
  culls += o.culls;
  return *this;
}

void StatisticsSink::record(const Event& event) {
  ResourceStatistics& s = statistics_;
  switch (event.kind) {
    case EventKind::kAdmit:
      s.rays_admitted += event.rays;
      break;
    case EventKind::kIssue:
      ++s.packets_issued;
      s.packet_rays += event.rays;
      break;
    case EventKind::kTest:
      ++s.visits;
      s.bubbles += event.rays == 0;
      s.local_rays += event.rays;
      s.seen_rays += event.members.size();
      s.tests += *event.tests;
      s.reads += event.reads;
      for (const NodeCountsAtDepth& run : event.runs) add(run);
      if (event.runs.empty() && event.tested > 0)
        add({event.depth, {1, event.tested, event.tests->box, event.tests->triangle, event.children, event.misses}});
      if (event.bundles != nullptr) {
        if (s.bundles.size() <= event.depth) s.bundles.resize(event.depth + std::size_t{1});
        s.bundles[event.depth] += *event.bundles;
      }
      break;
    case EventKind::kHop:
      ++s.hops;
      break;
    case EventKind::kRetire:
      ++s.packets_retired;
      s.memberships += event.rays;
      break;
    case EventKind::kPart:
      s.memberships += event.rays;
      break;
    case EventKind::kComplete:
      s.rays_completed += event.rays;
      break;
    case EventKind::kStall:
      ++s.stalls[event.reason];
      break;
  }
}

void StatisticsSink::add(const NodeCountsAtDepth& work) {
  std::vector<NodeCounts>& nodes = statistics_.nodes;
  grow_to(nodes, work.depth + std::size_t{1});
  nodes[work.depth] += work.counts;
}

}  // namespace carousel::ringbus
