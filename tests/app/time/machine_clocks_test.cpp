// Machines of rays whose links and routers go by clocks of their own.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

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

/// When a packet that leaves its resource at `leaves` is at the next one, in cycles of 1 ns: the link takes it over at
/// its next edge, moves it by its own clock, and the other resource takes it over at its own next edge.
std::uint64_t crossed(std::uint64_t leaves, std::uint64_t mhz, std::uint64_t wait, std::uint64_t on_link) {
  const auto next_edge = [](std::uint64_t cycles, std::uint64_t from_mhz, std::uint64_t to_mhz) {
    return (cycles * to_mhz + from_mhz - 1) / from_mhz;
  };
  return next_edge(next_edge(leaves, 1000, mhz) + wait + on_link, mhz, 1000) + wait;
}

// One packet that goes to the other resource and back: every visit and link is a term of the sum. What the resources
// take themselves is what a machine of one clock says of when the packet leaves them.
TEST_F(MachineClocks, AWayTakesTheCyclesOfItsClocks) {
  program_.write("rays.csv",
                 "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,900,0,0,1,0,inf\n1,camera,0,0,900,0,0,1,0,inf\n");
  const auto run = [&](std::uint64_t latency, const std::string& clocks) {
    return report(fmt::format("scene: {{builtin: terrain, triangles: 18}}\nworkload: {{rays_from: rays.csv}}\n"
                              "engine: {{clock_mhz: 1000}}\n{}"
                              "rays: {{placement: round_robin}}\npackets: {{rays: 2}}\n"
                              "topology: {{shape: graph, nodes: [{{name: r, count: 2}}], links: [{{line: "
                              "'r[*]', both: true, latency_cycles: {}}}]}}\n",
                              clocks, latency),
                  {}, "trace.json");
  };
  const std::uint64_t latency = 100;
  const Json one = run(latency, "");
  std::vector<std::uint64_t> leaves;
  const Json trace = Json::parse(program_.read("trace.json"));
  for (const Json& slice : trace["traceEvents"])
    if (slice["ph"] == "X" && slice["name"] == "packet") leaves.push_back(slice["ts"]);
  ASSERT_EQ(leaves.size(), 2u);
  ASSERT_EQ(one["links"].size(), 2u);
  const std::uint64_t flits = one["links"][0]["cycles"]["busy"];
  ASSERT_EQ(one["links"][1]["cycles"]["busy"], flits);
  const std::uint64_t on_link = latency + flits - 1;  // until the last flit is there
  ASSERT_GT(leaves[1], leaves[0] + on_link);
  const std::uint64_t visit = leaves[1] - (leaves[0] + on_link), end = cycles(one) - (leaves[1] + on_link);
  EXPECT_EQ(cycles(run(2 * latency, "")), cycles(one) + 2 * latency);
  // Twice the frequency takes half of the cycles, besides a synchroniser of 500 ps and one of 1 ns at each link.
  EXPECT_EQ(cycles(run(2 * latency, "clocks: {noc: 2000, synchroniser_cycles: 0}\n")), cycles(one));
  EXPECT_EQ(cycles(run(2 * latency, "clocks: {noc: 2000, synchroniser_cycles: 2}\n")), cycles(one) + 2 * 3);
  for (const std::uint64_t mhz : {2000u, 1499u, 750u, 500u, 333u})
    for (const std::uint64_t wait : {0u, 1u, 2u, 5u}) {
      const Json two = run(latency, fmt::format("clocks: {{noc: {}, synchroniser_cycles: {}}}\n", mhz, wait));
      const std::uint64_t there = crossed(leaves[0], mhz, wait, on_link);
      EXPECT_EQ(cycles(two), crossed(there + visit, mhz, wait, on_link) + end) << mhz << " MHz, " << wait;
    }
}

}  // namespace
}  // namespace carousel::machine_clocks_test
