// The memory by itself, as a user runs it: a run's requests written to a file and played again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::memory_trace_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

const std::string kMachine =
    "scene: {builtin: terrain, triangles: 2000}\nimage: {width: 24, height: 16, samples: 1, max_depth: 3}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\ntopology: {resources: 4}\nrays: {slots_per_resource: 64}\n"
    "packets: {rays: 8}\ncollections: {ready: 8, capacity: 16384}\n";

// Others reported this kind of fault: ramulator2 104, 113.
TEST(MemoryTrace, PlaysWhatARunAskedFor) {
  const Program program;
  const std::string memory = "memory: {l2_kib: 4, dram: {preset: gddr6_14, queue: 8}}\n";
  program.write("machine.yaml", kMachine + memory);
  program.write("alone.yaml", "engine: {kind: cycle}\nworkload: {memory_trace: memory.csv}\n" + memory);
  const Outcome outcome = program.run({"run", "machine.yaml", "--dump-memory", "memory.csv"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json run = Json::parse(program.read("out/machine/report.json"));
  EXPECT_EQ(schema_problems(report::report_schema(), run), std::vector<std::string>{});
  ASSERT_EQ(program.run({"run", "alone.yaml"}).status, 0);
  const Json alone = Json::parse(program.read("out/alone/report.json"));
  EXPECT_EQ(schema_problems(report::report_schema(), alone), std::vector<std::string>{});

  EXPECT_EQ(alone["memory_trace"]["reads"], run["memory"]["dram_lines"]);
  EXPECT_EQ(alone["memory_trace"]["bytes"], run["memory"]["dram_bytes"]);
  const Json &own = run["memory"]["dram"]["channels"], &again = alone["memory_trace"]["dram"]["channels"];
  ASSERT_EQ(own.size(), 2u);
  std::uint64_t bytes = 0;
  for (std::size_t c = 0; c < own.size(); ++c) {
    bytes += own[c]["bytes"].get<std::uint64_t>();
    const std::uint64_t rows = own[c]["row_hits"].get<std::uint64_t>() + own[c]["row_misses"].get<std::uint64_t>() +
                               own[c]["row_conflicts"].get<std::uint64_t>();
    EXPECT_EQ(rows, own[c]["reads"]);
    for (const char* key : {"reads", "row_hits", "row_misses", "row_conflicts", "latency"})
      EXPECT_EQ(again[c][key], own[c][key]) << key;
  }
  EXPECT_EQ(bytes, run["memory"]["dram_bytes"]);

  // The pipe plays the same requests, and others are found where the machine waits for them differently.
  ASSERT_EQ(program.run({"run", "alone.yaml", "--set", "memory.dram.preset=pipe", "--out", "pipe"}).status, 0);
  const Json pipe = Json::parse(program.read("pipe/report.json"));
  EXPECT_EQ(pipe["memory_trace"]["requests"], alone["memory_trace"]["requests"]);
  EXPECT_FALSE(pipe["memory_trace"].contains("dram"));
}

TEST(MemoryTrace, BanksChangeCyclesAndNoHits) {
  const Program program;
  program.write("machine.yaml", kMachine);
  std::vector<Json> reports;
  for (const std::string preset : {"pipe", "gddr6_14", "hbm2_2", "lpddr5_6400"}) {
    ASSERT_EQ(program.run({"run", "machine.yaml", "--set", "memory.dram.preset=" + preset, "--out", preset}).status, 0);
    reports.push_back(Json::parse(program.read(preset + "/report.json")));
  }
  for (std::size_t i = 1; i < reports.size(); ++i) {
    EXPECT_EQ(reports[i]["digest"], reports[0]["digest"]);
    EXPECT_NE(reports[i]["engine"]["cycles"], reports[0]["engine"]["cycles"]);
    EXPECT_GT(reports[i]["memory"]["dram"]["row_hit_fraction"], 0);
  }
}

TEST(MemoryTrace, RefusesBadFilesByTheirPlaces) {
  const Program program;
  const std::string machine = "engine: {kind: cycle}\nworkload: {memory_trace: memory.csv}\n";
  program.write("alone.yaml", machine);
  EXPECT_THAT(program.run({"run", "alone.yaml"}).err,
              HasSubstr("alone.yaml:2:26: workload.memory_trace: expected a file of memory requests"));
  const auto error_of = [&](const std::string& text) {
    program.write("memory.csv", text);
    const Outcome outcome = program.run({"run", "alone.yaml"});
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  const std::string header = "cycle,kind,address,bytes\n";
  EXPECT_THAT(error_of("cycle,address\n"), HasSubstr("memory.csv:1:1: expected the header cycle,kind,address,bytes"));
  EXPECT_THAT(error_of(header + "1,read,0\n"), HasSubstr("memory.csv:2:1: expected 4 values, found 3"));
  EXPECT_THAT(error_of(header + "1,reads,0,32\n"), HasSubstr("memory.csv:2:3: expected read or write, found 'reads'"));
  EXPECT_THAT(error_of(header + "1,read,0,0\n"), HasSubstr("memory.csv:2:10: expected a whole number from 1 to 65536"));
  EXPECT_THAT(error_of(header + "2,read,0,32\n1,read,0,32\n"),
              HasSubstr("memory.csv:3:1: requests stand in the order"));
  EXPECT_THAT(error_of(header), HasSubstr("memory.csv:2: expected at least one request, found none"));
  EXPECT_THAT(error_of(header + "1,read,0,32\n# rows: 2\n"),
              HasSubstr("memory.csv:3:1: this line says that the list holds 2 requests; expected as many, found 1"));
  EXPECT_THAT(error_of(header + "1,read,0,32\n# rows: 1, incomplete\n"),
              HasSubstr("memory.csv:3:1: the run that wrote this list was interrupted"));
  program.write("native.yaml", "scene: {builtin: cornell}\n");
  EXPECT_THAT(program.run({"run", "native.yaml", "--dump-memory", "a.csv"}).err,
              HasSubstr("--dump-memory: the native engine has no simulated memory"));
  EXPECT_THAT(program.run({"run", "alone.yaml", "--set", "engine.kind=native"}).err,
              HasSubstr("engine.kind: workload: memory_trace runs in virtual time; expected cycle, found native"));
  EXPECT_THAT(program.run({"run", "alone.yaml", "--set", "memory={line_bytes: 16, dram: {preset: hbm2_2}}"}).err,
              HasSubstr("memory.line_bytes: DRAM with banks moves 32 bytes at a time; expected a multiple of 32"));
}

}  // namespace
}  // namespace carousel::memory_trace_test
