// A resource that looks at more than the first packet of its input queue (`testers.window`).
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::window_test {
namespace {

/// Four resources in a ring, a ray a packet. Resource 0 issues packets for the rays 0 and 2, which live at 1 and miss
/// everything; 2 issues those for the ray 1, which lives at 3 and meets two leaves. The test of ray 0 takes `slow`
/// cycles, and 1 has one context, so that the packet of ray 2 waits there. The root's packet of ray 1 comes by behind
/// it on its way home, where it is waited for: the tests of its leaves take so long that they end the run.
class WindowTest : public TimedRun {
 protected:
  std::int64_t cycles(int window, int slow, std::vector<std::string> sets = {}) {
    program_.write("rays.csv",
                   "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n"
                   "0,camera,0,0,900,0,0,1,0,inf\n"
                   "1,camera,-900,0,-900,1,0,1,0,inf\n"
                   "2,camera,0,0,900,0,0,1,0,inf\n");
    sets.push_back(fmt::format("testers.window={}", window));
    sets.push_back(
        fmt::format("topology.overrides=[{{resource: 1, testers: {{contexts: 1, box: {{latency_cycles: {}}}}}}}, "
                    "{{resource: 3, testers: {{triangle: {{latency_cycles: 9000}}}}}}]",
                    slow));
    const Json run = report(
        "scene: {builtin: terrain, triangles: 18}\n"
        "workload: {rays_from: rays.csv}\n"
        "bvh: {width: 2, leaf_triangles: 16}\n"
        "topology: {resources: 4, link: {latency_cycles: 50, bytes_per_cycle: 8}}\n"
        "packets: {rays: 1, ids_per_cycle: 1}\n"
        "collections: {ready: 1, policy: fullest}\n"
        "rays: {placement: round_robin}\n"
        "shading: {workers: 4}\n",
        std::move(sets));
    EXPECT_EQ(run["packets"]["issued"], 5u);
    return run["engine"]["cycles"];
  }
  std::int64_t spared(int slow, const std::vector<std::string>& sets = {}) {
    return cycles(1, slow, sets) - cycles(2, slow, sets);
  }
};

// In order it leaves 1 when the test of ray 0 has ended and its packet of 21 bytes has left, 3 cycles later. Otherwise
// it leaves when it comes: its test took 13 cycles, and two links 50 each.
TEST_F(WindowTest, LetsAPacketPassOneThatWaits) {
  EXPECT_EQ(spared(3000, {"topology.visit=owners"}), 3000 + 3 - 13 - 2 * 50);
  EXPECT_EQ(spared(4000, {"topology.visit=owners"}), 4000 + 3 - 13 - 2 * 50);
  EXPECT_EQ(cycles(2, 3000, {"topology.visit=owners"}), cycles(2, 4000, {"topology.visit=owners"}));
}

// Where all resources read it, its tail comes 2 cycles after its head, and 0 and 1 read it for a cycle each. Choosing
// it takes 1 another one.
TEST_F(WindowTest, TakesDispatchACycleToChoose) {
  EXPECT_EQ(spared(3000, {"topology.visit=all"}), 3000 + 3 - 13 - 2 * (50 + 2 + 1) - 1);
}

// On a bus an answer may be taken out of turn, while other resources still test its packet. Each cycle of a ray has one
// stage all the same, or the engine would refuse its own result.
TEST_F(WindowTest, TakesAnswersOutOfTurnOnABus) {
  const auto bus = [&](int window) {
    return report(
        "scene: {builtin: terrain, triangles: 2000}\nimage: {width: 16, height: 12}\n"
        "rays: {slots_per_resource: 64}\npackets: {rays: 8}\ntopology: {shape: bus, resources: 4}\n",
        {fmt::format("testers={{window: {}, contexts: 2}}", window)});
  };
  const Json in_turn = bus(1), out_of_turn = bus(4);
  EXPECT_EQ(out_of_turn["digest"], in_turn["digest"]);
  EXPECT_NE(out_of_turn["engine"]["cycles"], in_turn["engine"]["cycles"]);
}

}  // namespace
}  // namespace carousel::window_test
