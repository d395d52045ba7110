// Rings of rings (topology.shape: hierarchical) with synthetic traffic, against the closed form of its ways: groups are
// lines from a bridge through their resources and back, and the bridges are a ring.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/protocol/deadlock.h"
#include "tests/ringbus/traffic/created_packets.h"

namespace carousel::ringbus::hierarchical_test {
namespace {

/// Counted with nothing of the engine: places of resources in lines, and ways along these.
class RingsOfRings {
 public:
  RingsOfRings(std::uint32_t resources, std::uint32_t groups) : groups_(groups), sizes_(groups) {
    for (std::uint32_t r = 0; r < resources; ++r) {
      group_.push_back(r * groups / resources);
      place_.push_back(sizes_[group_.back()]++);
    }
  }

  /// The links of a way, each "from > to" by name.
  std::vector<std::string> links(std::uint32_t from, std::uint32_t to) const {
    std::vector<std::string> out;
    const std::uint32_t g = group_[from], h = group_[to];
    std::uint32_t at = place_[from];
    if (g == h && place_[to] >= at) {
      for (; at < place_[to]; ++at) out.push_back(fmt::format("{}.{}", g, at));
      return out;
    }
    for (; at < sizes_[g]; ++at) out.push_back(fmt::format("{}.{}", g, at));  // the last one leads to the bridge
    for (std::uint32_t bridge = g; bridge != h; bridge = (bridge + 1) % groups_)
      out.push_back(fmt::format("b{}", bridge));
    for (std::uint32_t i = 0; i <= place_[to]; ++i)
      out.push_back(i == 0 ? fmt::format("{}.in", h) : fmt::format("{}.{}", h, i - 1));
    return out;
  }
  std::uint32_t bridges(std::uint32_t from, std::uint32_t to) const {
    const std::uint32_t g = group_[from], h = group_[to];
    if (g == h) return place_[to] >= place_[from] ? 0 : 1;
    return (h + groups_ - g) % groups_ + 1;
  }

 private:
  std::uint32_t groups_;
  std::vector<std::uint32_t> group_, place_, sizes_;
};

Config network(std::uint32_t resources, std::uint32_t groups, const std::string& link, const std::string& keys) {
  return load_config({fmt::format("engine: {{kind: cycle}}\ntopology: {{shape: hierarchical, resources: {}, groups: "
                                  "{}, {}}}\nworkload: {{traffic: {{{}}}}}\n",
                                  resources, groups, link, keys),
                      "rings.yaml"})
      .config;
}

// A bridge stores a packet whole, so that each takes its length once more.
TEST(HierarchicalTraffic, TakesTheClosedFormAlone) {
  struct Case {
    std::uint32_t resources, groups, flits;
  };
  for (const Case& one : {Case{8, 2, 1}, Case{12, 4, 3}, Case{7, 3, 2}, Case{9, 1, 4}, Case{5, 5, 2}}) {
    SCOPED_TRACE(fmt::format("{} in {}, {} flits", one.resources, one.groups, one.flits));
    const Config config = network(one.resources, one.groups, "link: {latency_cycles: 3}",
                                  fmt::format("rate: 0.00002, packets: 600, packet_bytes: {}, inject_cycles: 2, "
                                              "eject_cycles: 4, warmup_fraction: 0",
                                              32 * one.flits));
    const TrafficResult result = run_traffic(config, {});
    const RingsOfRings rings(one.resources, one.groups);
    std::uint64_t sum = 0, crossed = 0;
    for (std::uint32_t from = 0; from < one.resources; ++from)
      for (const std::uint32_t to : created_by(config, from).to) {
        const std::uint64_t links = rings.links(from, to).size();
        sum += 2 + 3 * links + (1 + rings.bridges(from, to)) * (one.flits - 1) + 4;
        crossed += links;
      }
    EXPECT_EQ(result.delivered, 600u);
    EXPECT_EQ(result.flit_hops, crossed * one.flits);
    EXPECT_NEAR(result.zero_load_latency(config.workload.traffic), static_cast<double>(sum) / 600, 1e-9);
    EXPECT_NEAR(result.latency.mean(), static_cast<double>(sum) / 600, 0.001 * static_cast<double>(sum) / 600);
  }
}

// The link that most ways cross bounds what is accepted. The first packet of a queue holds up others, so that less is.
TEST(HierarchicalTraffic, SaturatesAtTheBoundOfItsBusiestLink) {
  for (const auto& [resources, groups] : {std::pair{8u, 2u}, std::pair{12u, 3u}}) {
    const Config config = network(resources, groups, "channels: dateline, link: {depth: 16, virtual_channels: 8}",
                                  "rate: 0.9, packets: 20000, packet_bytes: 32");
    ASSERT_FALSE(deadlock_verdict(config).can_deadlock) << deadlock_verdict(config).rule;
    const RingsOfRings rings(resources, groups);
    std::map<std::string, double> load;
    for (std::uint32_t from = 0; from < resources; ++from)
      for (std::uint32_t to = 0; to < resources; ++to)
        for (const std::string& link : rings.links(from, to)) load[link] += 1.0 / resources;
    double busiest = 0;
    for (const auto& [link, sum] : load) busiest = std::max(busiest, sum);
    const TrafficResult r = run_traffic(config, {});
    const double accepted =
        static_cast<double>(r.accepted) / (static_cast<double>(r.window_end - r.window_begin) * resources);
    fmt::print("{} in {}: {:.4f} accepted of {:.4f}\n", resources, groups, accepted, 1 / busiest);
    EXPECT_LE(accepted, 1.01 / busiest);
    EXPECT_GE(accepted, 0.5 / busiest);
  }
}

}  // namespace
}  // namespace carousel::ringbus::hierarchical_test
