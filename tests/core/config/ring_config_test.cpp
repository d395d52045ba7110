// Rings whose stops have no queues, the ends of synthetic traffic, and two clocks: what is read and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/graph/ring.h"
#include "core/config/write.h"
#include "tests/core/config/bad_config.h"

namespace carousel::ring_config_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHead = "engine: {kind: cycle}\n";
const std::string kTraffic = "workload: {traffic: {rate: 0.1}}\n";

/// A network of these links between three resources.
std::string three(const std::string& links) {
  return "topology:\n  shape: graph\n  nodes: [{name: r, count: 3}]\n  links:\n    - " + links + "\n";
}

TEST(RingConfig, RingsSideBySideAreLinksSideBySide) {
  const Config config =
      parse_config(kHead + kTraffic + three("{ring: 'r[*]', both: true, stops: {rule: slots, rings: 2}}"), "test.yaml");
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  ASSERT_TRUE(issues.empty());
  std::vector<std::string> names;
  for (const config::Graph::Link& link : graph.links) names.push_back(graph.name_of(link));
  EXPECT_THAT(names,
              ElementsAre("r[0] > r[1]", "r[0] > r[1]", "r[1] > r[0]", "r[1] > r[0]", "r[1] > r[2]", "r[1] > r[2]",
                          "r[2] > r[1]", "r[2] > r[1]", "r[2] > r[0]", "r[2] > r[0]", "r[0] > r[2]", "r[0] > r[2]"));
  const config::StopRing ring = config::stop_rings(config.topology, graph).front();
  EXPECT_THAT(ring.nodes, ElementsAre(0, 1, 2));
  EXPECT_EQ(graph.name_of(graph.links[ring.link(2, 1, 1)]), "r[0] > r[2]");
  EXPECT_EQ(parse_config(resolved_yaml(config), "again.yaml").topology.links, config.topology.links);
}

TEST(RingConfig, TheClockOfTheResourcesHasTwoNames) {
  const std::string machine = kTraffic + three("{line: 'r[*]', both: true}");
  EXPECT_EQ(parse_config("engine: {kind: cycle}\nclocks: {core: 1500, noc: 2000}\n" + machine, "a").engine.clock_mhz,
            1500);
  EXPECT_EQ(parse_config("engine: {kind: cycle, clock_mhz: 700}\n" + machine, "a").engine.clock_mhz, 700);
}

class BadRing : public testing::TestWithParam<BadConfig> {};

TEST_P(BadRing, IsRefusedByName) {
  EXPECT_THAT(texts(issues_of(kHead + GetParam().text)), ElementsAre(HasSubstr(GetParam().message)));
}

const std::string kSlots = "{ring: 'r[*]', stops: {rule: slots}";
const std::string kNoClock = kTraffic + three("{line: 'r[*]', both: true, clock: nocc}");
const std::string kNoSpeed = kTraffic + three("{line: 'r[*]', both: true, clock: noc}");
const std::string kUnusedClock = kTraffic + "clocks: {synchronizer_cycles: 3}\n" + three("{line: 'r[*]', both: true}");
const std::string kClockOfRing = kTraffic +
                                 "clocks: {slow: 500}\ntopology: {shape: graph, nodes: [{name: r, count: 3, clock: "
                                 "slow}], links: [{ring: 'r[*]', stops: {rule: slots}}]}\n";
const std::string kResourceClock =
    "scene: {builtin: cornell}\nclocks: {slow: 500}\ntopology: {shape: graph, nodes: "
    "[{name: r, count: 3, clock: slow}], links: [{ring: 'r[*]'}]}\n";
const std::string kCacheClock =
    "scene: {builtin: cornell}\nclocks: {slow: 500}\ntopology: {shape: graph, nodes: "
    "[{name: r, count: 3}, {name: c, kind: cache, clock: slow}], links: [{ring: 'r[*]'}, "
    "{from: 'r[*]', to: c, both: true, carries: [shapes]}]}\n";
