#include "ringbus/cycle/traffic/traffic_plan.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

TrafficPlan::TrafficPlan(const TrafficConfig& traffic, std::uint64_t seed, std::size_t resources,
                         const TrafficEnds& ends)
    : gap(traffic_gap(traffic)), packets(resources) {
  std::vector<TrafficSource> sources;
  for (const std::uint32_t r : ends.sources) {
    sources.emplace_back(traffic, seed, resources, ends, ResourceId(r), gap);
    sources.back().advance();
  }
  std::uint64_t left = static_cast<std::uint64_t>(traffic.packets);
  const auto count = [&](std::size_t i) {
    ++packets[ends.sources[i]];
    --left;
    sources[i].advance();
  };
  // A source creates a packet a cycle at most, so all may run for so long and at least the last packet is left, which
  // ends the window.
  Cycle at = 0;
  while (left > sources.size()) {
    at += (left - 1) / sources.size();
    for (std::size_t i = 0; i < sources.size(); ++i)
      while (sources[i].created() <= at) count(i);
  }
  while (left > 0) {
    const auto next =
        std::min_element(sources.begin(), sources.end(),
                         [](const TrafficSource& a, const TrafficSource& b) { return a.created() < b.created(); });
    window.end = next->created() + 1;
    count(static_cast<std::size_t>(next - sources.begin()));
  }
  window.begin = static_cast<Cycle>(static_cast<double>(window.end) * traffic.warmup_fraction);
}

}  // namespace carousel::ringbus::cycle
