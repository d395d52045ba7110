// Joules over time: their sum is that of the run, for every kind of part, and the peak is found a second time from the
// samples.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::power_test {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMachine =
    "scene: {builtin: cornell}\n"
    "image: {width: 12, height: 8, samples: 1, max_depth: 2}\n"
    "engine: {kind: cycle, clock_mhz: 1000, what_if: false}\n"
    "topology: {resources: 4}\n"
    "rays: {slots_per_resource: 64}\n"
    "energy: {profile: n45}\n";

class PowerRun : public testing::Test {
 protected:
  Json run(const std::vector<std::string>& sets) {
    program_.write("machine.yaml", kMachine);
    std::vector<std::string> arguments{"run", "machine.yaml", "--out", "out", "--force", "--quiet"};
    add_sets(arguments, sets);
    const Outcome outcome = program_.run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? Json::parse(program_.read("out/report.json")) : Json();
  }
  Program program_;
};

/// The samples of each part of the energy.
std::map<std::string, std::vector<double>> joules_over_time(const Json& report) {
  std::map<std::string, std::vector<double>> out;
  for (const Json& row : report["time_series"]["rows"]) {
    if (row["unit"] != "J") continue;
    EXPECT_EQ(row["part"], "machine");
    EXPECT_EQ(row["kind"], "sum");
    std::string key = row["quantity"].get<std::string>().substr(std::string("energy of ").size());
    std::replace(key.begin(), key.end(), ' ', '_');
    out[key] = row["values"].get<std::vector<double>>();
  }
  return out;
}

TEST_F(PowerRun, TheSamplesAddUpToTheRun) {
  const std::string banks = "memory.dram.preset=gddr6_14",
                    graph =
                        "topology={resources: 4, shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]'}]}";
  for (const std::vector<std::string>& sets : std::vector<std::vector<std::string>>{
           {"topology.shape=ring", "memory.l1_kib=16", "prefetcher.lines=2"},
           {"topology.shape=bidirectional", banks, "rays.banks=4", "rays.reads_per_cycle=0"},
           {"topology.shape=bus", "packets.carry=data", "memory.fetch=packet"},
           {"topology.shape=hierarchical"},
           {"topology.shape=independent", banks},
           {"topology.shape=independent", "testers.simt={warp: 8, warps: 4, compaction: repack}"},
           {"topology.shape=central", "topology.resources=1", "topology.form=distributor"},
           {graph, "clocks.noc=1500"},
           {graph, "collections.when_full=spill", "collections.capacity=1024"}}) {
    SCOPED_TRACE(testing::PrintToString(sets));
    const Json r = run(sets);
    if (r.is_null()) continue;
    const auto parts = joules_over_time(r);
    double all = 0;
    for (const auto& [key, part] : r["energy"]["parts"].items()) {
      const double joules = part["joules"];
      double sum = 0;
      if (parts.contains(key))
        for (const double sample : parts.at(key)) sum += sample;
      EXPECT_NEAR(sum, joules, 1e-12 * joules) << key;
      all += sum;
    }
    EXPECT_GT(parts.size(), 8u);
    EXPECT_NEAR(all / r["energy"]["joules"].get<double>(), 1, 1e-12);
    // Nothing has happened at the beginning, and most of the energy is not in one sample.
    const std::vector<double>& box = parts.at("box_tests");
    EXPECT_EQ(box.size(), r["time_series"]["samples"].get<std::size_t>());
    EXPECT_EQ(box.front(), 0);
    EXPECT_LT(*std::max_element(box.begin(), box.end()),
              0.5 * r["energy"]["parts"]["box_tests"]["joules"].get<double>());
  }
}

