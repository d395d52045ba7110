// Graphs against what BookSim2 and an independent program say of them (tests/data/booksim2_graphs.txt).
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

}  // namespace
}  // namespace carousel::ringbus::graph_test
