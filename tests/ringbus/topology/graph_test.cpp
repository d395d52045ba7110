// Graphs against what BookSim2 and an independent program say of them (tests/data/booksim2_graphs.txt).
#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
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

/// One that takes 3 cycles in a node, and 6 more to get in and out, as BookSim2's routers. `traffic`: its settings.
Config network(const PublishedGraph& graph, const std::string& traffic, std::int64_t node_cycles = 3) {
  std::string text = "engine: {kind: cycle}\ntopology:\n  shape: graph\n  nodes:\n";
  text += fmt::format("    - {{name: r, count: {}, latency_cycles: {}}}\n", graph.nodes, node_cycles);
  if (graph.routers > 0)
    text += fmt::format("    - {{name: x, kind: router, count: {}, latency_cycles: {}}}\n", graph.routers, node_cycles);
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
      const Config config = network(graph, fmt::format("rate: 0.0003, packets: 6000, packet_bytes: {}", 32 * flits));
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
  double offered, accepted, latency;  // flits a node and cycle; latency 0: more is offered than gets through
};

// BookSim2 commit 28f4329, one virtual channel of 16 flits, speculative switch allocation, which takes a cycle less in
// a node; 15,000 cycles of warm-up and as many that are measured.
TEST(Graph, GetsAsMuchThroughAsBookSim2) {
  const std::vector<PublishedGraph> graphs = published();
  for (const LoadRow& row :
       {LoadRow{"tree15", 0.1339, 0.134813, 18.6902}, LoadRow{"mesh4x4", 0.2857, 0.286304, 13.0745},
        LoadRow{"random07", 0.22, 0.218733, 14.0578}, LoadRow{"line3", 0.9, 0.846511, 0},
        LoadRow{"tree15", 0.2411, 0.228587, 0}, LoadRow{"mesh4x4", 0.5714, 0.486146, 0},
        LoadRow{"random07", 0.44, 0.376097, 0}}) {
    SCOPED_TRACE(fmt::format("{} at {}", row.graph, row.offered));
    const auto graph = std::ranges::find(graphs, row.graph, &PublishedGraph::name);
    ASSERT_NE(graph, graphs.end());
    const auto packets = static_cast<std::int64_t>(row.offered * static_cast<double>(graph->nodes) * 30000);
    const Config config =
        network(*graph, fmt::format("rate: {}, packets: {}, warmup_fraction: 0.5", row.offered, packets), 2);
    const TrafficResult result = run_traffic(config, {});
    const double cycles = static_cast<double>(result.window_end - result.window_begin);
    EXPECT_NEAR(static_cast<double>(result.accepted) / cycles / static_cast<double>(graph->nodes) / row.accepted, 1,
                0.01);
    if (row.latency > 0) {
      EXPECT_NEAR(result.latency.mean() / row.latency, 1, 0.01);
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus::graph_test
