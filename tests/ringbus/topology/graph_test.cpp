// Graphs against what BookSim2 and an independent program say of them (tests/data/booksim2_graphs.txt).
#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/system/error.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/protocol/deadlock.h"
#include "ringbus/topology/graph_facts.h"

namespace carousel::ringbus::graph_test {
namespace {

struct PublishedGraph {
  std::string name, busiest, circle;
  std::size_t nodes = 0, routers = 0;
  double mean_routers = 0, mean_latency = 0, bound = 0;
  std::uint64_t busiest_pairs = 0;
  std::string links;  // of the configuration
};

std::string node_name(std::size_t number, const PublishedGraph& graph) {
  return number < graph.nodes ? fmt::format("r[{}]", number) : fmt::format("x[{}]", number - graph.nodes);
}

std::vector<PublishedGraph> published() {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/tests/data/booksim2_graphs.txt");
  std::vector<PublishedGraph> graphs;
  for (std::string line, word; std::getline(file, line);) {
    std::istringstream in(line);
    in >> word;
    if (word == "graph") {
      PublishedGraph& g = graphs.emplace_back();
      in >> g.name >> g.nodes >> g.routers >> g.mean_routers >> g.mean_latency >> g.busiest >> g.busiest_pairs >>
          g.bound >> g.circle;
      continue;
    }
    std::size_t from = 0, to = 0, latency = 0;
    in >> from >> to >> latency;
    PublishedGraph& g = graphs.back();
    g.links += fmt::format("    - {{from: '{}', to: '{}', latency_cycles: {}, both: {}}}\n", node_name(from, g),
                           node_name(to, g), latency, word == "link");
  }
  return graphs;
}

/// BookSim2's routers. Without speculation a packet claims a channel a cycle before its head asks for the link; the
/// flits behind it ask at once.
struct Pipeline {
  std::int64_t node_cycles = 3, claim_cycles = 1, channels = 8, depth = 8;
};
constexpr Pipeline kSpeculative{2, 0, 1, 16};

/// One that takes so many cycles in a node, and 6 more to get in and out. `traffic`: its settings.
Config network(const PublishedGraph& graph, const std::string& traffic, const Pipeline& router = {}) {
  const auto [node_cycles, claim_cycles, channels, depth] = router;
  std::string text = fmt::format(
      "engine: {{kind: cycle}}\ntopology:\n  shape: graph\n  link: {{virtual_channels: {}, depth: {}}}\n  nodes:\n",
      channels, depth);
  const std::string keys =
      fmt::format("latency_cycles: {}, credit_cycles: 1, claim_cycles: {}", node_cycles, claim_cycles);
  text += fmt::format("    - {{name: r, count: {}, {}}}\n", graph.nodes, keys);
  if (graph.routers > 0) text += fmt::format("    - {{name: x, kind: router, count: {}, {}}}\n", graph.routers, keys);
  text += "  links:\n" + graph.links;
  text += fmt::format("workload: {{traffic: {{inject_cycles: {0}, eject_cycles: 3, {1}}}}}\n", node_cycles, traffic);
  return load_config({text, graph.name}).config;
}

TEST(Graph, WaysAreThoseOfBookSim2) {
  const std::vector<PublishedGraph> graphs = published();
  ASSERT_EQ(graphs.size(), 12u);
  for (const PublishedGraph& graph : graphs) {
    SCOPED_TRACE(graph.name);
    const TopologyConfig config = network(graph, "rate: 0.1").topology;
    const GraphFacts facts = graph_facts(config);
    EXPECT_EQ(facts.resources, graph.nodes);
    EXPECT_EQ(facts.routers, graph.routers);
    EXPECT_NEAR(facts.mean_nodes, graph.mean_routers, 5e-7);
    EXPECT_NEAR(facts.mean_cycles + 6, graph.mean_latency, 5e-7);
    const std::size_t between = graph.busiest.find('>');
    EXPECT_EQ(facts.busiest, node_name(std::stoul(graph.busiest), graph) + " > " +
                                 node_name(std::stoul(graph.busiest.substr(between + 1)), graph));
    EXPECT_EQ(facts.busiest_pairs, graph.busiest_pairs);
    EXPECT_NEAR(facts.bound, graph.bound, 5e-7);
    EXPECT_EQ(traffic_verdict(config).can_deadlock, graph.circle == "yes") << traffic_verdict(config).rule;
  }
}

TEST(Graph, APacketAloneTakesTheClosedForm) {
  for (const PublishedGraph& graph : published())
    for (const int flits : {1, 4}) {
      SCOPED_TRACE(fmt::format("{}, {} flits", graph.name, flits));
      const Config config = network(
          graph, fmt::format("rate: {}, packets: 6000, packet_bytes: {}", 0.0003 / flits, 32 * flits), {.channels = 1});
      const TrafficResult result = run_traffic(config, {});
      EXPECT_EQ(result.delivered, 6000u);
      // Of the packets drawn: 6, and for each link 3 and its latency, and the flits behind the first.
      EXPECT_NEAR(result.latency.mean() / result.zero_load_latency(config.workload.traffic), 1, 1e-3);
      EXPECT_GE(result.latency.mean(), result.zero_load_latency(config.workload.traffic));
      // They are drawn from all pairs.
      EXPECT_NEAR(result.zero_load_latency(config.workload.traffic) / (graph.mean_latency + flits - 1), 1, 0.02);
    }
}

struct LoadRow {
  const char* graph;
  int flits;
  double offered, accepted, latency;  // flits a node and cycle; latency 0: more is offered than gets through
  int seeds = 1;                      // whose mean is compared: three sources draw loads that differ by a per cent
};

// BookSim2 commit 28f4329; 15,000 cycles of warm-up and as many that are measured. What it accepted of a load that it
// keeps up with is what its sources drew. Ours draw others, so that there what is accepted is compared with what is
// offered.
void expect_load(const LoadRow& row, const Pipeline& router, double latency_within) {
  static const std::vector<PublishedGraph> graphs = published();
  SCOPED_TRACE(fmt::format("{} at {}, {} flits", row.graph, row.offered, row.flits));
  const auto graph = std::ranges::find(graphs, row.graph, &PublishedGraph::name);
  ASSERT_NE(graph, graphs.end());
  const double nodes = static_cast<double>(graph->nodes), flits = row.flits;
  const auto packets = static_cast<std::int64_t>(row.offered * nodes * 30000 / flits);
  Config config = network(*graph,
                          fmt::format("rate: {}, packets: {}, warmup_fraction: 0.5, packet_bytes: {}",
                                      row.offered / flits, packets, 32 * row.flits),
                          router);
  double accepted = 0, offered = 0, latency = 0;  // means
  for (int seed = 1; seed <= row.seeds; ++seed) {
    config.image.seed = seed;
    const TrafficResult result = run_traffic(config, {});
    const double all = static_cast<double>(result.window_end - result.window_begin) * nodes * row.seeds;
    accepted += static_cast<double>(result.accepted) * flits / all;
    offered += static_cast<double>(result.offered) * flits / all;
    latency += result.latency.mean() / row.seeds;
  }
  if (row.latency > 0) {
    EXPECT_NEAR(accepted / offered, 1, 0.01);
    EXPECT_NEAR(latency / row.latency, 1, latency_within);
  } else {
    EXPECT_NEAR(accepted / row.accepted, 1, 0.01);
  }
}

// One virtual channel of 16 flits, speculative switch allocation, which takes a cycle less in a node.
TEST(Graph, GetsAsMuchThroughAsBookSim2) {
  for (const LoadRow& row :
       {LoadRow{"tree15", 1, 0.1339, 0.134813, 18.6902}, LoadRow{"mesh4x4", 1, 0.2857, 0.286304, 13.0745},
        LoadRow{"random07", 1, 0.22, 0.218733, 14.0578}, LoadRow{"line3", 1, 0.9, 0.846511, 0},
        LoadRow{"tree15", 1, 0.2411, 0.228587, 0}, LoadRow{"mesh4x4", 1, 0.5714, 0.486146, 0},
        LoadRow{"random07", 1, 0.44, 0.376097, 0}})
    expect_load(row, kSpeculative, 0.01);
  // With one channel a packet has the way to the sink to itself, too: two that share it would both be late.
  const Pipeline of_four{kSpeculative.node_cycles, kSpeculative.claim_cycles, 1, 4};  // packets
  expect_load({"line3", 4, 0.2, 0.204711, 11.4602}, of_four, 0.01);
}

// Eight virtual channels of 8 flits.
TEST(Graph, GetsAsMuchThroughVirtualChannelsAsBookSim2) {
  for (const LoadRow& row :
       {LoadRow{"line3", 1, 0.5, 0.503489, 10.0472}, LoadRow{"ring8", 1, 0.4, 0.398692, 14.9946},
        LoadRow{"oneway_ring8", 1, 0.1429, 0.141042, 21.1775}, LoadRow{"two_rings_link", 1, 0.1667, 0.166011, 18.554},
        LoadRow{"line3", 1, 1.0, 0.909089, 0, 4}, LoadRow{"tree15", 1, 0.2411, 0.23212, 0}})
    expect_load(row, {}, 0.01);
  const Pipeline of_four{.depth = 2};  // packets
  // The flits behind a head have nothing to claim: if each waited as long as the head, these would be 0.7 to 3.7 % off.
  for (const LoadRow& row : {LoadRow{"line3", 4, 0.2, 0.204711, 13.7419}, LoadRow{"random03", 4, 0.2, 0.20257, 32.196},
                             LoadRow{"two_rings_link", 4, 0.5, 0.30458, 0}})
    expect_load(row, of_four, 0.01);
}

// BookSim2 with eight channels comes through the first load of each graph and stops under the second.
TEST(Graph, StopsUnderTheLoadsThatStopBookSim2) {
  const std::vector<PublishedGraph> graphs = published();
  const auto stops = [&](const char* name, double load) {
    const auto graph = std::ranges::find(graphs, name, &PublishedGraph::name);
    const auto packets = static_cast<std::int64_t>(load * static_cast<double>(graph->nodes) * 30000);
    const Config config = network(*graph, fmt::format("rate: {}, packets: {}", load, packets));
    try {
      EXPECT_EQ(run_traffic(config, {}).delivered, static_cast<std::uint64_t>(packets));
      return false;
    } catch (const SimulationError&) {
      return true;
    }
  };
  EXPECT_FALSE(stops("ring8", 0.56));
  EXPECT_TRUE(stops("ring8", 0.72));
  EXPECT_FALSE(stops("oneway_ring8", 0.2286));
  EXPECT_TRUE(stops("oneway_ring8", 0.5));
}

/// So many resources with these links, and what is said besides.
TopologyConfig drawn(int resources, const std::string& links, const std::string& keys) {
  return load_config({fmt::format("engine: {{kind: cycle}}\ntopology:\n  shape: graph\n{}  nodes: [{{name: r, count: "
                                  "{}}}]\n  links: [{}]\nworkload: {{traffic: {{rate: 0.9, packets: 4000}}}}\n",
                                  keys, resources, links),
                      "drawn.yaml"})
      .config.topology;
}

TEST(GraphVerdict, NamesTheRuleThatBreaksTheCircle) {
  using testing::HasSubstr;
  using testing::StartsWith;
  const auto safe = [](const std::string& keys, const std::string& rule) {
    const DeadlockVerdict verdict = traffic_verdict(drawn(6, "{ring: 'r[*]'}", keys));
    EXPECT_FALSE(verdict.can_deadlock) << verdict.rule;
    EXPECT_THAT(verdict.rule, HasSubstr(rule));
  };
  const auto unsafe = [](const std::string& keys, const std::string& why) {
    const DeadlockVerdict verdict = traffic_verdict(drawn(6, "{ring: 'r[*]'}", keys));
    EXPECT_TRUE(verdict.can_deadlock) << verdict.rule;
    EXPECT_THAT(verdict.rule, HasSubstr(why));
  };
  unsafe("", "a circle of 6 links wait for one another");
  unsafe("  link: {virtual_channels: 8}\n", "virtual channels under topology.channels: dateline would");
  safe("  link: {virtual_channels: 2}\n  channels: dateline\n", "datelines passed (r[0] > r[1])");
  unsafe("  channels: dateline\n", "need channels of 2 classes by datelines passed (r[0] > r[1]), and r[");
  safe("  link: {virtual_channels: 5}\n  channels: hops\n", "of the 5 classes none waits for one before it");
  unsafe("  link: {virtual_channels: 4}\n  channels: hops\n", "need channels of 5 classes by links passed");
  EXPECT_THAT(traffic_verdict(drawn(6, "{ring: 'r[*]', both: true}", "  routes: up_down\n")).rule,
              StartsWith("up_down: "));
}

TEST(GraphVerdict, ADatelineThatIsGivenIsTaken) {
  const std::string keys = "  link: {virtual_channels: 2}\n  channels: dateline\n";
  EXPECT_THAT(traffic_verdict(drawn(4, "{line: 'r[*]'}, {from: 'r[3]', to: 'r[0]', dateline: true}", keys)).rule,
              testing::HasSubstr("datelines passed (r[3] > r[0])"));
  // One that the circle does not have breaks it not.
  const DeadlockVerdict verdict = traffic_verdict(
      drawn(4, "{ring: 'r[0..2]'}, {from: 'r[0]', to: 'r[3]', dateline: true}, {from: 'r[3]', to: 'r[0]'}", keys));
  EXPECT_TRUE(verdict.can_deadlock);
  EXPECT_THAT(verdict.rule, testing::HasSubstr("no dateline breaks it"));
}

TEST(GraphVerdict, WithoutChannelsItIsThatOfFlow) {
  const auto verdict = [](const std::string& links, const std::string& keys) {
    return traffic_verdict(drawn(6, links, "  channels: none\n" + keys)).rule;
  };
  EXPECT_THAT(verdict("{ring: 'r[*]'}", "  flow: bubble\n"), testing::StartsWith("bubble: "));
  EXPECT_THAT(verdict("{ring: 'r[*]', lane: 0}, {ring: 'r[0], r[2], r[4], r[1], r[3], r[5]', lane: 1}", ""),
              testing::StartsWith("credits: "));
  EXPECT_THAT(verdict("{from: 'r[*]', all_to: 'r[*]'}", ""), testing::HasSubstr("always taken in"));
}

// Each packet takes the lane with the fewest links, or each of those by turns: 0, 1, 2, 3, 2 and 1 links to six others.
TEST(GraphFacts, PacketsThatKeepTheirLanesTakeTheShorterWay) {
  const TopologyConfig rings =
      drawn(6, "{ring: 'r[*]', lane: 0}, {ring: 'r[5..0]', lane: 1}", "  channels: none\n  flow: bubble\n");
  const GraphFacts facts = graph_facts(rings, true);
  EXPECT_DOUBLE_EQ(facts.mean_nodes, 1 + 9.0 / 6);
  EXPECT_DOUBLE_EQ(facts.mean_cycles, 4 * 9.0 / 6);
  EXPECT_EQ(facts.diameter, 3u);
  EXPECT_EQ(facts.longest_cycles, 12);
  EXPECT_DOUBLE_EQ(facts.bound, 36 / 6.0 / (36 * 1.5 / 12));  // 54 links of 36 packets, over 12
}

// Three rings in orders of their own. A packet alone takes the links of the shorter way, counted here.
TEST(Graph, APacketAloneKeepsToTheShortestLane) {
  const std::vector<std::vector<int>> orders{{0, 1, 2, 3, 4, 5, 6}, {0, 3, 6, 2, 5, 1, 4}, {6, 4, 2, 0, 5, 3, 1}};
  std::string links;
  std::vector<int> hops(7, 7);  // of resource r to r + 1
  for (std::size_t lane = 0; lane < orders.size(); ++lane) {
    std::string names;
    for (const int r : orders[lane]) names += fmt::format("{}r[{}]", names.empty() ? "" : ", ", r);
    links += fmt::format("{}{{ring: '{}', lane: {}}}", lane > 0 ? ", " : "", names, lane);
    for (int r = 0; r < 7; ++r) {
      const auto place = [&](int of) { return std::ranges::find(orders[lane], of) - orders[lane].begin(); };
      const auto ahead = static_cast<int>((place((r + 3) % 7) + 7 - place(r)) % 7);
      hops[static_cast<std::size_t>(r)] = std::min(hops[static_cast<std::size_t>(r)], ahead);
    }
  }
  Config config;
  config.engine.kind = EngineKind::kCycle;
  config.workload.kind = WorkloadConfig::Kind::kTraffic;
  config.topology = drawn(7, links, "  channels: none\n");
  config.workload.traffic.pattern = TrafficConfig::Pattern::kTornado;
  config.workload.traffic.rate = 0.0005;
  config.workload.traffic.packets = 7000;
  const TrafficResult result = run_traffic(config, {});
  double sum = 0;
  for (const int one : hops) sum += one;
  EXPECT_EQ(result.delivered, 7000u);
  EXPECT_NEAR(result.latency.mean(), 1 + 4 * sum / 7 + 1, 0.1);
  EXPECT_NEAR(result.latency.mean() / result.zero_load_latency(config.workload.traffic), 1, 1e-3);
}

TEST(GraphCuts, AreTheNarrowest) {
  const auto halves = [](const std::string& drawing) {
    return graph_facts(load_config({"engine: {kind: cycle}\ntopology: {shape: graph, " + drawing +
                                        "}\nworkload: {traffic: {rate: 0.1}}\n",
                                    "cut.yaml"})
                           .config.topology)
        .halves;
  };
  const Cut ring = halves("nodes: [{name: r, count: 8}], links: [{ring: 'r[*]'}]");
  EXPECT_EQ(ring.bytes_per_cycle, 64u);
  EXPECT_TRUE(ring.exact);
  const Cut mesh = halves("nodes: [{name: r, count: 16}], links: [{mesh: [4, 4]}]");
  EXPECT_EQ(mesh.bytes_per_cycle, 8 * 32u);
  // Two clusters, and routers between them by a narrow link.
  const Cut clusters = halves(
      "nodes: [{name: a, count: 6}, {name: b, count: 6}, {name: x, kind: router, count: 2}], links: [{from: 'a[*]', "
      "to: 'x[0]', both: true}, {from: 'b[*]', to: 'x[1]', both: true}, {from: 'x[0]', to: 'x[1]', both: true, "
      "bytes_per_cycle: 8}]");
  EXPECT_EQ(clusters.bytes_per_cycle, 16u);
  // As many cannot all be tried, and are found all the same.
  const Cut large = halves(
      "nodes: [{name: a, count: 30}, {name: b, count: 30}], links: [{ring: 'a[*]', both: true}, {ring: 'b[*]', both: "
      "true}, {from: 'a[7]', to: 'b[20]', both: true}]");
  EXPECT_EQ(large.bytes_per_cycle, 64u);
  EXPECT_FALSE(large.exact);
}

TEST(GraphCuts, WiresAreAsLongAsFromPlaceToPlace) {
  const GraphFacts facts = graph_facts(
      load_config({"engine: {kind: cycle}\ntopology:\n  shape: graph\n  nodes:\n    - {name: r, count: 4, at: [0, 0], "
                   "step: [2, 3], columns: 2}\n  links: [{ring: 'r[0], r[1], r[3], r[2]'}]\nworkload: {traffic: "
                   "{rate: 0.1}}\n",
                   "places.yaml"})
          .config.topology);
  ASSERT_TRUE(facts.wire_mm.has_value());
  EXPECT_DOUBLE_EQ(*facts.wire_mm, 2 + 3 + 2 + 3);
  EXPECT_DOUBLE_EQ(facts.wire_bit_mm, 10 * 8 * 32);
}

}  // namespace
}  // namespace carousel::ringbus::graph_test