const std::string kNoRing = kTraffic + three("{line: 'r[*]', both: true, stops: {rule: slots}}");
const std::string kDeep = kTraffic + three(kSlots + ", depth: 4}");
const std::string kChannels = kTraffic + three(kSlots + ", virtual_channels: 2}");
/// Two rings of three that meet at a router with these keys.
std::string meeting(const std::string& router, const std::string& rings, const std::string& more = "") {
  return kTraffic +
         "topology:\n  shape: graph\n  nodes: [{name: a, count: 2}, {name: b, count: 2}, {name: x, kind: " + "router" +
         router + "}]\n" + more + "  links:\n    - {ring: 'a[*], x', " + rings + "}\n    - {ring: 'b[*], x', " + rings +
         "}\n";
}
const std::string kFewPlaces = meeting(", buffers: 2", "stops: {rule: slots}");
const std::string kGrantedPlaces = meeting(", buffers: 8", "stops: {rule: grants}");
const std::string kLanes =
    "scene: {builtin: cornell}\n" + three("{ring: 'r[*]', lanes: 1, lane: 0, stops: {rule: slots}}");
const std::string kClasses = meeting("", "stops: {rule: slots}", "  channels: hops\n");
const std::string kManyChannels =
    meeting("", "stops: {rule: slots}", "  link: {virtual_channels: 2}\n") + "    - {from: 'a[0]', to: 'b[0]'}\n";
const std::string kMetAnswers =
    "workload: {traffic: {reply_bytes: 64}}\n" + meeting("", "stops: {rule: slots}").substr(kTraffic.size());
const std::string kFaults = "scene: {builtin: cornell}\nfaults: {links: {drop: 0.1}}\n" +
                            meeting("", "stops: {rule: slots}").substr(kTraffic.size());
const std::string kPart = kTraffic +
                          "topology: {shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[0..2]', stops: "
                          "{rule: slots}}]}\n";
const std::string kLate = kTraffic +
                          "topology: {shape: graph, nodes: [{name: r, count: 3, latency_cycles: 2}], links: [{ring: "
                          "'r[*]', stops: {rule: slots}}]}\n";
const std::string kPair = kTraffic +
                          "topology: {shape: graph, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]', stops: {rule: "
                          "slots}}]}\n";
const std::string kQueues = kTraffic + three("{line: 'r[*]', both: true, stops: {rings: 2}}");
const std::string kCommand = kTraffic + three("{ring: 'r[*]', stops: {rule: slots, command_cycles: 1}}");
const std::string kNames = "workload: {traffic: {sources: 'r[0]'}}\n";
const std::string kUnknown = "workload: {traffic: {destinations: 's[0]'}}\n" + three("{line: 'r[*]', both: true}");
const std::string kOdd = "workload: {traffic: {pattern: exchange}}\n" + three("{line: 'r[*]', both: true}");
const std::string kAnswer = "workload: {traffic: {reply_bytes: 64}}\n" + three("{line: 'r[*]', both: true}");
const std::string kRayClock = "scene: {builtin: cornell}\nclocks: {noc: 2000}\n";
const std::string kShapeClock = kTraffic + "topology: {flow: bubble}\nclocks: {noc: 2000}\n";

