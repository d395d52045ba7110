// Machines of rays whose links and routers go by clocks of their own.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <sstream>
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

// From r[0], 7 cycles of 2 ns behind two in the synchroniser; the router's 3 and the link's 5; back to the clock of the
// resources and through its synchroniser: 2 * (2 + 7 + 3 + 5) + 2.
TEST_F(MachineClocks, CheckTellsWaysByTheClockOfTheResources) {
  const auto graph = [&](int noc) {
    program_.write("two.yaml",
                   fmt::format("scene: {{builtin: cornell}}\nengine: {{kind: cycle}}\nclocks: {{noc: {}}}\n"
                               "topology: {{shape: graph, nodes: [{{name: r, count: 2}}, {{name: x, kind: router, "
                               "latency_cycles: 3}}], links: [{{from: 'r[*]', to: x, latency_cycles: 7}}, {{from: x, "
                               "to: 'r[*]', latency_cycles: 5}}]}}\n",
                               noc));
    return Json::parse(program_.run({"check", "two.yaml", "--json"}).out)["graph"];
  };
  const Json one = graph(1000), slow = graph(500);
  EXPECT_EQ(one["longest_cycles"], 15);
  EXPECT_EQ(slow["longest_cycles"], 36);
  EXPECT_EQ(slow["mean_cycles"], 18);  // of both ways, and of each resource to itself
  EXPECT_DOUBLE_EQ(slow["bound"].get<double>(), one["bound"].get<double>() / 2);
}

/// When a packet that leaves its resource at `leaves` is at the next one, in cycles of 1 ns: the link takes it over at
/// its next edge, moves it by its own clock, and the other resource takes it over at its own next edge.
std::uint64_t crossed(std::uint64_t leaves, std::uint64_t mhz, std::uint64_t wait, std::uint64_t on_link) {
  const auto next_edge = [](std::uint64_t cycles, std::uint64_t from_mhz, std::uint64_t to_mhz) {
    return (cycles * to_mhz + from_mhz - 1) / from_mhz;
  };
  return next_edge(next_edge(leaves, 1000, mhz) + wait + on_link, mhz, 1000) + wait;
}

/// One packet that goes to the other resource and back over two links.
class ThereAndBack : public TimedRun {
 protected:
  void SetUp() override {
    program_.write(
        "rays.csv",
        "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,900,0,0,1,0,inf\n1,camera,0,0,900,0,0,1,0,inf\n");
  }
  Json run(std::uint64_t latency, const std::string& more) {
    return report(fmt::format("scene: {{builtin: terrain, triangles: 18}}\nworkload: {{rays_from: rays.csv}}\n"
                              "engine: {{clock_mhz: 1000}}\n{}"
                              "rays: {{placement: round_robin}}\npackets: {{rays: 2}}\n"
                              "topology: {{shape: graph, nodes: [{{name: r, count: 2}}], links: [{{line: "
                              "'r[*]', both: true, latency_cycles: {}}}]}}\n",
                              more, latency),
                  {}, "trace.json");
  }
  static std::uint64_t cycles(const Json& run) { return run["engine"]["cycles"]; }
};

// Every visit and link is a term of the sum. What the resources take themselves is what a machine of one clock says of
// when the packet leaves them. With faults each frame is late, by the clock of the link.
TEST_F(ThereAndBack, AWayTakesTheCyclesOfItsClocks) {
  const std::uint64_t latency = 100, late = 37;
  const std::string faults = fmt::format("faults: {{seed: 3, links: {{delay: 0.9, delay_cycles: {}}}}}\n", late);
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
  ASSERT_EQ(cycles(run(latency, faults)), cycles(one) + 2 * late);
  for (const std::uint64_t mhz : {2000u, 1499u, 750u, 500u, 333u})
    for (const std::uint64_t wait : {0u, 1u, 2u, 5u}) {
      const std::string clocks = fmt::format("clocks: {{noc: {}, synchroniser_cycles: {}}}\n", mhz, wait);
      for (const std::uint64_t more : {std::uint64_t{0}, late}) {
        const Json two = run(latency, more == 0 ? clocks : clocks + faults);
        const std::uint64_t there = crossed(leaves[0], mhz, wait, on_link + more);
        EXPECT_EQ(cycles(two), crossed(there + visit, mhz, wait, on_link + more) + end) << mhz << " MHz, " << wait;
      }
    }
}

