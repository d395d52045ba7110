// Rays in warps, in whole machines, which are configured as users do.
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "core/system/error.h"
#include "tests/app/time/timed_run.h"

namespace carousel::warps_test {
namespace {

using Warps = TimedRun;
using Sets = std::vector<std::string>;

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 4000}\nimage: {width: 48, height: 32, samples: 1, max_depth: 3}\n"
    "topology: {resources: 2, shape: independent}\nrays: {slots_per_resource: 128}\n"
    "testers: {simt: {warp: 16, warps: 8}}\n"
    "memory: {l2_kib: 32, shape_buffer_kib: 8, dram_latency_cycles: 200}\nenergy: {profile: n45}\n";

/// A number of the warps of all resources together.
std::uint64_t sum(const nlohmann::ordered_json& report, const std::string& key) {
  std::uint64_t out = 0;
  for (const auto& resource : report["resources"]) out += resource["units"]["warps"][key].get<std::uint64_t>();
  return out;
}
double fill(const nlohmann::ordered_json& report) {
  return static_cast<double>(sum(report, "ray_cycles")) / static_cast<double>(sum(report, "lane_cycles"));
}

/// The rows by bounce are all lanes of each resource.
void expect_rows_add_up(const nlohmann::ordered_json& report) {
  for (const auto& resource : report["resources"]) {
    const auto& warps = resource["units"]["warps"];
    std::uint64_t lanes = 0, rays = 0;
    for (const auto& row : warps["bounces"]) {
      lanes += row["lane_cycles"].get<std::uint64_t>();
      rays += row["ray_cycles"].get<std::uint64_t>();
    }
    EXPECT_GT(warps["bounces"].size(), 1u);
    EXPECT_EQ(lanes, warps["lane_cycles"]);
    EXPECT_EQ(rays, warps["ray_cycles"]);
  }
}

TEST_F(Warps, ChangeNoHitAndCostTime) {
  const Json alone = report(kMachine, {"testers.simt.warp=0"}), warps = report(kMachine),
             packed = report(kMachine, {"testers.simt.compaction=repack"}),
             helped = report(kMachine, {"testers.simt.idle_lanes=help"}),
             apart = report(kMachine, {"testers.simt.step=lane"}),
             shallow = report(kMachine, {"testers.simt.stack_entries=1"});
  for (const Json* r : {&warps, &packed, &helped, &apart, &shallow}) {
    EXPECT_EQ((*r)["digest"], alone["digest"]);
    EXPECT_GT((*r)["engine"]["cycles"], alone["engine"]["cycles"]);
    EXPECT_GT(fill(*r), 0);
    EXPECT_LE(fill(*r), 1);
  }
  EXPECT_FALSE(alone["resources"][0]["units"].contains("warps"));
  EXPECT_GT(fill(packed), fill(warps));
  EXPECT_GT(sum(packed, "packed_bytes"), 0u);
  EXPECT_EQ(sum(warps, "packed_bytes"), 0u);
  EXPECT_GT(sum(helped, "helped"), 0u);
  EXPECT_LT(apart["engine"]["cycles"], warps["engine"]["cycles"]);
  EXPECT_GT(shallow["engine"]["cycles"], warps["engine"]["cycles"]);
  EXPECT_GT(sum(shallow, "spilled_bytes"), sum(warps, "spilled_bytes"));
  // Registers, and what lanes hold of nodes, are charged.
  const Json fewer = report(kMachine, {"testers.simt.warps=2"});
  const auto mm2 = [](const Json& r) { return r["area"]["parts"]["stacks"]["mm2"].get<double>(); };
  EXPECT_LT(mm2(shallow), mm2(warps));
  EXPECT_LT(mm2(fewer), mm2(warps));
  EXPECT_GT(fewer["engine"]["cycles"], warps["engine"]["cycles"]);  // fewer warps hide less of the memory's latency
  expect_rows_add_up(warps);
  expect_rows_add_up(packed);
  // What is spilled goes over the wires of requests to the L2, and is counted there.
  EXPECT_GT(bytes(shallow, "shape requests"),
            bytes(warps, "shape requests") + sum(shallow, "spilled_bytes") - sum(warps, "spilled_bytes"));
}

// What is prefetched goes over the same port and wires, takes places of the buffer, and changes no hit.
TEST_F(Warps, PrefetchTreeletsForJoulesBytesAndArea) {
  const Sets cut{"bvh.treelets.bytes=1024"};
  Sets ahead = cut;
  ahead.insert(ahead.end(), {"testers.simt.prefetch=treelet", "testers.simt.prefetch_rays=2"});
  const Json none = report(kMachine, cut), all = report(kMachine, ahead);
  ahead.back() = "testers.simt.prefetch_rays=1000";
  const Json few = report(kMachine, ahead);
  EXPECT_EQ(all["digest"], none["digest"]);
  EXPECT_NE(all["engine"]["cycles"], none["engine"]["cycles"]);
  EXPECT_EQ(sum(none, "votes") + sum(none, "lines_prefetched"), 0u);
  EXPECT_GT(sum(all, "lines_prefetched_used"), 0u);
  EXPECT_LT(sum(all, "lines_prefetched_used"), sum(all, "lines_prefetched"));
  EXPECT_GT(sum(all, "votes"), sum(all, "prefetches"));
  EXPECT_GT(bytes(all, "shape data"), bytes(none, "shape data"));
  // Nothing is chosen: the votes alone are paid for.
  EXPECT_EQ(sum(few, "prefetches"), 0u);
  EXPECT_EQ(few["engine"]["cycles"], none["engine"]["cycles"]);
  const auto pj = [](const Json& r) { return r["energy"]["parts"]["shape_buffers"]["joules"].get<double>() * 1e12; };
  EXPECT_NEAR(pj(few) - pj(none), 11.8 * static_cast<double>(sum(few, "votes")), 1);
  const auto mm2 = [](const Json& r) { return r["area"]["parts"]["stacks"]["mm2"].get<double>(); };
  EXPECT_NEAR(mm2(few) - mm2(none), 2 * 16 * 8 * 8 / 1024.0 * 0.00456, 1e-7);
  // Rays that wait to be packed vote too, so that the table has an entry for each slot.
  Sets packed{"testers.simt.compaction=repack", "rays.slots_per_resource=512", "bvh.treelets.bytes=1024"};
  const Json without = report(kMachine, packed);
  packed.insert(packed.end(), {"testers.simt.prefetch=treelet", "testers.simt.prefetch_rays=2"});
  EXPECT_NEAR(mm2(report(kMachine, packed)) - mm2(without), 2 * 512 * 8 / 1024.0 * 0.00456, 1e-7);
  EXPECT_THROW(report(kMachine, {"testers.simt.prefetch=treelet"}), ConfigError);
}

TEST_F(Warps, AreTheSameOnAnyThreads) {
  const Sets sets{"testers.simt.compaction=repack", "testers.simt.stack_entries=2"};
  Sets threads = sets;
  threads.emplace_back("engine.threads=2");
  EXPECT_EQ(report(kMachine, sets)["engine"]["cycles"], report(kMachine, threads)["engine"]["cycles"]);
}

TEST_F(Warps, ABudgetScalesWhatAllShare) {
  const Json r = report(kMachine, {"area.budget_mm2=40", "area.fit=all", "shading.workers=6", "memory.shared_by=8"});
  const auto resources = r["config"]["topology"]["resources"].get<int>();
  EXPECT_GT(resources, 2);
  EXPECT_LE(r["area"]["mm2"].get<double>(), 40);
  EXPECT_EQ(r["config"]["shading"]["workers"], 3 * resources);
  EXPECT_EQ(r["config"]["memory"]["l2_kib"], 16 * resources);
  EXPECT_EQ(r["config"]["memory"]["shared_by"], resources);
}

}  // namespace
}  // namespace carousel::warps_test
