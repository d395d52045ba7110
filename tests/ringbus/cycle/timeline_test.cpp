// The timeline: slices of one track never overlap, those of units and links add up to their busy cycles, and all are
// the same on any number of threads.
#include <map>
#include <optional>

#include <gtest/gtest.h>

#include "tests/ringbus/identity/machine_space.h"

namespace carousel::ringbus {
namespace {

Cell recorded_machine(std::uint32_t seed, const std::string& shape = "", const std::string& engine = "cycle") {
  std::mt19937 random(seed);
  std::vector<std::string> with{"engine.kind=" + engine, "faults.resource.kind=none", "test.link_faults=false"};
  if (!shape.empty()) with.push_back("topology.shape=" + shape);
  Cell cell = all_machines().draw_cell(random, with);
  cell.timeline.most = 100'000'000;
  return cell;
}

/// Time of all slices of a track.
std::map<std::string, std::uint64_t> times_of(const Timeline& timeline) {
  std::map<std::string, std::uint64_t> times;
  for (const Slice& slice : timeline.slices) {
    const SliceTrack& track = timeline.tracks[slice.track];
    times[track.part + ", " + track.name] += slice.end - slice.begin;
  }
  return times;
}

void expect_no_overlap(const Timeline& timeline) {
  std::map<std::uint32_t, std::uint64_t> ends;
  std::uint64_t last = 0;
  for (const Slice& slice : timeline.slices) {
    EXPECT_LT(slice.begin, slice.end + (slice.kind != SliceKind::kUnits));
    EXPECT_LE(slice.end, timeline.end);
    EXPECT_GE(slice.begin, last);
    EXPECT_GE(slice.begin, ends[slice.track])
        << timeline.tracks[slice.track].part << ", " << timeline.tracks[slice.track].name;
    last = slice.begin;
    ends[slice.track] = slice.end;
  }
}

TEST(CycleTimeline, AddsUpToTheBusyCycles) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 300, 3);
  const std::vector<std::string> shapes{"", "hierarchical", "bus", "independent", ""};
  std::uint64_t trips = 0;
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(20)); ++seed) {
    const Cell cell = recorded_machine(seed + 500, shapes[seed % shapes.size()]);
    const Outcome out = run_cell(scene, cell);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    ASSERT_EQ(out.fault, "");
    const Timeline& timeline = *out.result.timeline;
    EXPECT_FALSE(timeline.cut);
    expect_no_overlap(timeline);
    std::map<std::string, std::uint64_t> times = times_of(timeline);
    const cycle::CycleResult& c = *out.result.cycle;
    for (std::size_t r = 0; r < c.tiles.size(); ++r) {
      const std::string part = "resource " + std::to_string(r);
      const bool distributed = has_distributor(cell.config);
      const auto testers = static_cast<std::uint64_t>(own_testers(cell.config));
      for (const auto [kind, use] : c.tiles[r].units) {
        std::uint64_t busy = 0;
        for (std::uint64_t t = 0; t < testers; ++t)
          busy += times[fmt::format("{}, {}{} units", part, distributed ? fmt::format("tester {}, ", t) : "",
                                    unit_row(kind).name)];
        EXPECT_EQ(busy / testers, use.busy) << part << ", " << unit_row(kind).name;
      }
      EXPECT_EQ(times[part + ", ray reads"], c.tiles[r].ray_reads.busy) << part;
      EXPECT_EQ(times[part + ", primitive ray reads"], c.tiles[r].primitive_ray_reads.busy) << part;
      EXPECT_EQ(times[part + ", dispatch"], c.tiles[r].dispatch.busy) << part;
    }
    for (std::size_t l = 0; l < c.links.size(); ++l)
      EXPECT_EQ(times["links, link " + std::to_string(l) + ": " + std::to_string(c.links[l].from) + " to " +
                      std::to_string(c.links[l].to)],
                c.links[l].use.busy);
    // A packet's way begins where it is issued and ends where it retires.
    std::map<std::uint64_t, std::pair<SliceKind, SliceKind>> ways;
    for (const Slice& slice : timeline.slices)
      if (slice.trip != 0) ways.try_emplace(slice.trip, slice.kind, slice.kind).first->second.second = slice.kind;
    EXPECT_EQ(ways.size(), out.sum.packets_issued);
    for (const auto& [trip, ends] : ways) EXPECT_EQ(ends.first, SliceKind::kIssue);
    trips += ways.size();
  }
  EXPECT_GT(trips, 0u);
}

TEST(CycleTimeline, IsTheSameOnAnyNumberOfThreadsAlsoWhereItIsCut) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 200, 2);
  int cut = 0;
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(6)); ++seed) {
    Cell cell = recorded_machine(seed + 600);
    cell.timeline.most = (seed - run_seed()) % 2 == 0 ? 500 : 100'000'000;  // the first one, where there is no other
    std::optional<Timeline> alone;
    for (const std::size_t threads : {1, 2, 3}) {
      cell.threads = threads;
      const Outcome out = run_cell(scene, cell);
      ASSERT_EQ(out.fault, "") << "seed " << seed << ": " << cell.text();
      if (!alone) alone = out.result.timeline;
      EXPECT_TRUE(*out.result.timeline == *alone) << "seed " << seed << ", " << threads << " threads: " << cell.text();
    }
    cut += alone->cut;
  }
  EXPECT_GT(cut, 0);
}

TEST(CycleTimeline, ChangesNoCycle) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 100, 2);
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(6)); ++seed) {
    Cell cell = recorded_machine(seed + 700);
    const Outcome with = run_cell(scene, cell);
    cell.timeline = {};
    const Outcome without = run_cell(scene, cell);
    ASSERT_EQ(with.fault, "") << cell.text();
    EXPECT_TRUE(*with.result.cycle == *without.result.cycle) << cell.text();
    EXPECT_FALSE(without.result.timeline);
  }
}

TEST(CycleTimeline, KeepsAWindowAndEveryNthPacket) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 300, 2);
  Cell cell = recorded_machine(811, "ring");
  const Timeline whole = *run_cell(scene, cell).result.timeline;
  cell.timeline.first = whole.end / 4;
  cell.timeline.end = whole.end / 2;
  std::vector<Slice> expected;
  for (const Slice& slice : whole.slices)
    if (slice.begin >= cell.timeline.first && slice.begin < cell.timeline.end) expected.push_back(slice);
  EXPECT_FALSE(expected.empty());
  EXPECT_TRUE(run_cell(scene, cell).result.timeline->slices == expected);

  cell.timeline = {.every = 3, .most = 100'000'000};
  const Outcome out = run_cell(scene, cell);
  std::set<std::uint64_t> trips;
  for (const Slice& slice : out.result.timeline->slices) {
    EXPECT_NE(slice.trip, 0u);
    trips.insert(slice.trip);
  }
  std::uint64_t third = 0;
  for (const ResourceStatistics& r : out.result.resources) third += (r.packets_issued + 2) / 3;
  EXPECT_EQ(trips.size(), third);
}

TEST(NativeTimeline, HasSlicesThatDoNotOverlap) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 200, 2);
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(6)); ++seed) {
    Cell cell = recorded_machine(seed + 900, "ring", "native");
    cell.threads = 2;
    const Outcome out = run_cell(scene, cell);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    ASSERT_EQ(out.fault, "");
    expect_no_overlap(*out.result.timeline);
    EXPECT_FALSE(out.result.timeline->slices.empty());
  }
}

}  // namespace
}  // namespace carousel::ringbus
