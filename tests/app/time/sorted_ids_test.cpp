// Hits that are sorted by child before they join collections, and the lanes that tests fill.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::sorted_ids_test {
namespace {

class SortedIds : public TimedRun {
 protected:
  static double dispatch_cycles(const Json& report) {
    double sum = 0;
    for (const Json& resource : report["resources"]) sum += resource["units"]["dispatch_busy"].get<double>();
    return sum;
  }
  /// The rays in all packets. But for the rays that begin, each has joined a collection when another packet retired.
  static double memberships(const Json& report) {
    return report["packets"]["rays_mean"].get<double>() * report["packets"]["issued"].get<double>();
  }
};

TEST_F(SortedIds, TakeDispatchAsLongAsItsRateNeeds) {
  for (const char* scene : {"{builtin: terrain, triangles: 3000}", "{builtin: cornell}"}) {
    for (const int width : {16, 32}) {
      const std::string machine = fmt::format(
          "scene: {}\nimage: {{width: {}, height: 16, samples: 1}}\ntopology: {{resources: 1}}\n"
          "packets: {{ids_per_cycle: 1024}}\ncollections: {{traversal: spread}}\n",
          scene, width);
      const Json free = report(machine), slow = report(machine, {"collections.sort_ids_per_cycle=1"}),
                 fast = report(machine, {"collections.sort_ids_per_cycle=1024"});
      const double joined = memberships(slow) - slow["shading"]["shaded"].get<double>();
      EXPECT_GE(dispatch_cycles(slow), joined);
      EXPECT_LT(dispatch_cycles(free), 0.8 * joined) << "so that the rate is what the line above sees";
      EXPECT_GE(slow["engine"]["cycles"].get<double>(), joined);
      // No packet has more than 1024 memberships to sort.
      EXPECT_EQ(fast["engine"]["cycles"], free["engine"]["cycles"]);
      EXPECT_EQ(slow["digest"], free["digest"]);
    }
  }
}

// Eight rays go from the root to three leaves each. Dispatch has read the 8 IDs of the root's packet, an ID a cycle,
// and goes on until their 24 memberships are sorted; at the leaves nothing joins.
TEST_F(SortedIds, KeepDispatchForWhatIsLeftToSortAfterReading) {
  std::string rays = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int i = 0; i < 8; ++i) rays += fmt::format("{},camera,-900,0,-900,1,0,1,0,inf\n", i);
  program_.write("rays.csv", rays);
  const auto run = [this](int rate) {
    return report(
        "scene: {builtin: terrain, triangles: 18}\nworkload: {rays_from: rays.csv}\ntopology: {resources: 1}\n"
        "bvh: {width: 4, leaf_triangles: 16}\npackets: {rays: 8, ids_per_cycle: 1}\n",
        {fmt::format("collections.sort_ids_per_cycle={}", rate)});
  };
  const Json free = run(0);
  ASSERT_EQ(free["packets"]["issued"], 4);
  ASSERT_EQ(free["nodes"]["by_depth"][0]["children_hit"], 24);
  EXPECT_EQ(dispatch_cycles(run(1)) - dispatch_cycles(free), 24 - 8);
  EXPECT_EQ(dispatch_cycles(run(2)) - dispatch_cycles(free), 12 - 8);
  EXPECT_EQ(dispatch_cycles(run(3)), dispatch_cycles(free));
  EXPECT_EQ(dispatch_cycles(run(4)), dispatch_cycles(free));
}

TEST_F(SortedIds, TheReportHasTheFillOfLanes) {
  const std::string machine =
      "scene: {builtin: terrain, triangles: 3000}\nimage: {width: 16, height: 16, samples: 1}\n"
      "topology: {resources: 4}\n";
  EXPECT_FALSE(report(machine)["resources"][0]["units"].contains("lane_fill"));
  const Json of = report(machine, {"testers.simd.lanes=32", "testers.simd.map=shapes"});
  for (const Json& resource : of["resources"]) {
    const Json& fill = resource["units"]["lane_fill"];
    EXPECT_GT(fill["box"].get<double>(), 0);
    EXPECT_LE(fill["box"].get<double>(), 8.0 / 32) << "a node has at most 8 children";
    EXPECT_LE(fill["triangle"].get<double>(), 1);
    EXPECT_FALSE(fill.contains("bundle")) << "there are no bundles";
  }
  const Json two = report(machine, {"testers.simd.lanes=2", "testers.simd.map=shapes"});
  EXPECT_GE(two["resources"][0]["units"]["lane_fill"]["box"].get<double>(), 0.5);
}

}  // namespace
}  // namespace carousel::sorted_ids_test
