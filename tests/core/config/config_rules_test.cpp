// Configurations whose keys do not go together, one a rule, with message and position. Those of testers are in
// tester_rules_test.cpp, those of the tree and the ways through it in tree_rules_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/config/config_rule.h"

namespace carousel {
namespace {

TEST_P(ConfigRule, IsNamedWithPositionAndExpectation) {
  EXPECT_THAT(texts(issues_of(GetParam().text)), testing::ElementsAre(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Machines, ConfigRule,
    testing::Values(
        BadConfig{"NoScene", "image: {width: 4}\n",
                  "test.yaml: scene: expected a scene: file, or builtin (cornell, spheres, terrain, "
                  "instances, sliver, foliage, gaussians)"},
        BadConfig{"EmptyScene", "image: {width: 4}\nscene: {seed: 3}\n",
                  "test.yaml:2:8: scene: expected a scene: file, or builtin (cornell, spheres, terrain, "
                  "instances, sliver, foliage, gaussians)"},
        BadConfig{"TwoScenes", "scene: {file: a.glb, builtin: cornell}\n",
                  "test.yaml:1:31: scene.builtin: expected either file or builtin, found both; another scene takes the "
                  "place of both with --set 'scene={file: NAME}'"},
        BadConfig{"TravelWithoutPackets",
                  SCENE "engine: {kind: cycle}\nrays: {placement: addressed}\ntopology: {shape: independent}\n",
                  "test.yaml:3:19: rays.placement: independent resources have no packets in which rays could travel; "
                  "expected balanced or round_robin, found addressed"},
        BadConfig{
            "TravelWhenAResourceStops",
            SCENE "engine: {kind: cycle}\nrays: {placement: first_taker}\nfaults: {resource: {kind: stop}}\n",
            "test.yaml:3:19: rays.placement: the cycle engine does not place travelling rays anew when a resource "
            "has stopped; expected balanced or round_robin, found first_taker"},
        BadConfig{"AllWaysForRays", SCENE "memory: {ways: 4, l2_ray_ways: 4}\n",
                  "test.yaml:2:32: memory.l2_ray_ways: shapes need a way too; expected less than memory.ways = 4, "
                  "found 4"},
        BadConfig{"Shape", SCENE "topology: {shape: bus}\n",
                  "test.yaml:2:19: topology.shape: the native engine has no bus; expected ring, bidirectional, "
                  "point_to_point or graph"},
        BadConfig{"Carry", SCENE "packets: {carry: data}\n",
                  "test.yaml:2:18: packets.carry: the native engine has no packets that carry data; expected "
                  "reference, found data"},
        BadConfig{"Results", SCENE "packets: {results: message}\n",
                  "test.yaml:2:20: packets.results: the native engine has no wire on which results could travel "
                  "otherwise; expected mask, found message"},
        BadConfig{"ResultsWithoutPackets",
                  SCENE "engine: {kind: cycle}\npackets: {results: message}\ntopology: {shape: independent}\n",
                  "test.yaml:3:20: packets.results: topology.shape: independent has no packets that bring results; "
                  "expected mask, found message"},
        BadConfig{"ResultsOfAnOrderedStrip",
                  SCENE "engine: {kind: cycle}\npackets: {results: per_shape}\ncollections: {traversal: ordered}\n",
                  "test.yaml:3:20: packets.results: traversal: ordered has one result for a whole strip, the next "
                  "node; expected mask, message or implied_order, found per_shape"},
        BadConfig{"MulticastPastOwnCaches", SCENE "engine: {kind: cycle}\nmemory: {fetch: multicast, l1_kib: 4}\n",
                  "test.yaml:3:36: memory.l1_kib: a shared cache multicasts to shape buffers; expected 0, or "
                  "memory.fetch: resource; found 4"},
        BadConfig{"FetchByPacketsWithoutData", SCENE "engine: {kind: cycle}\nmemory: {fetch: packet}\n",
                  "test.yaml:3:17: memory.fetch: packets that carry a reference bring no shapes along; expected "
                  "resource, or packets.carry: data, whose bytes are charged on every hop; found packet"},
        BadConfig{"DataThatNobodyBrings", SCENE "engine: {kind: cycle}\npackets: {carry: data}\n",
                  "test.yaml: memory.fetch: a packet that carries its shapes' data gets them from its issuer; expected "
                  "packet, found resource"},
        BadConfig{"QueueOfTheCycleEngine", SCENE "engine: {kind: cycle}\ntopology: {link: {queue: mutex}}\n",
                  "test.yaml:3:26: topology.link.queue: the cycle engine has no real queues; expected spsc_ring, found "
                  "mutex"},
        BadConfig{"RingsWithoutResources",
                  SCENE "engine: {kind: cycle}\ntopology: {resources: 8, shape: multi_ring, rings: 64}\n",
                  "test.yaml:3:52: topology.rings: expected at most topology.resources = 8, found 64"},
        BadConfig{"GroupsWithoutResources",
                  SCENE "engine: {kind: cycle}\ntopology: {resources: 3, shape: hierarchical, groups: 5}\n",
                  "test.yaml:3:55: topology.groups: expected at most topology.resources = 3, found 5"},
        BadConfig{"SetLargerThanTheCache", SCENE "memory: {l2_kib: 1, line_bytes: 64, ways: 17}\n",
                  "test.yaml:2:43: memory.ways: a cache of 1 KiB has 16 lines of 64 bytes, and a set is no larger than "
                  "the cache; expected at most 16, found 17"},
        BadConfig{
            "PartOfASet", SCENE "memory: {l2_kib: 9, line_bytes: 128, ways: 8, l2_banks: 4}\n",
            "test.yaml:2:18: memory.l2_kib: a cache has whole sets, of 8 lines of 128 bytes, as many in each bank; "
            "expected a multiple of 4, found 9"},
        BadConfig{
            "PartOfASetOfAnOwnCache", SCENE "memory: {l1_kib: 3, line_bytes: 256, l1_ways: 8}\n",
            "test.yaml:2:18: memory.l1_kib: a cache has whole sets, of 8 lines of 256 bytes, as many in each bank; "
            "expected a multiple of 2, found 3"},
        BadConfig{
            "PartOfASector", SCENE "memory: {line_bytes: 64, l2_sector_bytes: 48}\n",
            "test.yaml:2:43: memory.l2_sector_bytes: a line has whole sectors; expected a divisor of 64, found 48"},
        BadConfig{"FaultyLinksOfIndependentResources",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: independent}\nfaults: {links: {drop: 0.1}}\n",
                  "test.yaml:4:17: faults.links: independent resources have no links; expected no faults of links, or "
                  "another topology.shape"},
        BadConfig{"FaultyLinksOfOneResource", SCENE "topology: {resources: 1}\nfaults: {links: {drop: 0.1}}\n",
                  "test.yaml:3:17: faults.links: one resource has no links; expected no faults of links, or more "
                  "topology.resources"},
        BadConfig{"FaultyLinksThatNoPacketCrosses", SCENE "collections: {home: local}\nfaults: {links: {drop: 0.1}}\n",
                  "test.yaml:3:17: faults.links: with collections.home: local no packet travels; expected no faults of "
                  "links, or another home"},
        BadConfig{"VerifiedTraffic", "engine: {kind: cycle}\nverify: reference\nworkload: {traffic: {rate: 0.1}}\n",
                  "test.yaml:2:9: verify: traffic has no hits to verify; expected none, found reference"},
        BadConfig{"EffectsOfAListOfRays", SCENE "verify: effects\nworkload: {rays_from: a.csv}\n",
                  "test.yaml:2:9: verify: a list of rays is not shaded, so effects change nothing; expected none or "
                  "reference, found effects"},
        BadConfig{"ProceduralTerrain", "scene: {builtin: terrain, procedural: true}\n",
                  "test.yaml:1:39: scene.procedural: only the built-in spheres are procedural primitives; expected "
                  "false, found true"},
        BadConfig{"EffectsList", SCENE "shading: {effects: [sky, shadow_ray]}\n",
                  "test.yaml:2:26: shading.effects.1: expected the name of an effect, found 'shadow_ray'; did you mean "
                  "'shadow_rays'?"},
        BadConfig{"IdleResourcesShade", SCENE "shading: {idle_resources_shade: true}\n",
                  "test.yaml:2:33: shading.idle_resources_shade: the native engine has no shading by idle resources; "
                  "expected false, found true"},
        BadConfig{"TrafficNative", "workload: {traffic: {rate: 0.5}}\nengine: {kind: native}\n",
                  "test.yaml:2:16: engine.kind: workload: traffic runs in virtual time; expected cycle, found native"},
        BadConfig{
            "TrafficRate", "engine: {kind: cycle}\nworkload: {traffic: {rate: 0}}\n",
            "test.yaml:2:28: workload.traffic.rate: expected a number above 0 to 1 (packets per resource and cycle), "
            "found 0"},
        BadConfig{"TrafficHotspot", "engine: {kind: cycle}\nworkload: {traffic: {pattern: hotspot, hotspot: 8}}\n",
                  "test.yaml:2:49: workload.traffic.hotspot: expected a resource from 0 to 7, found 8"},
        BadConfig{"TrafficBurst", "engine: {kind: cycle}\nworkload: {traffic: {pattern: bursty, rate: 0.9}}\n",
                  "test.yaml:2:45: workload.traffic.rate: bursts of 8 packets make at most 0.8889 packets per cycle, "
                  "found 0.9"},
        BadConfig{"TrafficWithoutLinks",
                  "engine: {kind: cycle}\ntopology: {shape: independent}\nworkload: {traffic: {rate: 0.5}}\n",
                  "test.yaml:2:19: topology.shape: there is no traffic on independent; expected ring, bidirectional, "
                  "multi_ring, hierarchical, point_to_point or graph"},
        BadConfig{"DirectWiresVisitingAll", SCENE "topology: {shape: point_to_point, visit: all}\n",
                  "test.yaml:2:42: topology.visit: point_to_point sends a packet straight to the owners of its rays, "
                  "and to visit all "
                  "would be a ring with idle wires; expected owners, or topology.shape: ring; found all"},
        BadConfig{"FlowNone", SCENE "topology: {flow: none}\n",
                  "test.yaml:2:18: topology.flow: none lets the links fill up and stop; expected credits or "
                  "bubble, or "
                  "--force"},
        BadConfig{"BubbleDepth", SCENE "topology: {flow: bubble, link: {depth: 1}}\n",
                  "test.yaml:2:40: topology.link.depth: flow: bubble keeps one place of a link free; "
                  "expected at least 2, "
                  "found 1"},
        BadConfig{"EyeAlone", SCENE "camera: {eye: [0, 0, 1]}\n",
                  "test.yaml:2:15: camera.eye: a camera of your own looks at a point; expected camera.target beside "
                  "camera.eye"},
        BadConfig{"TargetAlone", SCENE "camera: {target: [0, 0, 1]}\n",
                  "test.yaml:2:18: camera.target: a camera of your own has a place; expected camera.eye beside "
                  "camera.target"},
        BadConfig{"UpAlone", SCENE "camera: {up: [0, 0, 1]}\n",
                  "test.yaml:2:14: camera.up: only a camera of your own is turned; expected camera.eye and "
                  "camera.target beside camera.up"},
        BadConfig{"EyeIsTarget", SCENE "camera: {eye: [0, 0, 1], target: [0, 0, 1]}\n",
                  "test.yaml:2:34: camera.target: expected another point than camera.eye"},
        BadConfig{"UpAlongTheView", SCENE "camera: {eye: [0, 9, 0], target: [0, 2, 0]}\n",
                  "test.yaml:2:9: camera.up: the camera looks along this direction; expected one that is not parallel "
                  "to the view"},
        BadConfig{"UpOfNothing", SCENE "camera: {eye: [0, 9, 0], target: [0, 2, 0], up: [0, 0, 0]}\n",
                  "test.yaml:2:49: camera.up: expected a direction, found a vector of length 0"},
        BadConfig{"HashReserve", SCENE "collections: {home: hash}\n",
                  "test.yaml:2:14: collections.when_full: home: hash can fill one resource with another's "
                  "collections and "
                  "stop; expected spill, found reserve"},
        BadConfig{"OverrideOutside", SCENE "topology: {resources: 2, overrides: [{resource: 2}]}\n",
                  "test.yaml:2:49: topology.overrides.0.resource: expected a resource from 0 to 1, found 2"},
        BadConfig{"FaultOutside", SCENE "topology: {resources: 2}\nfaults: {resource: {kind: pause, number: 2}}\n",
                  "test.yaml:3:42: faults.resource.number: expected a resource from 0 to 1, found 2"},
        BadConfig{"StopAlone", SCENE "topology: {resources: 1}\nfaults: {resource: {kind: stop}}\n",
                  "test.yaml:2:23: topology.resources: when a resource stops, another has to continue; expected at "
                  "least 2, found 1"},
        BadConfig{"FaultsComparedOnTheWallClock", SCENE "faults: {compare: true, links: {drop: 0.1}}\n",
                  "test.yaml:2:19: faults.compare: on the wall clock two runs differ by more than faults cost; "
                  "expected false, or "
                  "engine.kind: cycle"},
        BadConfig{"OverrideTwice", SCENE "topology: {overrides: [{resource: 2}, {resource: 2}]}\n",
                  "test.yaml:2:50: topology.overrides.1.resource: resource 2 has an override already"},
        BadConfig{"VaryUnknown", SCENE "vary: {packets.ray: [1, 2]}\n",
                  "test.yaml:2:21: vary.packets.ray: unknown key 'packets.ray'; did you mean 'packets.rays'?"}),
    [](const auto& bad) { return bad.param.name; });

TEST(ConfigRules, FlowNoneIsPermittedByForce) {
  const auto config = parse_config(SCENE "topology: {flow: none}\n", "test.yaml", {}, {.force = true});
  EXPECT_EQ(config.topology.flow, Flow::kNone);
}

TEST(ConfigRules, OneResourceHasNoLinksWhateverTheShapeSays) {
  for (const char* shape : {"{resources: 1, shape: multi_ring}", "{resources: 1, shape: hierarchical}"})
    EXPECT_THAT(issues_of(SCENE "engine: {kind: cycle}\ntopology: " + std::string(shape) + "\n"), testing::IsEmpty());
}

TEST(ConfigRules, ASetMayBeTheWholeCache) {
  EXPECT_THAT(issues_of(SCENE "memory: {l2_kib: 1, line_bytes: 64, ways: 16}\n"), testing::IsEmpty());
}

TEST(ConfigRules, AFieldThatCannotBeReadIsNotJudgedByItsDefault) {
  EXPECT_THAT(texts(issues_of("scene: {builtin: 5}\n")),
              testing::ElementsAre("test.yaml:1:18: scene.builtin: expected one of cornell, spheres, terrain, "
                                   "instances, sliver, foliage, gaussians, found 5"));
}

}  // namespace
}  // namespace carousel