// The row of bytes is made from other counters. A byte through the port of a link is 0.45 pJ, and its number of 32
// bits.
TEST_F(PowerRun, TheSamplesFollowTheBytes) {
  const Json r = run({});
  const std::vector<double> joules = joules_over_time(r).at("ports");
  const Json& rows = r["time_series"]["rows"];
  const auto row = std::ranges::find_if(
      rows, [](const Json& one) { return one["part"] == "machine" && one["quantity"] == "bytes on links"; });
  ASSERT_NE(row, rows.end());
  const auto bytes = (*row)["values"].get<std::vector<double>>();
  ASSERT_EQ(bytes.size(), joules.size());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    EXPECT_NEAR(joules[i], 1e-12 * double{0.45f} * bytes[i], 1e-20) << "sample " << i;
}

// Samples of 4 cycles, which 100 is a multiple of.
TEST_F(PowerRun, ThePeakIsThatOfTheSamples) {
  for (const std::string size : {"4", "6"}) {
    const Json r = run({"report.samples=65536", "topology.resources=1", "image.height=4", "image.width=" + size});
    const double interval = r["time_series"]["interval"];
    ASSERT_LE(interval, 4) << "a smaller frame would do";
    const auto parts = joules_over_time(r);
    const auto each = static_cast<std::size_t>(100 / interval);
    const std::size_t slots = r["engine"]["cycles"].get<std::size_t>() / 100;
    ASSERT_GT(slots, 12u);
    const auto energy = [&](const std::vector<double>& of, std::size_t first, std::size_t count) {
      double sum = 0;
      for (std::size_t i = first * each; i < (first + count) * each; ++i) sum += of[i];
      return sum;
    };
    double most = 0, around = 0;
    std::size_t at = 0;
    for (std::size_t first = 0; first + 10 <= slots; ++first) {
      double window = 0, more = 0;
      for (const auto& [key, of] : parts) {
        window += energy(of, first, 10);
        if (first + 11 <= slots) more += energy(of, first, 11);
      }
      if (window > most * (1 + 1e-12)) most = window, at = first;
      around = std::max(around, more);
    }
    double end = 0;  // the last windows end between two slots, or with the run
    for (const auto& [key, of] : parts)
      for (std::size_t i = (slots - 10) * each; i < of.size(); ++i) end += of[i];
    around = std::max(around, end);
    const Json& peak = r["energy"]["peak"];
    EXPECT_EQ(peak["cycles"], 1000);
    EXPECT_EQ(peak["resolution"], 100);
    EXPECT_EQ(peak["first_cycle"].get<std::size_t>(), 100 * at);
    EXPECT_NEAR(peak["watts"].get<double>() / (most * 1e6), 1, 1e-9);
    EXPECT_NEAR(peak["watts_at_most"].get<double>() / (around * 1e6), 1, 1e-9);
    EXPECT_GE(peak["watts"].get<double>(), r["energy"]["watts"].get<double>());
    std::string greatest;
    double share = 0;
    for (const auto& [key, of] : parts)
      if (const double own = energy(of, at, 10) / most; own > share) share = own, greatest = key;
    EXPECT_EQ(peak["part"], greatest);
    EXPECT_NEAR(peak["part_share"].get<double>(), share, 1e-9);
  }
}

TEST_F(PowerRun, DependsOnNoThreadAndChangesNothing) {
  const auto told = [&](const std::vector<std::string>& sets) {
    Json r = run(sets);
    for (const char* key : {"host", "config", "checksum", "carousel"}) r.erase(key);
    return r;
  };
  const Json one = told({"engine.threads=1", "topology.resources=8"});
  EXPECT_EQ(one, told({"engine.threads=3", "topology.resources=8"}));
  const Json without = told({"engine.threads=1", "topology.resources=8", "energy.profile=none"});
  for (const char* key : {"digest", "engine", "tests", "throughput", "bytes", "memory"})
    EXPECT_EQ(one[key], without[key]) << key;
}

TEST_F(PowerRun, AShortRunHasNoPeak) {
  const Json r = run({"image.width=1", "image.height=1", "image.max_depth=1", "topology.resources=1",
                      "memory.dram_latency_cycles=10", "memory.l2_latency_cycles=2"});
  ASSERT_LT(r["engine"]["cycles"].get<int>(), 1000);
  EXPECT_FALSE(r["energy"].contains("peak"));
}

}  // namespace
}  // namespace carousel::power_test
