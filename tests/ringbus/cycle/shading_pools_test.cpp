// Several pools of shader workers that are drawn: times against closed forms, and sums over the pools.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/config/config.h"
#include "tests/ringbus/support/timed_machine.h"

namespace carousel::ringbus::cycle::shading_pools_test {
namespace {

/// A pool that serves `count` resources over links of a latency, which are never busy.
struct Pool {
  int count, workers;
  std::int64_t latency;
};

/// Resources of one slot each, whose rays and packets stay with them, and these pools. The first pool has the last
/// resources, as ray control of several free ones begins with the last.
std::string machine(const std::vector<Pool>& pools, const std::string& rest = "") {
  int resources = 0;
  for (const Pool& pool : pools) resources += pool.count;
  std::string nodes, links;
  for (std::size_t i = 0, end = static_cast<std::size_t>(resources); i < pools.size(); ++i) {
    const std::size_t last = end - 1, first = end -= static_cast<std::size_t>(pools[i].count);
    nodes += fmt::format("    - {{name: s{}, kind: shading, workers: {}}}\n", i, pools[i].workers);
    links += fmt::format(
        "    - {{from: s{}, to: 'r[{}..{}]', both: true, carries: [new_rays, completed_rays], bytes_per_cycle: 65536, "
        "latency_cycles: {}}}\n",
        i, first, last, pools[i].latency);
  }
  return "rays: {slots_per_resource: 1}\npackets: {rays: 1}\n"
         "collections: {ready: 1, traversal: ordered, home: local}\nshading: {cycles_per_shade: 3}\n" +
         rest + fmt::format("topology:\n  shape: graph\n  nodes:\n    - {{name: r, count: {}}}\n", resources) + nodes +
         "  links:\n    - {ring: 'r[*]'}\n" + links;
}

std::vector<std::uint64_t> shaded(const RunResult& result) {
  std::vector<std::uint64_t> out;
  for (const PoolUse& pool : result.cycle->pools) out.push_back(pool.shaded);
  return out;
}

// A pool makes a camera ray for each of its slots, and another one whenever one is back. With nine rays that cause no
// others, and ways so long that nothing else matters, all is known: the near pool has one ray under way, which takes
// 0.6 million cycles, and the far one two, of 1.56 million. Rays begin at 0 (three), 0.6, 1.2, 1.56 (two), 1.8 and 2.4,
// so that the near pool shades five. The last rays to be back are the far ones that began at 1.56.
TEST(ShadingPools, UnequalLatenciesAndWorkersShareTheRaysByTheirTimes) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 9, 0);
  ASSERT_EQ(scene.rays(), 9u);
  const auto run = [&](std::int64_t near, std::int64_t far, std::size_t threads = 1) {
    return run_text(scene, machine({{1, 1, near}, {2, 2, far}}), {}, threads).result;
  };
  constexpr std::int64_t kNear = 300'000, kFar = 780'000;
  const RunResult base = run(kNear, kFar);
  EXPECT_EQ(shaded(base), (std::vector<std::uint64_t>{5, 4}));
  EXPECT_GT(base.cycle->cycles, 4u * kFar);
  EXPECT_LT(base.cycle->cycles, 4u * kFar + 50'000);
  EXPECT_EQ(run(kNear, kFar + 1000).cycle->cycles, base.cycle->cycles + 4 * 1000);
  EXPECT_EQ(run(kNear + 1000, kFar).cycle->cycles, base.cycle->cycles);  // it is not waited for
  EXPECT_EQ(run(kNear, kFar, 3).cycle->cycles, base.cycle->cycles);
  // When the far ways are longer than all that the near pool does, its two rays are the last ones.
  const RunResult longest = run(100'000, 900'000);
  EXPECT_EQ(shaded(longest), (std::vector<std::uint64_t>{7, 2}));
  EXPECT_EQ(run(100'000, 900'500).cycle->cycles, longest.cycle->cycles + 2 * 500);
  // With the resources and workers of the other: rays begin at 0 (three), 0.6 (two), 1.2 (two), 1.56 and 1.8.
  const RunResult turned = run_text(scene, machine({{2, 2, kNear}, {1, 1, kFar}})).result;
  EXPECT_EQ(shaded(turned), (std::vector<std::uint64_t>{7, 2}));
}

// A worker and a slot for each resource: it does not matter which worker of which pool it is. But where two rays come
// back so close to one another that both slots are free when the next ray has been made, one pool may put that into
// either.
TEST(ShadingPools, AtEqualDistanceTheyTakeTheTimeOfOneWithAllWorkers) {
  for (const std::uint32_t rays : {2u, 40u}) {
    TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), rays, 0);
    const RunResult one = run_text(scene, machine({{2, 2, 40}})).result,
                    two = run_text(scene, machine({{1, 1, 40}, {1, 1, 40}})).result;
    EXPECT_EQ(one.rays_completed, rays);
    EXPECT_EQ(one.cycle->shading, two.cycle->shading);
    if (rays == 2)
      EXPECT_EQ(one.cycle->cycles, two.cycle->cycles);
    else
      EXPECT_NEAR(static_cast<double>(one.cycle->cycles) / static_cast<double>(two.cycle->cycles), 1, 0.001);
  }
}

