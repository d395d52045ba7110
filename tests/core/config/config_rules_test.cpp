// Configurations whose keys do not go together, one a rule, with message and position.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/config/bad_config.h"

namespace carousel {
namespace {

class ConfigRule : public testing::TestWithParam<BadConfig> {};

TEST_P(ConfigRule, IsNamedWithPositionAndExpectation) {
  EXPECT_THAT(texts(issues_of(GetParam().text)), testing::ElementsAre(GetParam().message));
}

#define SCENE "scene: {builtin: cornell}\n"

INSTANTIATE_TEST_SUITE_P(
    Machines, ConfigRule,
    testing::Values(
        BadConfig{"NoScene", "image: {width: 4}\n",
                  "test.yaml: scene: expected a scene: file, or builtin (cornell, spheres, terrain, "
                  "instances, sliver)"},
        BadConfig{"EmptyScene", "image: {width: 4}\nscene: {seed: 3}\n",
                  "test.yaml:2:8: scene: expected a scene: file, or builtin (cornell, spheres, terrain, "
                  "instances, sliver)"},
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
        BadConfig{"DistributorUnit",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: central, form: distributor, resources: 2}\n",
                  "test.yaml:3:58: topology.resources: a central machine is one unit, with testers.distributor.testers "
                  "testers; expected 1, found 2"},
        BadConfig{"DistributorLanes",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: central, form: distributor, resources: 1}\n"
                        "testers: {simd: {lanes: 8}}\n",
                  "test.yaml:4:25: testers.simd.lanes: a tester tests one ray at a time; expected 1, found 8"},
        BadConfig{"DistributorBanks",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: central, form: distributor, resources: 1}\n"
                        "rays: {banks: 4}\n",
                  "test.yaml:4:15: rays.banks: each tester reads a record a cycle from its own ray memory; expected 0, "
                  "found 4"},
        BadConfig{"WarpsOfPackets", SCENE "engine: {kind: cycle}\ntesters: {simt: {warp: 32}}\n",
                  "test.yaml:3:24: testers.simt.warp: warps are of resources that trace their own rays, not those of "
                  "packets; expected 0, or topology.shape: independent; found 32"},
        BadConfig{"WarpsWithoutRays",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: independent}\nrays: {slots_per_resource: 16}\n"
                        "testers: {simt: {warp: 32}}\n",
                  "test.yaml:5:24: testers.simt.warp: no warp would ever be full; expected at most "
                  "rays.slots_per_resource = 16, found 32"},
        BadConfig{"HelpInPackedWarps",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: independent}\n"
                        "testers: {simt: {warp: 32, compaction: repack, idle_lanes: help}}\n",
                  "test.yaml:4:60: testers.simt.idle_lanes: no ray of a warp that is packed anew for each step has "
                  "ended; expected wait, or compaction: none; found help"},
        BadConfig{
            "LanesInWarps",
            SCENE "engine: {kind: cycle}\ntopology: {shape: independent}\n"
                  "testers: {simt: {warp: 32}, simd: {lanes: 4}}\n",
            "test.yaml:4:43: testers.simd.lanes: the lanes of a warp share units that test one ray each; expected "
            "1, and more units; found 4"},
        BadConfig{
            "FlagsInWarps",
            SCENE "engine: {kind: cycle}\ntopology: {shape: independent}\ntesters: {simt: {warp: 32}}\n"
                  "memory: {strip_end: flag}\n",
            "test.yaml:5:21: memory.strip_end: the lanes of a warp ask for lines, whose number they have to know; "
            "expected length, found flag"},
        BadConfig{"HelpersInWarps",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: independent}\ntesters: {simt: {warp: 32}}\n"
                        "shading: {idle_resources_shade: true}\n",
                  "test.yaml:5:33: shading.idle_resources_shade: resources with warps do not help the shader workers; "
                  "expected false, found true"},
        BadConfig{"CentralUnit", SCENE "engine: {kind: cycle}\ntopology: {shape: central, resources: 4}\n",
                  "test.yaml:3:39: topology.resources: a central machine is one unit, with testers.simd.lanes cells; "
                  "expected 1, found 4"},
        BadConfig{"CellsOfShapes",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: central, resources: 1}\n"
                        "testers: {simd: {lanes: 8, map: shapes}}\n",
                  "test.yaml:4:33: testers.simd.map: a test cell holds a ray; expected rays, found shapes"},
        BadConfig{"CellsOfTreelets",
                  SCENE "engine: {kind: cycle}\ntopology: {shape: central, resources: 1}\n"
                        "collections: {traversal: treelet}\n",
                  "test.yaml:4:26: collections.traversal: test cells test the rays of a collection side by side; "
                  "expected spread or ordered, found treelet"},
        BadConfig{"BanksAndAPort", SCENE "engine: {kind: cycle}\nrays: {banks: 4, reads_per_cycle: 2}\n",
                  "test.yaml:3:35: rays.reads_per_cycle: each bank has a port of its own; expected 0, or rays.banks: "
                  "0; found 2"},
        BadConfig{"BanksOfTreelets",
                  SCENE "engine: {kind: cycle}\nrays: {banks: 4}\ncollections: {traversal: treelet}\n",
                  "test.yaml:3:15: rays.banks: banks are modelled where the rays of a packet are read for one test: "
                  "not with independent, treelet or bundles; expected 0, found 4"},
        BadConfig{
            "InverseForTwoSteps", SCENE "accuracy: {instance_data: inverse}\nengine: {kind: cycle}\n",
            "test.yaml:2:27: accuracy.instance_data: transform: two_step subtracts the translation first; expected "
            "forward or rt, found inverse"},
        BadConfig{
            "TwoStepsForOneMatrix",
            SCENE "accuracy: {transform: inverse_matrix, instance_data: rt}\nengine: {kind: cycle}\n",
            "test.yaml:2:54: accuracy.instance_data: transform: inverse_matrix has the translation multiplied in; "
            "expected forward or inverse, found rt"},
        BadConfig{
            "ForwardInvertedAtBuild",
            SCENE "accuracy: {instance_data: forward, invert: build}\nengine: {kind: cycle}\n",
            "test.yaml:2:44: accuracy.invert: instance_data: forward stores nothing inverted; expected visit, found "
            "build"},
        BadConfig{"InverseInvertedAgain", SCENE "accuracy: {instance_data: rt, invert: visit}\nengine: {kind: cycle}\n",
                  "test.yaml:2:39: accuracy.invert: instance_data: rt is stored inverted; expected build, found visit"},
        BadConfig{"CellsThatMove", SCENE "bvh: {builder: octree, quality: high}\n",
                  "test.yaml:2:33: bvh.quality: the nodes of bvh.builder: octree stay where space is divided; expected "
                  "fast, or bvh.builder: sah or spatial; found high"},
        BadConfig{"MergedInParts",
                  "scene: {builtin: cornell, placement: partitioned}\nengine: {transport: mpi}\nbvh: {merge: "
                  "world}\ncollections: {home: hash, when_full: spill}\n",
                  "test.yaml:3:14: bvh.merge: merged meshes are not partitioned yet; expected none, found world, or "
                  "scene.placement: replicated"},
        BadConfig{"CullPlanes", SCENE "cull_planes: {count: 9}\n",
                  "test.yaml:2:22: cull_planes.count: expected an integer from 0 to 8 (planes per child), found 9"},
        BadConfig{"CullPlaneOrder", SCENE "cull_planes: {order: planes}\n",
                  "test.yaml:2:22: cull_planes.order: expected one of box_first, planes_first, found 'planes'"},
        BadConfig{
            "TopPlanesOfInverseMatrices",
            SCENE "cull_planes: {count: 2, levels: tlas}\naccuracy: {transform: inverse_matrix}\n",
            "test.yaml:3:23: accuracy.transform: cull planes above the instances could lose hits of inverse_matrix; "
            "expected two_step, two_step_double or transpose_if_rotation, or cull_planes.levels: blas"},
        BadConfig{"TopPlanesOfMergedMeshes", SCENE "cull_planes: {count: 2, levels: tlas}\nbvh: {merge: world}\n",
                  "test.yaml:2:33: cull_planes.levels: merged meshes hang in the top level, whose planes bound "
                  "instances; expected blas, or bvh.merge: none; found tlas"},
        BadConfig{"BundlesInGroups", SCENE "bundles: {size: 8}\nbvh: {levels: 3}\n",
                  "test.yaml:3:15: bvh.levels: bundles are not tested within groups of instances; expected 2, or "
                  "bundles.size: 0; found 3"},
        BadConfig{"SpheresInGroups", SCENE "bvh: {levels: 3, elements: spheres}\n",
                  "test.yaml:2:15: bvh.levels: spheres are not tested within groups of instances; expected 2, or "
                  "bvh.elements: boxes; found 3"},
        BadConfig{"OrientedBoxesOfFastTriangles", SCENE "bvh: {elements: oriented_boxes}\naccuracy: {triangle: fast}\n",
                  "test.yaml:3:22: accuracy.triangle: oriented boxes could lose hits of fast; expected watertight or "
                  "exact, or bvh.elements: boxes"},
        BadConfig{"OrientedBoxesWithPlanes", SCENE "cull_planes: {count: 2}\nbvh: {elements: oriented_boxes}\n",
                  "test.yaml:3:17: bvh.elements: cull planes need boxes to be tested with; expected boxes, or "
                  "cull_planes.count: 0; found oriented_boxes"},
        BadConfig{"SharedNormalsOfSpheres", SCENE "cull_planes: {count: 1, object: sphere, shared_normals: true}\n",
                  "test.yaml:2:57: cull_planes.shared_normals: a sphere has no normal; expected false, found true, or "
                  "cull_planes.object: planes"},
        BadConfig{"SpheresAroundInstances", SCENE "cull_planes: {count: 1, object: sphere, levels: all}\n",
                  "test.yaml:2:49: cull_planes.levels: spheres stand below the instances; expected blas, found all, or "
                  "cull_planes.object: planes"},
        BadConfig{"TopPlanesAboveGroups", SCENE "cull_planes: {count: 2, levels: all}\nbvh: {levels: 8}\n",
                  "test.yaml:3:15: bvh.levels: cull planes above the instances are not tested within groups of "
                  "instances; expected 2, or cull_planes.levels: blas; found 8"},
        BadConfig{"LevelsOfAnotherScene", "scene: {builtin: cornell, levels: 3}\n",
                  "test.yaml:1:35: scene.levels: only the built-in scene of instances has a depth to choose; expected "
                  "2, found 3"},
        BadConfig{"CullPlanesOfFastTriangles", SCENE "cull_planes: {count: 2}\naccuracy: {triangle: fast}\n",
                  "test.yaml:3:22: accuracy.triangle: cull planes could lose hits of fast; expected watertight or "
                  "exact, or cull_planes.count: 0"},
        BadConfig{"CullPlanesOfPlainBoxes", SCENE "cull_planes: {count: 2}\naccuracy: {box: plain}\n",
                  "test.yaml:3:17: accuracy.box: cull planes go with conservative boxes; expected conservative, found "
                  "plain, or cull_planes.count: 0"},
        BadConfig{"BundleOfOne", SCENE "bundles: {size: 1}\n",
                  "test.yaml:2:17: bundles.size: expected 2 rays or more, or 0 for none; found 1"},
        BadConfig{"BundlesLargerThanTheStore", SCENE "bundles: {size: 16}\nrays: {slots_per_resource: 8}\n",
                  "test.yaml:2:17: bundles.size: a bundle's rays live in one resource; expected at most "
                  "rays.slots_per_resource = 8, found 16"},
        BadConfig{"BundlesInOrder", SCENE "bundles: {size: 16}\ncollections: {traversal: ordered}\n",
                  "test.yaml:3:26: collections.traversal: rays of a bundle go several ways at once; expected spread or "
                  "treelet, found ordered, or bundles.size: 0"},
        BadConfig{"BundlesShapeByShape", SCENE "bundles: {size: 16}\npackets: {shapes: single}\n",
                  "test.yaml:3:19: packets.shapes: a bundle is tested against a whole strip; expected strip, found "
                  "single, or bundles.size: 0"},
        BadConfig{"BundlesLookForSlots", SCENE "bundles: {size: 16}\nrays: {placement: addressed}\n",
                  "test.yaml:3:19: rays.placement: bundles are made before their rays have slots; expected balanced or "
                  "round_robin, found addressed, or bundles.size: 0"},
        BadConfig{"BundlesOnIndependentResources",
                  SCENE "bundles: {size: 16}\ntopology: {shape: independent}\nengine: {kind: cycle}\n",
                  "test.yaml:3:19: topology.shape: independent resources trace single rays; expected a ring or another "
                  "network, found independent, or bundles.size: 0"},
        BadConfig{"BundlesStrictlyAnyHit", SCENE "bundles: {size: 16, order: any_hit_only, strict: true}\n",
                  "test.yaml:2:50: bundles.strict: any_hit_only takes bundles along where only some of their rays hit; "
                  "expected false, found true"},
        BadConfig{"BundleSimilarity", SCENE "bundles: {builder: {similarity: originbox}}\n",
                  "test.yaml:2:33: bundles.builder.similarity: expected one of growth, solid_angle, component_range, "
                  "origin_box, found 'originbox'; did you mean 'origin_box'?"},
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
        BadConfig{"AnyHit", SCENE "testers: {any_hit: shader}\n",
                  "test.yaml:2:20: testers.any_hit: the native engine has no any-hit calls by shader workers; expected "
                  "inline, found shader"},
        BadConfig{"AnyHitOfOneResource",
                  SCENE "engine: {kind: cycle}\ntopology: {overrides: [{resource: 1, testers: {any_hit: shader}}]}\n",
                  "test.yaml:3:57: topology.overrides.0.testers.any_hit: all resources have the same any-hit calls; "
                  "expected inline, found shader"},
        BadConfig{"Lanes", SCENE "testers: {simd: {lanes: 65}}\n",
                  "test.yaml:2:25: testers.simd.lanes: expected an integer from 1 to 64 (lanes), found 65"},
        BadConfig{"LanesOfOneResource", SCENE "topology: {overrides: [{resource: 1, testers: {simd: {lanes: 0}}}]}\n",
                  "test.yaml:2:62: topology.overrides.0.testers.simd.lanes: expected an integer from 1 to 64 (lanes), "
                  "found 0"},
        BadConfig{"WindowOfOneResource", SCENE "topology: {overrides: [{resource: 1, testers: {window: 4}}]}\n",
                  "test.yaml:2:56: topology.overrides.0.testers.window: the native engine has no choice among packets "
                  "that have "
                  "arrived; expected 1, found 4"},
        BadConfig{"WindowWithoutQueues",
                  SCENE "engine: {kind: cycle}\ntesters: {window: 4}\ntopology: {shape: independent}\n",
                  "test.yaml:3:19: testers.window: topology.shape: independent has no input queues; expected 1, found "
                  "4"},
        BadConfig{"OwnRaysOfOneResource", SCENE "topology: {overrides: [{resource: 1, testers: {own_rays: after}}]}\n",
                  "test.yaml:2:58: topology.overrides.0.testers.own_rays: all resources test their own rays at the "
                  "same time; expected before, found after"},
        BadConfig{
            "OwnRaysWithoutPackets",
            SCENE "engine: {kind: cycle}\ntopology: {shape: independent}\ntesters: {own_rays: after}\n",
            "test.yaml:4:21: testers.own_rays: topology.shape: independent has no packets that come back; expected "
            "before, found after"},
        BadConfig{"OwnRaysOfAMulticast",
                  SCENE "engine: {kind: cycle}\nmemory: {fetch: multicast}\ntesters: {own_rays: after}\n",
                  "test.yaml:4:21: testers.own_rays: an issuer multicasts the shapes that it fetches before its packet "
                  "leaves, for its own rays; expected before, or memory.fetch: resource; found after"},
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
        BadConfig{"OrderedSingle", SCENE "collections: {traversal: ordered}\npackets: {shapes: single}\n",
                  "test.yaml:3:19: packets.shapes: traversal: ordered sorts the hits of a whole strip; "
                  "expected strip, "
                  "found single"},
        BadConfig{
            "OrderOfSpread", SCENE "collections: {order: stored}\n",
            "test.yaml:2:22: collections.order: traversal: spread takes a ray into all children at once; expected "
            "nearest, or traversal: ordered or treelet, found stored"},
        BadConfig{"OrderOfNativeTreelets", SCENE "collections: {traversal: treelet, order: stored}\n",
                  "test.yaml:2:42: collections.order: the native engine takes a ray through a treelet nearest first; "
                  "expected nearest, or engine.kind: cycle, found stored"},
        BadConfig{"TreeletsOfTestCells",
                  SCENE "bvh: {treelets: {bytes: 4096}}\nengine: {kind: cycle}\ntopology: {shape: bus}\n",
                  "test.yaml:4:19: topology.shape: the rays of a treelet are tested one by one and leave it for "
                  "different places, which an answer on a bus does not carry; expected a ring or another network, "
                  "found bus, or bvh.treelets.bytes: 0"},
        BadConfig{"TreeletsOfSingleShapes", SCENE "bvh: {treelets: {bytes: 4096}}\npackets: {shapes: single}\n",
                  "test.yaml:3:19: packets.shapes: a visit takes rays through a whole treelet; expected strip, found "
                  "single, or bvh.treelets.bytes: 0"},
        BadConfig{"TreeletsOfStrips", SCENE "bvh: {treelets: {bytes: 4096}, leaves: strips}\nengine: {kind: cycle}\n",
                  "test.yaml:2:40: bvh.leaves: strips are not cut into treelets yet; expected triangles, or "
                  "bvh.treelets.bytes: 0; found strips"},
        BadConfig{"GroupedNodes", SCENE "collections: {grouped: true}\n",
                  "test.yaml:2:24: collections.grouped: only rays at treelets of the whole tree are grouped; expected "
                  "false, or bvh.treelets.bytes above 0 and packets; found true"},
        BadConfig{"BlocksOfSpread", SCENE "collections: {key: block}\nengine: {kind: cycle}\n",
                  "test.yaml:2:14: collections.traversal: a ray that is in several collections has no node of its own "
                  "in a block; expected ordered, or collections.key: node; found spread"},
        BadConfig{
            "BlocksOfIndependent",
            SCENE
            "collections: {traversal: ordered, key: block}\nengine: {kind: cycle}\ntopology: {shape: independent}\n",
            "test.yaml:2:40: collections.key: topology.shape: independent has no collections; expected node, found "
            "block"},
        BadConfig{"BlocksCarried",
                  SCENE "collections: {traversal: ordered, key: block}\nengine: {kind: cycle}\npackets: {carry: "
                        "data}\nmemory: {fetch: packet}\n",
                  "test.yaml:4:18: packets.carry: blocks of memory are not carried; expected reference, or "
                  "collections.key: node; found data"},
        BadConfig{"BlocksInGroups",
                  SCENE "collections: {traversal: ordered, key: block}\nengine: {kind: cycle}\nbvh: {levels: 3}\n",
                  "test.yaml:4:15: bvh.levels: within groups of instances rays gather at nodes; expected 2, or "
                  "collections.key: node; found 3"},
        BadConfig{"BlocksInVectors",
                  SCENE
                  "collections: {traversal: ordered, key: block}\nengine: {kind: cycle}\ntesters: {simd: {lanes: 4}}\n",
                  "test.yaml:4:25: testers.simd.lanes: the rays of a vector meet one shape at a time, and those of a "
                  "block are at several nodes; expected 1, or collections.key: node; found 4"},
        BadConfig{"BlocksInVectorsOfOne",
                  SCENE
                  "collections: {traversal: ordered, key: block}\nengine: {kind: cycle}\ntopology: {resources: 2, "
                  "overrides: [{resource: 1, testers: {simd: {lanes: 4}}}]}\n",
                  "test.yaml:4:76: topology.overrides.0.testers.simd.lanes: the rays of a vector meet one shape at a "
                  "time, and those of a block are at several nodes; expected 1, or collections.key: node; found 4"},
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
                                   "instances, sliver, found 5"));
}

}  // namespace
}  // namespace carousel