/// Memory at the clock of another part of a drawing, and what it is asked for, one after the other.
class DrawnMemoryClock : public TimedRun {
 protected:
  static constexpr std::uint64_t kCore = 1000, kLatency = 7, kDram = 30;
  struct Clocks {
    std::uint64_t link = kCore, memory = kCore, wait = 0;
  };
  struct Run {
    Json report;
    std::vector<std::uint64_t> requests;  // when each came to memory; those at once are one
  };
  /// One ray at a time, on links that are as wide as anything.
  Run run(const Clocks& clocks) {
    program_.write("one.yaml",
                   fmt::format("scene: {{builtin: terrain, triangles: 600}}\nimage: {{width: 4, height: 2, max_depth: "
                               "1}}\nengine: {{kind: cycle, clock_mhz: {}, what_if: false}}\n"
                               "clocks: {{link: {}, slow: {}, synchroniser_cycles: {}}}\n"
                               "rays: {{slots_per_resource: 1}}\npackets: {{rays: 1}}\nshading: {{workers: 1}}\n"
                               "collections: {{ready: 1, traversal: ordered}}\n"
                               "memory: {{l2_kib: 2, ways: 1, line_bytes: 256, shape_buffer_kib: 4, fetch_ahead: 0, "
                               "dram_latency_cycles: {}, dram_bytes_per_cycle: 65536}}\n"
                               "topology:\n  shape: graph\n"
                               "  nodes: [{{name: r}}, {{name: l2, kind: cache}}, {{name: d, kind: memory, clock: "
                               "slow}}]\n  links:\n"
                               "    - {{from: r, to: l2, both: true, clock: core, carries: [shapes]}}\n"
                               "    - {{from: l2, to: d, both: true, clock: link, latency_cycles: {}, "
                               "bytes_per_cycle: 65536, carries: [shapes]}}\n",
                               kCore, clocks.link, clocks.memory, clocks.wait, kDram, kLatency));
    const Outcome outcome = program_.run({"run", "one.yaml", "--json", "--force", "--dump-memory", "requests.csv"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    Run out{Json::parse(outcome.out), {}};
    std::istringstream lines(program_.read("requests.csv"));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line))
      if (!line.empty() && std::isdigit(static_cast<unsigned char>(line[0])) != 0)
        out.requests.push_back(std::stoull(line));
    out.requests.erase(std::unique(out.requests.begin(), out.requests.end()), out.requests.end());
    return out;
  }
  /// The edge of one clock at which something is there that comes from another.
  static std::uint64_t there(std::uint64_t at, std::uint64_t from, std::uint64_t to, std::uint64_t wait) {
    return from == to ? at : (at * to + from - 1) / from + wait;
  }
};

