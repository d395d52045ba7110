// A central machine of test cells over ray memory with banks: the cycles of one vector by hand, and that cells and
// banks serialise what shares them.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::central_cells_test {
namespace {

class CentralCells : public TimedRun {};

// So many rays of one pixel that miss all there is: each is tested once, together with all others, against the boxes of
// the root's children. They lie in the slots from 0 on.
std::string misses(int rays) {
  return fmt::format(
      "scene: {{builtin: cornell}}\nimage: {{width: 1, height: 1, samples: {}, max_depth: 1}}\n"
      "camera: {{eye: [0, 0, 100], target: [0, 0, 200]}}\ntopology: {{shape: central, resources: 1}}\n"
      "rays: {{slots_per_resource: 64}}\nshading: {{workers: 1, effects: []}}\n"
      "testers: {{box: {{units: 1, interval_cycles: 1, latency_cycles: 9}}}}\n",
      rays);
}

TEST_F(CentralCells, TakeAsLongAsHandsCompute) {
  const auto cycles = [this](int rays, std::vector<std::string> sets) {
    const Json r = report(misses(rays), sets);
    EXPECT_EQ(r["packets"]["issued"], 1);
    return r["engine"]["cycles"].get<std::uint64_t>();
  };
  const Json one = report(misses(16), {"testers.simd.lanes=16"});
  const std::uint64_t boxes = one["tests"]["box"]["count"].get<std::uint64_t>() / 16;
  ASSERT_GE(boxes, 2u);
  const std::uint64_t all_at_once = one["engine"]["cycles"];
  // 16 rays in 4 cells: four rays a cell, one after another against each of the boxes.
  EXPECT_EQ(cycles(16, {"testers.simd.lanes=4"}), all_at_once + 3 * boxes);
  // 16 cells, of which 12 stay empty in the second turn; a machine whose lanes take any ray needs as long.
  EXPECT_EQ(cycles(20, {"testers.simd.lanes=16"}), cycles(20, {"testers.simd.lanes=10"}));
  // The boxes of a ray follow its record, an interval apart. 4 records in each of 4 banks, and 16 in one.
  const std::uint64_t banked = cycles(16, {"testers.simd.lanes=16", "rays.banks=16"});
  EXPECT_EQ(cycles(16, {"testers.simd.lanes=16", "rays.banks=4"}), banked + std::max(boxes, std::uint64_t{4}) - boxes);
  EXPECT_EQ(cycles(16, {"testers.simd.lanes=16", "rays.banks=1"}), banked + 16 - boxes);
}

// On whole pictures the slots of a collection's rays fall on cells as they may.
TEST_F(CentralCells, FixedPlacesCostAndTheReportCountsThem) {
  for (const char* scene : {"{builtin: terrain, triangles: 3000}", "{builtin: cornell}"}) {
    for (const int width : {16, 40}) {
      const std::string machine = fmt::format(
          "scene: {}\nimage: {{width: {}, height: 16, samples: 1}}\n"
          "topology: {{resources: 1}}\ntesters: {{simd: {{lanes: 32}}, box: {{units: 1}}}}\n",
          scene, width);
      const Json free = report(machine), cells = report(machine, {"topology.shape=central"}),
                 banks = report(machine, {"topology.shape=central", "rays.banks=4"});
      const auto fill = [](const Json& r) { return r["resources"][0]["units"]["lane_fill"]["box"].get<double>(); };
      EXPECT_LT(fill(cells), 0.95 * fill(free)) << scene << width;
      EXPECT_EQ(cells["digest"], free["digest"]);
      EXPECT_EQ(banks["digest"], free["digest"]);
      EXPECT_GT(banks["resources"][0]["units"]["bank_conflicts"].get<std::uint64_t>(), 0u);
      const Json& units = banks["resources"][0]["units"];
      // Each of a bank's two ports reads at most one record a cycle.
      EXPECT_GE(4 * (units["ray_reads"]["busy"].get<double>() + units["primitive_ray_reads"]["busy"].get<double>()),
                banks["packets"]["rays_mean"].get<double>() * banks["packets"]["issued"].get<double>());
    }
  }
}

// A node that holds boxes and triangles reads a record for its boxes and once more for its triangles.
TEST_F(CentralCells, ASecondReadOfARecordCostsJoulesToo) {
  const std::string machine =
      "scene: {builtin: terrain, triangles: 3000}\nimage: {width: 24, height: 16, samples: 1}\n"
      "topology: {shape: central, resources: 1}\ntesters: {simd: {lanes: 32}}\nenergy: {profile: n45}\n"
      "bvh: {mixed_triangles: 4}\n";
  const Json one = report(machine), banks = report(machine, {"rays.banks=4"});
  const auto accesses = [](const Json& r) { return r["energy"]["parts"]["ray_store"]["events"].get<double>(); };
  const double again = banks["resources"][0]["units"]["second_reads"];
  EXPECT_GT(again, 0);
  EXPECT_EQ(accesses(banks) - accesses(one), 8 * (again + banks["tests"]["ray_reads"]["count"].get<double>() -
                                                  one["tests"]["ray_reads"]["count"].get<double>()));
  EXPECT_EQ(report(machine, {"rays.banks=4", "bvh.mixed_triangles=0"})["resources"][0]["units"]["second_reads"], 0);
}

}  // namespace
}  // namespace carousel::central_cells_test
