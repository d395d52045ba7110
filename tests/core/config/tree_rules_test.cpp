// Rules of the tree and of the ways through it: cull planes, bundles, treelets, collections by block (ConfigRule).
#include "tests/core/config/config_rule.h"

namespace carousel {
namespace {

INSTANTIATE_TEST_SUITE_P(
    Trees, ConfigRule,
    testing::Values(
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
        BadConfig{
            "BlocksOnNoGrid", SCENE "engine: {kind: cycle}\nbvh: {leaves: blocks}\n",
            "test.yaml:1:8: scene.quantise: vertices that are on no grid are not compressed; expected 1 to 24, or "
            "bvh.leaves: triangles; found 0"},
        BadConfig{"BlocksInNodes",
                  "scene: {builtin: cornell, quantise: 12}\nengine: {kind: cycle}\nbvh: {leaves: blocks, "
                  "mixed_triangles: 2}\n",
                  "test.yaml:3:40: bvh.mixed_triangles: nodes hold no compressed triangles; expected 0, or bvh.leaves: "
                  "triangles; found 2"},
        BadConfig{"BlocksOfSingleShapes",
                  "scene: {builtin: cornell, quantise: 12}\nengine: {kind: cycle}\nbvh: {leaves: blocks}\npackets: "
                  "{shapes: single}\n",
                  "test.yaml:4:19: packets.shapes: a block of triangles is decoded as a whole; expected strip, or "
                  "bvh.leaves: triangles; found single"},
        BadConfig{"BlocksBehindADistributor",
                  "scene: {builtin: cornell, quantise: 12}\nengine: {kind: cycle}\nbvh: {leaves: blocks}\ntopology: "
                  "{shape: central, form: distributor, resources: 1}\n",
                  "test.yaml:4:34: topology.form: testers behind a distributor have no decoder; expected another form, "
                  "or bvh.leaves: triangles; found distributor"},
        BadConfig{
            "BlocksOfTheNativeEngine",
            "scene: {builtin: cornell, quantise: 12}\nengine: {kind: native}\nbvh: {leaves: blocks}\n",
            "test.yaml:3:15: bvh.leaves: the native engine has no simulated memory; expected triangles, found blocks"},
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
                  "time, and those of a block are at several nodes; expected 1, or collections.key: node; found 4"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace carousel
