// Machines of rays whose links and routers go by clocks of their own.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::machine_clocks_test {
namespace {

class MachineClocks : public TimedRun {
 protected:
  /// Two clusters with a router between them, and a slow link behind it.
  Json clusters(const std::string& clocks, const std::string& of_router = "", const std::string& of_link = "",
                std::vector<std::string> sets = {}) {
    return report(
        fmt::format("scene: {{builtin: spheres, triangles: 2000}}\n"
                    "image: {{width: 24, height: 16, max_depth: 2}}\n"
                    "engine: {{clock_mhz: 1500}}\n{}"
                    "rays: {{slots_per_resource: 64}}\n"
                    "topology:\n  shape: graph\n"
                    "  nodes: [{{name: a, count: 3}}, {{name: b, count: 3}}, {{name: x, kind: router, count: 2, "
                    "latency_cycles: 2{}}}]\n"
                    "  links:\n    - {{ring: 'a[*], x[0]', both: true}}\n    - {{ring: 'b[*], x[1]', both: true}}\n"
                    "    - {{from: 'x[0]', to: 'x[1]', both: true, latency_cycles: 9, bytes_per_cycle: 16{}}}\n",
                    clocks, of_router, of_link),
        std::move(sets));
  }
  static std::uint64_t cycles(const Json& run) { return run["engine"]["cycles"]; }
  static Json without_host(Json run) {
    for (const char* key : {"host", "config", "checksum", "ignored_keys"}) run.erase(key);
    return run;
  }
};

TEST_F(MachineClocks, OfOneFrequencyAreOneToTheLastNumber) {
  const Json one = clusters("");
  const Json two =
      clusters("clocks: {core: 1500, noc: 1500, a: 1500, synchroniser_cycles: 9}\n", ", clock: a", ", clock: a");
  EXPECT_EQ(without_host(one), without_host(two));
  EXPECT_FALSE(one.contains("clocks"));
}

// The rays are the same, whatever the clocks, and on any number of threads the cycles as well.
TEST_F(MachineClocks, ChangeTimeAndNothingElse) {
  const Json one = clusters("");
  const std::string clocks = "clocks: {core: 1500, noc: 2000, slow: 700}\n";
  const Json two = clusters(clocks, "", ", clock: slow");
  EXPECT_EQ(two["digest"], one["digest"]);
  EXPECT_NE(cycles(two), cycles(one));
  Json threads = clusters(clocks, "", ", clock: slow", {"engine.threads=2"});
  EXPECT_EQ(cycles(threads), cycles(two));
  EXPECT_EQ(threads["links"], two["links"]);
  ASSERT_EQ(two["clocks"].size(), 3u);
  EXPECT_EQ(two["clocks"][0]["name"], "core");
  EXPECT_EQ(two["clocks"][1]["mhz"], 2000);
  EXPECT_EQ(two["clocks"][1]["cycles"], (cycles(two) * 4 + 2) / 3);
  EXPECT_NEAR(two["engine"]["nanoseconds"], static_cast<double>(cycles(two)) / 1.5, 1e-6);
  EXPECT_EQ(two["links"].back()["clock"], "slow");
  EXPECT_EQ(two["links"].front()["clock"], "noc");
  for (const Json& link : two["links"])
    EXPECT_EQ(link["cycles"]["busy"].get<std::uint64_t>() + link["cycles"]["stalled"].get<std::uint64_t>() +
                  link["cycles"]["idle"].get<std::uint64_t>(),
              cycles(two));
}

// What costs a synchroniser costs more with more cycles in it, and a slower clock is slower.
TEST_F(MachineClocks, SlowerClocksTakeLonger) {
  const auto at = [&](int noc, int wait) {
    return cycles(clusters(fmt::format("clocks: {{noc: {}, synchroniser_cycles: {}}}\n", noc, wait)));
  };
  EXPECT_LT(at(2000, 2), at(750, 2));
  EXPECT_LT(at(750, 2), at(200, 2));
  EXPECT_LT(at(2000, 0), at(2000, 40));
  EXPECT_LT(cycles(clusters("")), at(1499, 2));  // nearly the same clock, but another one
}

// One ray, one packet that goes round: every visit, link and router is a term of the sum. Twice the frequency of all
// links and routers takes half of their cycles, besides the synchronisers at both sides of each.
TEST_F(MachineClocks, AWayTakesTheCyclesOfItsClocks) {
  program_.write("rays.csv",
                 "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,900,0,0,1,0,inf\n1,camera,0,0,900,0,0,1,0,inf\n");
  const auto at = [&](int latency, const std::string& clocks) {
    return cycles(
        report(fmt::format("scene: {{builtin: terrain, triangles: 18}}\nworkload: {{rays_from: rays.csv}}\n"
                           "engine: {{clock_mhz: 1000}}\n{}"
                           "rays: {{placement: round_robin}}\npackets: {{rays: 2}}\n"
                           "topology: {{shape: graph, nodes: [{{name: r, count: 2}}], links: [{{line: "
                           "'r[*]', both: true, latency_cycles: {}}}]}}\n",
                           clocks, latency)));
  };
  const std::uint64_t near = at(100, ""), far = at(200, "");
  const std::uint64_t links = (far - near) / 100;  // that are crossed one after the other
  EXPECT_GE(links, 2u);
  EXPECT_EQ(far - near, 100 * links);
  EXPECT_EQ(at(200, "clocks: {noc: 2000, synchroniser_cycles: 0}\n"), near);
  // A synchroniser of two at 500 ps and one of two at 1 ns at each link.
  EXPECT_EQ(at(200, "clocks: {noc: 2000, synchroniser_cycles: 2}\n"), near + 3 * links);
  const std::uint64_t slow = at(100, "clocks: {noc: 500, synchroniser_cycles: 1}\n");
  EXPECT_GE(slow, far + 3 * links);
  EXPECT_LE(slow, far + 5 * links);  // and up to a cycle until the next edge before and behind each synchroniser
}

}  // namespace
}  // namespace carousel::machine_clocks_test