// Cache to link, link to memory, half of its latency, and back: each by its own clock.
TEST_F(DrawnMemoryClock, AReadTakesTheCyclesOfItsClocks) {
  const Run one = run({});
  // The cache asks for the next line so long after it has got the one before.
  const std::vector<std::uint64_t>& came = one.requests;
  ASSERT_GT(came.size(), 30u);
  constexpr std::uint64_t kDoor = 1, kBytes = 1, kAnswer = kDram / 2;
  const auto asked = [&](std::size_t i) { return came[i] - kDoor - kLatency; };
  const auto got = [&](std::size_t i) { return came[i] + kBytes + kAnswer + kLatency + kDoor; };
  for (std::size_t i = 1; i < came.size(); ++i) ASSERT_GT(asked(i), got(i - 1));
  for (const auto& [link, memory] : std::vector<std::pair<std::uint64_t, std::uint64_t>>{
           {1333, 1000}, {3000, 1000}, {333, 1000}, {1000, 1500}, {2000, 1500}, {1500, 2000}, {333, 3000}, {3000, 333}})
    for (const std::uint64_t wait : {0, 3}) {
      SCOPED_TRACE(fmt::format("link {} MHz, memory {} MHz, {} cycles", link, memory, wait));
      std::vector<std::uint64_t> expected;
      std::uint64_t back = 0;
      for (std::size_t i = 0; i < came.size(); ++i) {
        const std::uint64_t leaves = i == 0 ? asked(0) : back + (asked(i) - got(i - 1));
        const std::uint64_t on_link = there(leaves, kCore, link, wait) + kLatency;
        const std::uint64_t at = there(on_link, link, memory, wait) + kDoor;
        expected.push_back(there(at, memory, kCore, 0));
        const std::uint64_t answered = there(at + kBytes + kAnswer, memory, link, wait) + kLatency;
        back = there(answered, link, kCore, wait) + kDoor;
      }
      const Run other = run({link, memory, wait});
      EXPECT_EQ(other.requests, expected);
      EXPECT_EQ(other.report["engine"]["cycles"].get<std::uint64_t>(),
                one.report["engine"]["cycles"].get<std::uint64_t>() + back - got(came.size() - 1));
      EXPECT_EQ(other.report["digest"], one.report["digest"]);
      EXPECT_EQ(other.report["memory"]["dram_lines"], one.report["memory"]["dram_lines"]);
    }
}

/// A machine that waits for memory alone, whose cycles move `width` bytes.
std::string starved(int width, const std::string& clock, const std::string& clocks) {
  return fmt::format(
      "scene: {{builtin: terrain, triangles: 3000}}\nimage: {{width: 32, height: 24, max_depth: 2}}\n{}"
      "rays: {{slots_per_resource: 256}}\nmemory: {{l2_kib: 2, ways: 2, shape_buffer_kib: 2, dram_bytes_per_cycle: "
      "{}}}\ntopology:\n  shape: graph\n"
      "  nodes: [{{name: r, count: 4}}, {{name: l2, kind: cache}}, {{name: d, kind: memory{}}}]\n  links:\n"
      "    - {{ring: 'r[*]', clock: core}}\n    - {{from: 'r[*]', to: l2, both: true, clock: core, carries: "
      "[shapes]}}\n"
      "    - {{from: l2, to: d, both: true, clock: core, carries: [shapes], bytes_per_cycle: 256}}\n",
      clocks, width, clock);
}

// Bandwidth is bytes a cycle of memory.
TEST_F(MachineClocks, AMemoryMovesItsWidthInACycleOfItsOwn) {
  struct Case {
    int width, mhz;
  };
  const Json core = report(starved(4, "", ""));
  for (const auto [width, mhz] : {Case{1, 4000}, Case{8, 500}, Case{3, 1333}}) {
    SCOPED_TRACE(fmt::format("{} bytes at {} MHz", width, mhz));
    const Json run =
        report(starved(width, ", clock: dram", fmt::format("clocks: {{dram: {}, synchroniser_cycles: 0}}\n", mhz)));
    const std::uint64_t lines =
        run["memory"]["dram_lines"].get<std::uint64_t>() + run["memory"]["dram_lines_written"].get<std::uint64_t>();
    const std::uint64_t moving =
        (run["memory"]["dram_bytes"].get<std::uint64_t>() / run["memory"]["dram_lines"].get<std::uint64_t>() * lines +
         width - 1) /
        width;
    EXPECT_EQ(run["memory"]["dram_busy_cycles"], (moving * 1000 + mhz - 1) / mhz);
    EXPECT_GT(run["memory"]["dram_utilisation"], 0.95);
    EXPECT_LE(run["memory"]["dram_utilisation"], 1.0);
    EXPECT_EQ(run["digest"], core["digest"]);
  }
}

