// DRAM with banks against rows of results: those of Ramulator 2.1, and those of a second model that looks at every
// waiting request in every cycle.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/ringbus/cycle/memory/dram_patterns.h"

namespace carousel::ringbus {
namespace {

const std::map<std::string, std::pair<std::string, ChannelShape>> kPresetOf = {
    {"GDDR6", {"gddr6_14", kGddr6Shape}}, {"HBM2", {"hbm2_2", kHbm2Shape}}, {"LPDDR5", {"lpddr5_6400", kLpddr5Shape}}};

/// A row of a file of results: standard, pattern, queue, refresh, gap, reads, cycles, row hits, misses and conflicts,
/// mean latency.
struct ResultRow {
  std::string line;
  std::vector<std::string> cell;
  double number(std::size_t i) const { return std::stod(cell[i]); }
  MemoryTraceResult run_here() const {
    const auto& [preset, shape] = kPresetOf.at(cell[0]);
    return run_dram(preset, fmt::format(", queue: {}, refresh: {}", cell[2], cell[3] == "1" ? "true" : "false"),
                    pattern_of(cell[1], shape, std::stoull(cell[5]), std::stoull(cell[4])));
  }
};

std::vector<ResultRow> rows_of(const std::string& name) {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/tests/data/" + name);
  std::vector<ResultRow> out;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    ResultRow row{line, {}};
    std::istringstream cells(line);
    for (std::string one; std::getline(cells, one, ',');) row.cell.push_back(one);
    EXPECT_EQ(row.cell.size(), 11u) << line;
    out.push_back(row);
  }
  return out;
}

/// The rows of a file that Ramulator 2.1 gave, of which the saturated ones with 32 places are tried here; the table in
/// docs/internals/data/dram-rows.md has all.
TEST(Dram, AgreesWithRamulator) {
  std::vector<double> cycle_errors, latency_errors;
  for (const ResultRow& row : rows_of("dram-ramulator21.csv")) {
    if (row.cell[2] != "32" || row.cell[4] != "1") continue;
    const MemoryTraceResult out = row.run_here();
    const double cycles = static_cast<double>(out.last_taken - kRamulatorBegins) / row.number(6) - 1;
    const double latency = (out.dram->channels[0].latencies.mean() + 1) / row.number(10) - 1;
    EXPECT_LT(std::abs(cycles), 0.005) << row.line;
    EXPECT_LT(std::abs(latency), 0.01) << row.line;
    cycle_errors.push_back(std::abs(cycles));
    latency_errors.push_back(std::abs(latency));
  }
  ASSERT_GE(cycle_errors.size(), 16u);
  std::sort(cycle_errors.begin(), cycle_errors.end());
  std::sort(latency_errors.begin(), latency_errors.end());
  EXPECT_LT(cycle_errors[cycle_errors.size() / 2], 0.0005);
  EXPECT_LT(latency_errors[latency_errors.size() / 2], 0.002);
}

/// LPDDR5 takes the cycles of Ramulator 2.1 in each of its rows. Its front end tries to send in every so many cycles
/// only; that a read waits for the next of these cannot be told by a list of requests, so rows that fill the queue with
/// gaps are left out.
TEST(Dram, Lpddr5TakesTheCyclesOfRamulator) {
  std::size_t rows = 0;
  for (const ResultRow& row : rows_of("dram-ramulator21.csv")) {
    const double gap = row.number(4), ideal = (row.number(5) - 1) * gap;
    if (row.cell[0] != "LPDDR5" || (gap > 1 && row.number(6) != ideal)) continue;
    const MemoryTraceResult out = row.run_here();
    EXPECT_EQ(out.last_taken - kRamulatorBegins, std::stoull(row.cell[6])) << row.line;
    // Requests that were not served by the cycle in which the last one took a place are not among Ramulator's.
    EXPECT_NEAR(out.dram->channels[0].latencies.mean() + 1, row.number(10), 0.006 * row.number(10)) << row.line;
    ++rows;
  }
  EXPECT_EQ(rows, 29u);
}

/// To the cycle what tests/validation/dram_scan.py gives, which looks at every waiting request in every cycle: short
/// strips and hot rows, which the rows of Ramulator do not have.
TEST(Dram, AgreesWithAScanOnShortStripsAndHotRows) {
  const std::vector<ResultRow> rows = rows_of("dram-scan.csv");
  ASSERT_GE(rows.size(), 60u);
  for (const ResultRow& row : rows) {
    const MemoryTraceResult out = row.run_here();
    const DramUse::Channel& channel = out.dram->channels[0];
    EXPECT_EQ(out.last_taken - kRamulatorBegins, std::stoull(row.cell[6])) << row.line;
    EXPECT_EQ(channel.counts.row_hits, std::stoull(row.cell[7])) << row.line;
    EXPECT_EQ(channel.counts.row_misses, std::stoull(row.cell[8])) << row.line;
    EXPECT_EQ(channel.counts.row_conflicts, std::stoull(row.cell[9])) << row.line;
    EXPECT_NEAR(channel.latencies.mean(), row.number(10), 1e-6 * row.number(10)) << row.line;
  }
}

}  // namespace
}  // namespace carousel::ringbus
