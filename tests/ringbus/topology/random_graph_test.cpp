// Random graphs under as much synthetic traffic as gets in: what the verdict calls safe never stops, and what it calls
// unsafe can be made to stop.
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/system/error.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/topology/graph_facts.h"
#include "tests/ringbus/support/test_machine.h"
#include "tests/ringbus/topology/random_graphs.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus::graph_test {
namespace {

/// A rule for ways and channels, by turns.
constexpr std::array kRules{"routes: shortest", "routes: up_down", "channels: dateline", "channels: hops",
                            "routes: up_down, channels: dateline"};

Config machine(RandomGraph& graph, const std::string& rule, std::uint64_t channels, std::uint64_t depth,
               std::uint64_t flits, std::uint64_t seed) {
  const std::uint64_t packets = graph.nodes() * 60;
  return load_config({"engine: {kind: cycle}\nimage: {seed: " + std::to_string(seed) +
                          "}\ntopology:\n  shape: graph\n" +
                          fmt::format("  link: {{depth: {}, virtual_channels: {}}}\n", depth, channels) + "  " + rule +
                          "\n" + graph.text() +
                          fmt::format("workload: {{traffic: {{rate: 1, packets: {}, packet_bytes: {}, "
                                      "inject_cycles: 1, eject_cycles: 1}}}}\n",
                                      packets, 32 * flits),
                      "graph.yaml"})
      .config;
}

/// Runs the traffic. Returns whether it came to its end.
bool ends(const Config& config) {
  try {
    return run_traffic(config, {}).delivered == static_cast<std::uint64_t>(config.workload.traffic.packets);
  } catch (const SimulationError&) {
    return false;
  }
}

TEST(RandomGraphs, StopWhereTheVerdictSaysSo) {
  const std::uint64_t seed = std::uint64_t{run_seed()} * 1'000'003;
  const int cases = scaled(250, 50);
  int safe = 0, unsafe = 0, stopped = 0;
  for (int i = 0; i < cases; ++i) {
    RandomGraph graph(seed + static_cast<std::uint64_t>(i));
    std::string rule = kRules[static_cast<std::size_t>(i) % kRules.size()];
    if (const std::size_t comma = rule.find(", "); comma != std::string::npos) rule.replace(comma, 2, "\n  ");
    const bool classes = rule.find("channels") != std::string::npos;
    // Few channels, so that there are graphs whose ways need more.
    const std::uint64_t channels = classes ? 1 + graph.draw(rule.find("hops") != std::string::npos ? 8 : 3) : 1;
    const std::uint64_t flits = 1 + graph.draw(4), depth = 1 + graph.draw(3);
    const Config config = machine(graph, rule, channels, depth, flits, seed + static_cast<std::uint64_t>(i));
    SCOPED_TRACE(fmt::format("graph {}: {}, {} channels of {}, {} flits", seed + static_cast<std::uint64_t>(i), rule,
                             channels, depth, flits));
    const DeadlockVerdict verdict = traffic_verdict(config.topology);
    if (!verdict.can_deadlock) {
      ++safe;
      EXPECT_TRUE(ends(config)) << verdict.rule;
      continue;
    }
    ++unsafe;
    // With one place a channel; other packets each time.
    bool stops = false;
    for (std::uint64_t attempt = 0; attempt < 5 && !stops; ++attempt)
      stops = !ends(machine(graph, rule, channels, 1, flits, seed + attempt));
    stopped += stops ? 1 : 0;
  }
  std::printf("%d graphs: %d are called safe and came to their end, %d unsafe, of which %d were made to stop\n", cases,
              safe, unsafe, stopped);
  EXPECT_GT(safe, cases / 4);
  EXPECT_GT(unsafe, cases / 10);
  EXPECT_GT(stopped, unsafe / 2);
}

/// One to three rings through 3 to 12 resources, each in an order of its own and for the packets of a lane: `nodes` and
/// `links`.
std::string random_rings(RandomGraph& random) {
  const std::uint64_t resources = 3 + random.draw(10), lanes = 1 + random.draw(3);
  std::string text = fmt::format("  nodes: [{{name: r, count: {}}}]\n  links:\n", resources);
  for (std::uint64_t lane = 0; lane < lanes; ++lane) {
    std::vector<std::uint64_t> order;
    for (std::uint64_t r = 0; r < resources; ++r)
      order.insert(order.begin() + static_cast<std::ptrdiff_t>(random.draw(r + 1)), r);
    std::string names;
    for (const std::uint64_t r : order) names += fmt::format("{}r[{}]", names.empty() ? "" : ", ", r);
    text += fmt::format("    - {{ring: '{}', lane: {}}}\n", names, lane);
  }
  return text;
}

// Rings without virtual channels, which the rule of topology.flow keeps from filling up.
TEST(RandomGraphs, RingsOfLanesStopOnlyWithoutARule) {
  const std::uint64_t seed = std::uint64_t{run_seed()} * 1'000'003;
  int safe = 0, unsafe = 0, stopped = 0;
  for (int i = scaled(250, 50); i > 0; --i) {
    RandomGraph graph(seed + static_cast<std::uint64_t>(i));
    const std::array flows{"credits", "bubble", "none"};
    const std::string flow = flows[graph.draw(flows.size())], rings = random_rings(graph);
    const std::uint64_t depth = (flow == "bubble" ? 2 : 1) + graph.draw(3), bytes = 32 * (1 + graph.draw(4));
    const auto machine = [&](std::uint64_t draw) {
      return load_config(
                 {fmt::format("engine: {{kind: cycle}}\nimage: {{seed: {}}}\ntopology:\n  shape: graph\n  channels: "
                              "none\n  flow: {}\n  link: {{depth: {}}}\n{}workload: {{traffic: {{rate: 1, packets: "
                              "1500, packet_bytes: {}}}}}\n",
                              draw, flow, depth, rings, bytes),
                  "rings.yaml"},
                 {}, {.force = true})
          .config;
    };
    const Config config = machine(1);
    SCOPED_TRACE(fmt::format("{}, depth {}, {} bytes\n{}", flow, depth, bytes, rings));
    const DeadlockVerdict verdict = deadlock_verdict(config);
    EXPECT_EQ(verdict.can_deadlock, flow == "none") << verdict.rule;
    if (!verdict.can_deadlock) {
      ++safe;
      EXPECT_TRUE(ends(config)) << verdict.rule;
      continue;
    }
    ++unsafe;
    bool stops = false;  // where rings are many, ways are short, and few loads fill one
    for (std::uint64_t attempt = 1; attempt <= 5 && !stops; ++attempt) stops = !ends(machine(attempt));
    stopped += stops ? 1 : 0;
  }
  std::printf("Of rings of lanes: %d called safe came to their end; %d unsafe, of which %d were made to stop\n", safe,
              unsafe, stopped);
  EXPECT_GT(safe, unsafe);
  EXPECT_GT(stopped, unsafe / 4);
}

// The engine of rays, whose packets visit resources and come home. Where the rule of topology.flow is taken away, or
// routers have few places, circles may fill up.
TEST(RandomGraphs, RaysComeToTheirEndWhereTheVerdictSaysSo) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 200, 0), 60, 2);
  const std::uint64_t seed = std::uint64_t{run_seed()} * 1'000'003;
  int safe = 0, unsafe = 0, stopped = 0;
  for (int i = cell_count(24); i > 0; --i) {
    RandomGraph graph(seed + static_cast<std::uint64_t>(i));
    const auto pick = [&](std::initializer_list<const char*> of) { return *(of.begin() + graph.draw(of.size())); };
    std::string text =
        "scene: {builtin: terrain}\nengine: {kind: cycle}\nrays: {slots_per_resource: 16}\npackets: {rays: "
        "4}\ntopology:\n";
    const bool rings = i % 3 == 0;
    const std::string flow = pick({"credits", "bubble", "none"});
    text += fmt::format("  shape: graph\n  visit: {}\n  flow: {}\n  routes: {}\n  tour: {}\n", pick({"owners", "all"}),
                        flow, rings ? "shortest" : pick({"shortest", "up_down"}), pick({"names", "nearest"}));
    text += fmt::format("  link: {{depth: {}}}\n", (flow == "bubble" ? 2 : 1) + graph.draw(4));
    text += rings
                ? random_rings(graph)
                : graph.text(graph.draw(graph.nodes() / 2), pick({"", ", buffers: 1", ", buffers: 2, forward: whole"}));
    SCOPED_TRACE(text);
    const Config config = load_config({text, "graph.yaml"}, {}, {.force = true}).config;
    const DeadlockVerdict verdict = deadlock_verdict(config);
    const Outcome outcome = run_cell(scene, {.config = config});
    if (verdict.can_deadlock) {
      ++unsafe;
      stopped += outcome.fault.empty() ? 0 : 1;
    } else {
      ++safe;
      EXPECT_EQ(outcome.fault, "") << verdict.rule;
    }
  }
  std::printf("Of machines that trace rays: %d called safe came to their end; %d unsafe, of which %d stopped\n", safe,
              unsafe, stopped);
  EXPECT_GT(safe, 0);
}

}  // namespace
}  // namespace carousel::ringbus::graph_test
