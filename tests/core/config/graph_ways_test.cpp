// Ways through a graph: shortest ones are tested against BookSim2 (tests/ringbus/topology/graph_test.cpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/graph/routes.h"
#include "core/config/write.h"
#include "tests/core/config/bad_config.h"

namespace carousel::graph_ways_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHead = "scene: {builtin: cornell}\nengine: {kind: cycle}\n";
const std::string kRing =
    "topology:\n  shape: graph\n  nodes: [{name: r, count: 5}]\n  links: [{ring: 'r[*]', both: true}]\n";

Config read(const std::string& topology) {
  return parse_config(kHead + topology, "test.yaml");
}

/// The nodes of a way.
std::vector<std::uint32_t> way(const Config& config, std::uint32_t from, std::uint32_t to) {
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  EXPECT_TRUE(issues.empty());
  std::vector<std::uint32_t> nodes{from};
  config::Routes(graph).for_each_link(from, to, [&](std::uint32_t link) { nodes.push_back(graph.links[link].to); });
  return nodes;
}

TEST(GraphWays, GivenOnesAreTakenAndTheRestIsShortest) {
  const Config config = read(kRing +
                             "  routes: given\n  ways:\n    - {along: 'r[0], r[4], r[3], r[2], r[1]'}\n"
                             "    - {at: 'r[3]', to: 'r[0]', next: 'r[2]'}\n");
  EXPECT_THAT(way(config, 0, 1), ElementsAre(0, 4, 3, 2, 1));
  EXPECT_THAT(way(config, 3, 1), ElementsAre(3, 2, 1));
  EXPECT_THAT(way(config, 1, 0), ElementsAre(1, 0));
  EXPECT_THAT(way(config, 3, 0), ElementsAre(3, 2, 1, 0));
}

TEST(GraphWays, UpDownGoesUpAndThenDown) {
  const Config config = read(kRing + "  routes: up_down\n");
  // Levels 0, 1, 2, 2, 1: a way never goes up from 3 to 2 after it has gone down to 3.
  EXPECT_THAT(way(config, 2, 3), ElementsAre(2, 3));
  EXPECT_THAT(way(config, 3, 2), ElementsAre(3, 2));
  EXPECT_THAT(way(config, 4, 2), ElementsAre(4, 0, 1, 2));
  EXPECT_THAT(way(config, 1, 3), ElementsAre(1, 2, 3));
  const Config other = read(kRing + "  routes: up_down\n  root: 'r[3]'\n");
  EXPECT_THAT(way(other, 4, 2), ElementsAre(4, 3, 2));
}

TEST(GraphWays, ReadBackAsTheyAreWritten) {
  const Config config = read(
      "topology:\n  shape: graph\n  nodes: [{name: r, count: 4, at: [1.5, -2], step: [0.5, 1], columns: 2, "
      "credit_cycles: 1}]\n  links: [{ring: 'r[*]', both: true}]\n  routes: given\n  tour: nearest\n  ways: "
      "[{along: 'r[0], r[1]'}, {at: 'r[0]', to: 'r[2]', next: 'r[3]'}]\n");
  const std::string text = resolved_yaml(config);
  const Config again = parse_config(text, "again.yaml");
  EXPECT_EQ(again.topology.nodes, config.topology.nodes) << text;
  EXPECT_EQ(again.topology.ways, config.topology.ways) << text;
  EXPECT_EQ(resolved_yaml(again), text);
}

TEST(GraphWays, NodesOfAGroupStandInRows) {
  std::vector<config::GraphIssue> issues;
  const Config config = read(
      "topology:\n  shape: graph\n  nodes: [{name: r, count: 5, at: [1, 2], step: [10, 20], columns: 3}]\n  links: "
      "[{ring: 'r[*]'}]\n");
  const config::Graph graph = config::draw_graph(config.topology, issues);
  EXPECT_EQ(graph.nodes[2].at, (GraphPoint{21, 2, true}));
  EXPECT_EQ(graph.nodes[4].at, (GraphPoint{11, 22, true}));
}

class BadWays : public testing::TestWithParam<BadConfig> {};

TEST_P(BadWays, AreRefusedByName) {
  EXPECT_THAT(texts(issues_of(kHead + kRing + GetParam().text)), ElementsAre(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadWays,
    testing::Values(
        BadConfig{"Circle",
                  "  routes: given\n  ways:\n    - {at: 'r[1]', to: 'r[3]', next: 'r[2]'}\n"
                  "    - {at: 'r[2]', to: 'r[3]', next: 'r[1]'}\n",
                  "never comes there: it goes round past r["},
        BadConfig{
            "NoLink", "  routes: given\n  ways: [{along: 'r[0], r[2]'}]\n",
            "test.yaml:8:18: topology.ways.0.along: expected nodes with a link between them, found r[0] and r[2]"},
        BadConfig{"Unknown", "  routes: given\n  ways: [{along: 'r[0], q[2]'}]\n",
                  "topology.ways.0.along: expected a node, found 'q'"},
        BadConfig{"Contradiction",
                  "  routes: given\n  ways: [{along: 'r[0], r[1], r[2]'}, {at: 'r[0]', to: 'r[2]', next: 'r[4]'}]\n",
                  "topology.ways.1.next: topology.ways.0 sends packets at r[0] for r[2] on to r[1]; expected the same, "
                  "found r[4]"},
        BadConfig{"Half", "  routes: given\n  ways: [{at: 'r[0]', to: 'r[2]'}]\n",
                  "topology.ways.0: expected along alone, or at, to and next"},
        BadConfig{"Root", "  routes: up_down\n  root: x\n", "test.yaml:8:9: topology.root: expected a node, found 'x'"},
        BadConfig{"TwoRoots", "  routes: up_down\n  root: 'r[*]'\n", "topology.root: expected one node, found r[*]"},
        BadConfig{"NoSuchRule", "  routes: shortes\n", "did you mean 'shortest'?"}),
    [](const auto& one) { return one.param.name; });

TEST(GraphWays, UpDownNamesTheWayThatIsMissing) {
  const auto issues =
      texts(issues_of(kHead + "topology: {shape: graph, routes: up_down, nodes: [{name: r, count: 4}], links: "
                              "[{ring: 'r[*]'}]}\n"));
  EXPECT_THAT(issues, ElementsAre(HasSubstr("topology.links: there is no way that goes up and then down from r[")));
}

TEST(GraphWays, NamesAreAskedForWhereThereAreNone) {
  config::NodeNames names;
  std::string error;
  EXPECT_TRUE(names.find("q", error).empty());
  EXPECT_EQ(error, "expected a node, found 'q'; no node has a name that can be read");
  EXPECT_TRUE(names.add("ring", 0, 3));
  EXPECT_TRUE(names.find("q", error).empty());
  EXPECT_EQ(error, "expected a node, found 'q'; known are ring");
}

}  // namespace
}  // namespace carousel::graph_ways_test
