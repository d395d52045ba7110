// Kinds of fault that other simulators had, as runs whose answers follow from the configuration.
// Each names the issue that reported it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sched.h>

#include "tests/app/support/program.h"

namespace carousel::case_runs_test {
namespace {

using Json = nlohmann::ordered_json;

/// Cycles are counted in 64 bits: a request that comes 10^11 cycles later is answered 10^11 cycles later.
// Others reported this kind of fault: astra-sim 58, Mesen 598.
TEST(CaseRuns, CyclesBeyondTwoToTheThirtySecond) {
  const Program program;
  program.write("a.yaml", "engine: {kind: cycle}\nworkload: {memory_trace: memory.csv}\n");
  for (const std::string dram : {"pipe", "gddr6_14"}) {
    SCOPED_TRACE(dram);
    std::vector<std::uint64_t> cycles;
    for (const std::string at : {"0", "100000000000"}) {
      program.write("memory.csv", "cycle,kind,address,bytes\n" + at + ",read,0,32\n");
      const Outcome outcome = program.run(
          {"run", "a.yaml", "--set", "memory.dram={preset: " + dram + ", refresh: false}", "--force", "--quiet"});
      ASSERT_EQ(outcome.status, 0) << outcome.err;
      cycles.push_back(Json::parse(program.read("out/a/report.json"))["engine"]["cycles"]);
    }
    // DRAM has a clock of its own: a command waits for its next edge.
    const std::uint64_t later = cycles[1] - cycles[0];
    EXPECT_GE(later, 100'000'000'000u - 1);
    EXPECT_LE(later, 100'000'000'000u + 1);
  }
}

/// The head of a packet takes four cycles to the neighbour, the rest follows a flit of 32 bytes a cycle.
// Others reported this kind of fault: supersim 15.
TEST(CaseRuns, PacketsOfOneToManyBytes) {
  const Program program;
  program.write(
      "a.yaml",
      "engine: {kind: cycle}\n"
      "topology: {resources: 8, link: {latency_cycles: 4, bytes_per_cycle: 32, depth: 16}}\n"
      "workload: {traffic: {pattern: neighbour, rate: 0.00005, packets: 80, packet_bytes: 1, inject_cycles: 0, "
      "eject_cycles: 0, warmup_fraction: 0}}\n");
  for (const std::uint64_t bytes : {1u, 31u, 32u, 33u, 4096u, 65535u}) {
    SCOPED_TRACE(bytes);
    const Outcome outcome = program.run(
        {"run", "a.yaml", "--set", "workload.traffic.packet_bytes=" + std::to_string(bytes), "--force", "--quiet"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json traffic = Json::parse(program.read("out/a/report.json"))["traffic"];
    const std::uint64_t flits = (bytes + 31) / 32;
    EXPECT_EQ(traffic["delivered"], 80);
    EXPECT_LE(traffic["flit_hops"], 80 * flits);  // flits that are on links when the window closes do not count
    EXPECT_GE(traffic["flit_hops"], 77 * flits);
    const double alone = 4 + static_cast<double>(flits - 1);
    EXPECT_NEAR(traffic["latency"]["quantiles"][0]["cycles"].get<double>(), alone, alone / 1000);
  }
}

/// The program may use fewer cores than the machine has. Here it has one, which all its threads share.
// Others reported this kind of fault: oneTBB.
TEST(CaseRuns, OneCoreGivesTheSameHits) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 1}\n");
  cpu_set_t all, one;
  CPU_ZERO(&all);
  CPU_ZERO(&one);
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  int first = 0;
  while (!CPU_ISSET(first, &all)) ++first;
  CPU_SET(first, &one);
  ASSERT_EQ(program.run({"run", "a.yaml", "--out", "all", "--quiet"}).status, 0);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  const Outcome outcome = program.run({"run", "a.yaml", "--out", "one", "--quiet"});
  sched_setaffinity(0, sizeof all, &all);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(Json::parse(program.read("one/report.json"))["digest"],
            Json::parse(program.read("all/report.json"))["digest"]);
}

}  // namespace
}  // namespace carousel::case_runs_test
