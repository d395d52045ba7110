#include "ringbus/cycle/traffic/traffic_plan.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

TrafficPlan::TrafficPlan(const TrafficConfig& traffic, std::uint64_t seed, std::size_t resources)
    : gap(traffic_gap(traffic)), packets(resources) {
  std::vector<TrafficSource> sources;
  for (std::uint32_t r = 0; r < resources; ++r) {
    sources.emplace_back(traffic, seed, resources, ResourceId(r), gap);
    sources.back().advance();
  }
  std::uint64_t left = static_cast<std::uint64_t>(traffic.packets);
  const auto count = [&](std::size_t r) {
    ++packets[r];
    --left;
    sources[r].advance();
  };
  // A source creates a packet a cycle at most, so all may run for so long and at least the last packet is left, which
  // ends the window.
  for (Cycle at = 0; left > resources;) {
    at += (left - 1) / resources;
    for (std::size_t r = 0; r < resources; ++r)
      while (sources[r].created() <= at) count(r);
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