TEST(ShadingPools, AddUpToTheTotals) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 600, 2);
  const std::string text =
      "rays: {slots_per_resource: 32}\npackets: {rays: 8}\ncollections: {ready: 8}\n"
      "shading: {cycles_per_shade: 9}\ntopology:\n  shape: graph\n  nodes:\n    - {name: r, count: 6}\n"
      "    - {name: s, kind: shading, count: 3, workers: 2, serves: 'r[*]'}\n  links:\n"
      "    - {ring: 'r[*]', latency_cycles: 12}\n"
      "    - {from: 'r[*]', all_to: 's[*]', both: true, carries: [new_rays, completed_rays]}\n";
  for (const std::vector<std::string>& sets : std::vector<std::vector<std::string>>{
           {},
           {"collections.home=local"},
           {"shading.distribute=load", "shading.lanes=4", "shading.sort=shader"},
           {"shading.idle_resources_shade=true"},
           {"rays.placement=round_robin", "bundles.size=4"},
           {"topology.trace=stacks",
            "topology.links=[{from: 'r[*]', all_to: 's[*]', both: true, carries: [new_rays, completed_rays]}]"}}) {
    SCOPED_TRACE(testing::PrintToString(sets));
    const RunResult run = run_text(scene, text, sets).result;
    std::uint64_t all = 0;
    Cycle busy = 0;
    ASSERT_EQ(run.cycle->pools.size(), 3u);
    for (const PoolUse& pool : run.cycle->pools) {
      EXPECT_GT(pool.shaded, 100u);
      EXPECT_LE(pool.busy, 2 * run.cycle->cycles);
      all += pool.shaded;
      busy += pool.busy;
    }
    EXPECT_EQ(all, run.rays_completed);
    EXPECT_EQ(busy, run.cycle->shading.busy);
    const auto use = std::ranges::find(run.cycle->uses, "shading", &ClassUse::name);
    EXPECT_EQ(use->parts, 6);
    EXPECT_EQ(use->busy, busy);
    EXPECT_EQ(run.slots_used, run.rays_completed);
    const RunResult again = run_text(scene, text, sets, 4).result;
    EXPECT_EQ(again.cycle->cycles, run.cycle->cycles);
    EXPECT_EQ(again.cycle->pools, run.cycle->pools);
  }
}

// A pool that has lost its workers to the others is slower; the sum of workers alone would not show it.
TEST(ShadingPools, APoolWithFewWorkersIsTheBottleneck) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 600, 2);
  const auto cycles = [&](int first, int second) {
    return cycles_of(scene,
                     fmt::format("rays: {{slots_per_resource: 32}}\npackets: {{rays: 8}}\ncollections: {{ready: 8}}\n"
                                 "shading: {{cycles_per_shade: 200}}\ntopology:\n  shape: graph\n  nodes:\n"
                                 "    - {{name: r, count: 4}}\n    - {{name: a, kind: shading, workers: {}, serves: "
                                 "'r[0..1]'}}\n    - {{name: b, kind: shading, workers: {}, serves: 'r[2..3]'}}\n"
                                 "  links:\n    - {{ring: 'r[*]'}}\n    - {{from: 'r[*]', all_to: 'a, b', both: true, "
                                 "carries: [new_rays, completed_rays]}}\n",
                                 first, second));
  };
  const std::uint64_t even = cycles(2, 2), one = cycles(1, 1);
  EXPECT_GT(one, even * 18 / 10);
  EXPECT_GT(one, cycles(1, 3));  // the other pool takes more of the camera rays
}

}  // namespace
}  // namespace carousel::ringbus::cycle::shading_pools_test
