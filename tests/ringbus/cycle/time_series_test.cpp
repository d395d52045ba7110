// The time series of the cycle engine: the same on any number of threads, and its sums are the totals of the run.
#include <map>
#include <optional>

#include <gtest/gtest.h>

#include "tests/ringbus/identity/machine_space.h"

namespace carousel::ringbus {
namespace {

using Kind = SeriesRow::Kind;

Cell series_machine(std::uint32_t seed, const std::string& shape = "") {
  std::mt19937 random(seed);
  std::vector<std::string> with{"engine.kind=cycle", "faults.resource.kind=none"};
  if (!shape.empty()) with.push_back("topology.shape=" + shape);
  if (shape == "hierarchical") with.insert(with.end(), {"topology.groups=3", "collections.home!=local"});  // bridges
  Cell cell = all_machines().draw_cell(random, with);
  cell.samples = 16 + seed % 100;
  return cell;
}

/// The sum of a row over all samples, of a mean times the cycles of a sample; 0 for a row that was left out.
double total(const TimeSeries& series, const std::string& part, const std::string& quantity) {
  for (const SeriesRow& row : series.rows) {
    if (row.part != part || row.quantity != quantity) continue;
    EXPECT_EQ(row.values.size(), series.samples);
    double sum = 0;
    for (const double value : row.values) sum += value;
    return row.kind == Kind::kMean ? sum * series.interval : sum;
  }
  return 0;
}

TEST(CycleTimeSeries, IsTheSameOnAnyNumberOfThreads) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 60, 2);
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(6)); ++seed) {
    Cell cell = series_machine(seed + 7000);
    std::optional<TimeSeries> alone;
    for (const std::size_t threads : {1, 2, 3}) {
      cell.threads = threads;
      const Outcome out = run_cell(scene, cell);
      ASSERT_EQ(out.fault, "") << "seed " << seed << ": " << cell.text();
      ASSERT_TRUE(out.result.series);
      if (!alone) alone = out.result.series;
      EXPECT_TRUE(*out.result.series == *alone) << "seed " << seed << ", " << threads << " threads: " << cell.text();
    }
  }
}

TEST(CycleSeriesTotals, AddsUpToTheTotalsOfTheRun) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 600, 3);
  std::uint64_t dram = 0, bridges = 0;
  const std::vector<std::string> shapes{"", "hierarchical", "bus", "independent", ""};
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(25)); ++seed) {
    const Cell cell = series_machine(seed + 8000, shapes[seed % shapes.size()]);
    const Outcome out = run_cell(scene, cell);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    ASSERT_EQ(out.fault, "");
    const cycle::CycleResult& c = *out.result.cycle;
    const TimeSeries& series = *out.result.series;
    EXPECT_LE(series.samples, cell.samples);
    EXPECT_GE(series.interval * static_cast<double>(series.samples), static_cast<double>(c.cycles));
    const auto is = [&](const std::string& part, const std::string& quantity, std::uint64_t expected) {
      EXPECT_EQ(total(series, part, quantity), static_cast<double>(expected)) << part << ", " << quantity;
    };
    is("machine", "rays completed", out.result.rays_completed);
    is("machine", "shader workers busy", c.shading.busy);
    const MemoryConfig& memory = cell.config.memory;
    const auto line = static_cast<std::uint64_t>(memory.l2_sector_bytes.value_or(memory.line_bytes));
    is("machine", "bytes of DRAM", (c.memory.lines + c.memory.lines_written) * line);
    dram += c.memory.lines;
    std::uint64_t packet_cycles = 0, link_bytes = 0;
    double held = 0;
    for (std::size_t r = 0; r < c.tiles.size(); ++r) {
      const std::string part = "resource " + std::to_string(r);
      for (const auto [kind, use] : c.tiles[r].units) is(part, std::string(unit_row(kind).name) + " busy", use.busy);
      is(part, "ray reads busy", c.tiles[r].ray_reads.busy);
      is(part, "primitive ray reads busy", c.tiles[r].primitive_ray_reads.busy);
      is(part, "dispatch busy", c.tiles[r].dispatch.busy);
      is(part, "packets under way", c.tiles[r].packet_cycles);
      is(part, "rays completed", out.result.resources[r].rays_completed);
      is(part, "rays tested", out.result.resources[r].local_rays);
      packet_cycles += c.tiles[r].packet_cycles;
      held += total(series, part, "rays held");
    }
    is("machine", "packets under way", packet_cycles);
    EXPECT_GT(held, 0);
    EXPECT_EQ(total(series, "machine", "rays held"), held);
    for (std::size_t l = 0; l < c.links.size(); ++l) {
      is("link " + std::to_string(l), "bytes", c.links[l].bytes);
      is("link " + std::to_string(l), "busy", c.links[l].use.busy);
      link_bytes += c.links[l].bytes;
      bridges += c.links[l].from >= c.tiles.size() && c.links[l].bytes > 0;
    }
    is("machine", "bytes on links", link_bytes);
  }
  EXPECT_GT(dram, 0u);
  if (cell_count(25) >= 2 * static_cast<int>(shapes.size())) {  // fewer, under a sanitizer, leave it to chance
    EXPECT_GT(bridges, 0u);
  }
}

// No level exceeds what the machine can hold, no share 1, and nothing is held or busy in a time without rays.
TEST(CycleSeriesTotals, StaysWithinTheMachine) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 400, 2);
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(12)); ++seed) {
    const Cell cell = series_machine(seed + 9000);
    const Outcome out = run_cell(scene, cell);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    ASSERT_EQ(out.fault, "");
    const double slots = static_cast<double>(cell.config.rays.slots_per_resource);
    for (const SeriesRow& row : out.result.series->rows) {
      for (const double value : row.values) {
        EXPECT_GE(value, 0) << row.part << ", " << row.quantity;
        if (row.unit == "share") {
          EXPECT_LE(value, 1) << row.part << ", " << row.quantity;
        }
        // Bundles have slots beside those of their rays.
        if (row.quantity == "rays held" && row.part != "machine" && cell.config.bundles.size == 0) {
          EXPECT_LE(value, slots) << row.part;
        }
      }
    }
  }
}

TEST(CycleSeriesTotals, IsAbsentUnlessItIsAskedFor) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 60, 2);
  Cell cell = series_machine(1);
  cell.samples = 0;
  EXPECT_FALSE(run_cell(scene, cell).result.series);
}

TEST(MostSamples, AreFewerForManyRows) {
  EXPECT_EQ(most_samples(256, 100), 256u);
  EXPECT_EQ(most_samples(256, 4096), 64u);
  EXPECT_EQ(most_samples(256, 1'000'000), 16u);
  EXPECT_EQ(most_samples(0, 100), 0u);
}

}  // namespace
}  // namespace carousel::ringbus