TEST_F(MachineClocks, TheWidthOfDramIsRounded) {
  const auto width = [&](int bytes, int mhz) {
    return ledger_row(
        report(starved(bytes, ", clock: dram", fmt::format("clocks: {{dram: {}}}\n", mhz)), {"image.width=4"}),
        "lines")["width_bytes_per_cycle"];
  };
  EXPECT_EQ(width(8, 700), 6);  // 5.6
  EXPECT_EQ(width(9, 2600), 23);
  EXPECT_EQ(width(3, 100), 1);
}

/// Shapes and rays on links of a machine with caches, memory and shading that are drawn.
std::string drawn_parts(const std::string& clocks, const std::string& a, const std::string& trace = "") {
  return fmt::format(
      "scene: {{builtin: spheres, triangles: 2000}}\nimage: {{width: 24, height: 16, max_depth: 2}}\n"
      "engine: {{clock_mhz: 1500}}\n{0}rays: {{slots_per_resource: 64}}\nmemory: {{l2_kib: 8}}\n"
      "topology:\n  shape: graph\n{2}  nodes:\n    - {{name: r, count: 4}}\n    - {{name: x, kind: router, "
      "latency_cycles: 1{1}}}\n    - {{name: l2, kind: cache, count: 2}}\n    - {{name: d, kind: memory{1}}}\n"
      "    - {{name: pool, kind: shading}}\n  links:\n{3}"
      "    - {{from: 'r[*]', to: x, both: true, latency_cycles: 3, bytes_per_cycle: 16, carries: [shapes, new_rays, "
      "completed_rays]{1}}}\n    - {{from: x, to: 'l2[*]', both: true, carries: [shapes]{1}}}\n"
      "    - {{from: x, to: pool, both: true, bytes_per_cycle: 16, carries: [new_rays, completed_rays]}}\n"
      "    - {{from: 'l2[*]', to: d, both: true, latency_cycles: 6, carries: [shapes]{1}}}\n",
      clocks, a, trace, trace.empty() ? "    - {ring: 'r[*]', carries: [packets, shapes], latency_cycles: 4}\n" : "");
}

// Though a cycle of a slow link may end in a later sample. Routers go by other clocks than their links here.
TEST_F(MachineClocks, NoLinkIsBusierThanItsTime) {
  for (const std::string samples : {"report.samples=60", "report.samples=4000"})
    for (const Json& run :
         {clusters("clocks: {core: 1500, noc: 130, slow: 100}\n", ", clock: slow", ", clock: slow", {samples}),
          clusters("clocks: {core: 1500, noc: 2000, slow: 90}\n", ", clock: slow", ", clock: slow", {samples}),
          report(drawn_parts("clocks: {noc: 2000, a: 90}\n", ", clock: a"), {samples})}) {
      std::size_t links = 0;
      for (const Json& row : run["time_series"]["rows"]) {
        const std::string part = row["part"];
        if (!part.starts_with("link ") || row["quantity"] != "busy") continue;
        double sum = 0;
        for (const double share : row["values"]) {
          ASSERT_LE(share, 1.0) << part << samples;
          sum += share * run["time_series"]["interval"].get<double>();
        }
        EXPECT_NEAR(sum, run["links"][std::stoul(part.substr(5))]["cycles"]["busy"].get<double>(), 17) << part;
        ++links;
      }
      EXPECT_GT(links, 12u);
    }
}