INSTANTIATE_TEST_SUITE_P(
    All, BadRing,
    testing::Values(
        BadConfig{"NoRing", kNoRing.c_str(), "topology.links.0.stops.rule: only a ring has such stops"},
        BadConfig{"Depth", kDeep.c_str(),
                  "topology.links.0.depth: a ring with rule: slots holds a flit for each cycle"},
        BadConfig{"Channels", kChannels.c_str(),
                  "topology.links.0.virtual_channels: a ring with rule: slots has no queues"},
        BadConfig{"FewPlaces", kFewPlaces.c_str(),
                  "topology.nodes.2.buffers: packets of all stops may have come to x in part, each in a place of its "
                  "own; expected 3 or more"},
        BadConfig{"Lanes", kLanes.c_str(), "topology.links.0.lane: a drawing with a ring of stops has no lanes yet"},
        BadConfig{"GrantedPlaces", kGrantedPlaces.c_str(), "topology.nodes.2.buffers: an arbiter knows no places of x"},
        BadConfig{"ChannelsOfClasses", kClasses.c_str(),
                  "topology.channels: a ring with stops has no virtual channels; expected any, found hops"},
        BadConfig{"ManyChannels", kManyChannels.c_str(),
                  "topology.link.virtual_channels: a drawing with a ring of stops has one channel a link yet"},
        BadConfig{"AnswersBetweenRings", kMetAnswers.c_str(),
                  "workload.traffic.reply_bytes: answers are modelled on a ring with stops that is alone"},
        BadConfig{"FaultsOfTwoRings", kFaults.c_str(), "faults.links: a ring with rule: slots has no faults yet"},
        BadConfig{"NotOnTheRing", kPart.c_str(), "topology.nodes.0: r[3] has no link"},
        BadConfig{"NodeLatency", kLate.c_str(), "topology.nodes.0.latency_cycles: nothing waits at a stop"},
        BadConfig{"TwoStops", kPair.c_str(), "expected three nodes at least, each of them once, found 2 nodes"},
        BadConfig{"RingsWithQueues", kQueues.c_str(),
                  "topology.links.0.stops.rings: stops with rule: queues do not have this key; expected rule: slots or "
                  "grants"},
        BadConfig{"CommandsWithSlots", kCommand.c_str(),
                  "topology.links.0.stops.command_cycles: stops with rule: slots do not have this key; expected rule: "
                  "grants"},
        BadConfig{"NamesOfAShape", kNames.c_str(), "workload.traffic.sources: only the nodes of a graph have names"},
        BadConfig{"UnknownDestination", kUnknown.c_str(),
                  "workload.traffic.destinations: expected a node, found 's'; known are r"},
        BadConfig{"OddExchange", kOdd.c_str(), "workload.traffic.pattern: exchange pairs the resources"},
        BadConfig{"AnswersWithQueues", kAnswer.c_str(),
                  "workload.traffic.reply_bytes: answers are modelled on a ring with stops"},
        BadConfig{"ClockOfRays", kRayClock.c_str(), "clocks.noc: only a graph has a clock of its own; expected 1000"},
        BadConfig{"UnknownClock", kNoClock.c_str(),
                  "topology.links.0.clock: expected a clock, one of core, noc; found 'nocc'; did you mean 'noc'?"},
        BadConfig{
            "ClockWithoutASpeed", kNoSpeed.c_str(),
            "test.yaml:7:41: topology.links.0.clock: there is no clocks.noc; expected it besides, or clock: core; "
            "found noc"},
        BadConfig{"UnusedClock", kUnusedClock.c_str(),
                  "clocks.synchronizer_cycles: no node or link goes by this clock; expected clock: synchronizer_cycles "
                  "at one of them; did you mean 'synchroniser_cycles'?"},
        BadConfig{"ClockOfAStop", kClockOfRing.c_str(),
                  "topology.nodes.0.clock: a stop goes by the clock of its ring; expected one of 1000 MHz"},
        BadConfig{"ClockOfAResource", kResourceClock.c_str(),
                  "topology.nodes.0.clock: a resource goes by the clock of the run"},
        BadConfig{
            "ClockOfACache", kCacheClock.c_str(),
            "topology.nodes.1.clock: a cache goes by the clock of the run, in whose cycles its parts are counted; "
            "expected core, or a router or memory, or workload: traffic; found slow"},
        BadConfig{"ClockOfAShape", kShapeClock.c_str(), "clocks.noc: only a graph has a clock of its own"}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(RingConfig, OneClockHasOneValue) {
  EXPECT_THAT(
      texts(issues_of("engine: {kind: cycle, clock_mhz: 900}\nclocks: {core: 800}\nscene: {builtin: cornell}\n")),
      ElementsAre(HasSubstr("test.yaml:2:16: clocks.core: the clock of the resources is engine.clock_mhz; "
                            "expected 900, or one of the two keys, found 800")));
}

}  // namespace
}  // namespace carousel::ring_config_test
