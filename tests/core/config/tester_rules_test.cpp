// Rules of testers: warps, lanes, distributors, cells, and what a resource may have of its own (ConfigRule).
#include "tests/core/config/config_rule.h"

namespace carousel {
namespace {

INSTANTIATE_TEST_SUITE_P(
    Testers, ConfigRule,
    testing::Values(
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
                  "leaves, for its own rays; expected before, or memory.fetch: resource; found after"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace carousel