TEST_F(MachineClocks, ForAllThatIsDrawn) {
  for (const std::string trace : {"", "  trace: stacks\n"}) {
    SCOPED_TRACE(trace);
    const Json one = report(drawn_parts("", "", trace));
    const Json equal =
        report(drawn_parts("clocks: {core: 1500, noc: 1500, a: 1500, synchroniser_cycles: 9}\n", ", clock: a", trace));
    EXPECT_EQ(without_host(one), without_host(equal));
    for (const char* clocks : {"clocks: {noc: 2000, a: 500}\n", "clocks: {noc: 700, a: 3000}\n"}) {
      const Json two = report(drawn_parts(clocks, ", clock: a", trace));
      EXPECT_EQ(two["digest"], one["digest"]);
      EXPECT_NE(cycles(two), cycles(one));
      const Json threads = report(drawn_parts(clocks, ", clock: a", trace), {"engine.threads=3"});
      EXPECT_EQ(cycles(threads), cycles(two));
      EXPECT_EQ(threads["links"], two["links"]);
      EXPECT_EQ(threads["time_series"], two["time_series"]);
      ASSERT_EQ(two["clocks"].size(), 3u);
      EXPECT_EQ(two["links"].back()["clock"], "a");
      for (const Json& link : two["links"])
        EXPECT_EQ(link["cycles"]["busy"].get<std::uint64_t>() + link["cycles"]["stalled"].get<std::uint64_t>() +
                      link["cycles"]["idle"].get<std::uint64_t>(),
                  cycles(two));
    }
  }
}

// One ray, whose record comes over a link and whose hit goes back over it.
TEST_F(MachineClocks, ARayTakesTheCyclesOfItsClocks) {
  program_.write("rays.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,900,0,0,1,0,inf\n");
  constexpr std::uint64_t kLatency = 11, kDoor = 1;
  const auto run = [&](std::uint64_t core, std::uint64_t link, std::uint64_t wait) {
    return report(
        fmt::format("scene: {{builtin: terrain, triangles: 18}}\nworkload: {{rays_from: rays.csv}}\n"
                    "engine: {{clock_mhz: {}}}\nclocks: {{noc: {}, synchroniser_cycles: {}}}\n"
                    "topology:\n  shape: graph\n  nodes: [{{name: r}}, {{name: pool, kind: shading}}]\n"
                    "  links: [{{from: pool, to: r, both: true, latency_cycles: {}, bytes_per_cycle: 8, "
                    "carries: [new_rays, completed_rays]}}]\n",
                    core, link, wait, kLatency));
  };
  const auto stage = [](const Json& of, const char* name) { return of["ray_time"][name].get<std::uint64_t>(); };
  const auto next_edge = [](std::uint64_t at, std::uint64_t from, std::uint64_t to) {
    return (at * to + from - 1) / from;
  };
  const Json one = run(1000, 1000, 0);
  // It is made first, and its stages end with the run.
  const std::uint64_t made = cycles(one) - 1 - one["ray_time"]["cycles"].get<std::uint64_t>();
  ASSERT_EQ(stage(one, "slot"), 0u);
  // 68 bytes there, a record and a number, and 64 back.
  const std::uint64_t there = 9 - 1 + kLatency, back = 8 - 1 + kLatency;
  const std::uint64_t leaves = made + stage(one, "load") - kDoor - there;
  const std::uint64_t rest = one["ray_time"]["cycles"].get<std::uint64_t>() - stage(one, "load") -
                             stage(one, "to_shading") - stage(one, "shade_queue") - stage(one, "shading");
  const std::uint64_t after = stage(one, "to_shading") - kDoor - back;
  for (const std::uint64_t core : {1000, 1500, 3000})
    for (const std::uint64_t link : {2000, 1000, 999, 300})
      for (const std::uint64_t wait : {0, 1, 4}) {
        if (core == link) continue;
        SCOPED_TRACE(fmt::format("{} and {} MHz, {} cycles", core, link, wait));
        const auto crossed = [&](std::uint64_t at, std::uint64_t on_link) {
          return next_edge(next_edge(at, core, link) + wait + on_link, link, core) + wait + kDoor;
        };
        const Json two = run(core, link, wait);
        const std::uint64_t loaded = crossed(leaves, there), shaded = crossed(loaded + rest + after, back);
        EXPECT_EQ(stage(two, "load"), loaded - made);
        EXPECT_EQ(stage(two, "to_shading"), shaded - loaded - rest);
        EXPECT_EQ(cycles(two) - cycles(one),
                  loaded - made - stage(one, "load") + stage(two, "to_shading") - stage(one, "to_shading"));
      }
}

}  // namespace
}  // namespace carousel::machine_clocks_test
