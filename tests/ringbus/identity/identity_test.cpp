// No arrangement of threads, links, queues, policies and faults may change a hit: every machine of the covering array
// and every machine drawn at random has the digest of the reference tracer at its level of accuracy.
#include <iostream>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/accel/traverse/levels.h"
#include "tests/ringbus/identity/covering_array.h"
#include "tests/ringbus/identity/scenes.h"
#include "tests/ringbus/support/watchdog.h"

namespace carousel::ringbus {
namespace {

const CoveringArray& the_array() {
  static const CoveringArray array = covering_array(all_machines(), run_seed());
  return array;
}

// Of the same suite as the machines that run, since to make the array takes longer than to run most of them.
// Others reported this kind of fault: tt-metal 33222, 54626.
TEST(Identity, TheArrayHoldsEveryPairThatAMachineCanHave) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  MachineSpace& space = all_machines();
  const CoveringArray& array = the_array();
  std::set<std::array<std::size_t, 4>> held;
  for (const Row& row : array.rows) {
    EXPECT_NO_THROW((void)space.cell(row));
    for (std::size_t f = 0; f < row.size(); ++f) {
      EXPECT_EQ(row[f] != kAbsent, space.is_read(row, f)) << space.factors()[f].key;
      for (std::size_t g = f + 1; g < row.size(); ++g)
        if (row[f] != kAbsent && row[g] != kAbsent)
          held.insert({f, g, static_cast<std::size_t>(row[f]), static_cast<std::size_t>(row[g])});
    }
  }
  EXPECT_EQ(held.size(), array.covered);
  EXPECT_EQ(array.covered + array.infeasible.size(), array.pairs);
  std::mt19937 random(run_seed());
  for (const LevelPair& pair : array.infeasible) {  // drawn without what the space has learned from the validator
    const Row row = space.draw_any(random, space.domains_of_pair(pair.f, pair.a, pair.g, pair.b));
    EXPECT_THROW((void)space.cell(row), ConfigError) << fmt::format("{}", fmt::join(space.assignments(row), " "));
  }
  std::cout << space.factors().size() << " factors, " << array.pairs << " pairs of levels: " << array.covered
            << " covered by " << array.rows.size() << " machines, " << array.infeasible.size()
            << " refused by the validator; no machine has "
            << fmt::format("{}", fmt::join(space.levels_never_accepted(), ", ")) << "\n";
}

/// Sums over machines that show that rare paths were taken.
struct Seen {
  BundleCounts bundles;
  IntersectionCounts tests;
  std::uint64_t transforms_spared = 0, restarted = 0, resent = 0, discarded = 0, packets_discarded = 0, spilled = 0;

  void add(const Outcome& outcome) {
    for (const BundleCounts& at_depth : outcome.sum.bundles) bundles += at_depth;
    tests += outcome.sum.tests;
    for (const CullLevel& level : outcome.sum.culls.above) transforms_spared += level.transforms;
    restarted += outcome.result.rays_restarted;
    packets_discarded += outcome.result.packets_discarded;
    spilled += outcome.spilled;
    for (const LinkResult& link : outcome.result.links) {
      resent += link.faults.resent;
      discarded += link.faults.discarded;
    }
  }
  void expect_all() const {
    for (const auto& [name, count] : std::map<std::string, std::uint64_t>{{"bundles formed", bundles.formed},
                                                                          {"all rays hit", bundles.all},
                                                                          {"no ray hits", bundles.none},
                                                                          {"bundles split", bundles.split},
                                                                          {"bundles taken apart", bundles.taken_apart},
                                                                          {"bundles sent back", bundles.returned},
                                                                          {"boxes culled", tests.culled},
                                                                          {"any-hit calls", tests.any_hit_calls},
                                                                          {"procedural tests", tests.procedural},
                                                                          {"transforms spared", transforms_spared},
                                                                          {"rays restarted", restarted},
                                                                          {"frames resent", resent},
                                                                          {"frames discarded", discarded},
                                                                          {"packets discarded", packets_discarded},
                                                                          {"rays spilled", spilled}})
      EXPECT_GT(count, 0u) << name;
  }
};

/// The engine's machines of the array, and `random_machines` more.
void expect_one_digest(const std::string& engine, int random_machines) {
  SCOPED_TRACE(fmt::format("CAROUSEL_SEED={}", run_seed()));
  MachineSpace& space = all_machines();
  Scenes scenes;
  Seen seen;
  std::set<std::string> levels;
  int machines = 0;
  const auto run = [&](Cell cell) {
    Watchdog watchdog(std::chrono::seconds(60), cell.text());
    cell.stop = watchdog.token();
    const Outcome outcome = run_cell(scenes.of(cell), cell);
    EXPECT_EQ(outcome.fault, "") << cell.text();
    seen.add(outcome);
    levels.insert(accel::text(cell.config.accuracy) + " " + std::string(enum_name(cell.config.accuracy.transform)));
    ++machines;
  };
  std::vector<std::string> with{"engine.kind=" + engine};
  if (kThreadSanitizer) {
    with.push_back("engine.threads=2");
  } else {
    for (const Row& row : the_array().rows) {
      const Cell cell = space.cell(row);
      if (enum_name(cell.config.engine.kind) == engine) run(cell);
    }
  }
  std::mt19937 random(7919 * run_seed());
  for (int i = cell_count(random_machines); i > 0; --i) run(space.draw_cell(random, with));
  // Few of the others form bundles that go back, or small ones that miss a box together.
  const std::vector<std::string> bundles{"bundles.builder.threshold=100", "bundles.builder.same_origin=false",
                                         "test.split_early=false"},
      back{"bundles.size=16", "bundles.split=untested", "bundles.builder.same_signs=false",
           "collections.when_full=spill"},
      alike{"bundles.size=2", "bundles.builder.same_signs=true", "bundles.order=any_hit_first", "bvh.elements=boxes"};
  // Which bundles form depends on the host's threads, too.
  for (const auto& [more, rare] : {std::pair{back, &BundleCounts::returned}, std::pair{alike, &BundleCounts::none}}) {
    std::vector<std::string> all = with;
    all.insert(all.end(), bundles.begin(), bundles.end());
    all.insert(all.end(), more.begin(), more.end());
    for (int i = std::max(cell_count(20), 8); i > 0 || (!kThreadSanitizer && seen.bundles.*rare == 0 && i > -40); --i)
      run(space.draw_cell(random, all));
  }
  if (!kThreadSanitizer) seen.expect_all();
  std::cout << machines << " machines, at " << levels.size() << " levels of accuracy\n";
}

TEST(Identity, NativeMachinesGiveTheReferenceTracersDigest) {
  expect_one_digest("native", 60);
}
TEST(Identity, MachinesUnderVirtualTimeGiveTheReferenceTracersDigest) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  expect_one_digest("cycle", 60);
}

// Threads take turns on a core in the middle of a step.
// Others reported this kind of fault: oneTBB.
TEST(Identity, MoreThreadsThanCores) {
  Scenes scenes;
  std::mt19937 random(6151 * run_seed());
  const std::vector<std::string> with{"engine.kind=native", "topology.resources=16", "test.link_faults=false"};
  for (int i = cell_count(8); i > 0; --i) {
    Cell cell = all_machines().draw_cell(random, with);
    cell.threads = 8;
    EXPECT_EQ(run_cell(scenes.of(cell), cell).fault, "") << cell.text();
  }
}

// Otherwise one digest a level would show nothing.
TEST(Identity, LevelsOfAccuracyShowInTheHits) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  Scenes scenes;
  Cell cell;
  cell.config.scene.builtin = BuiltinScene::kInstances;
  TestScene& near = scenes.of(cell);
  std::set<std::string> digests;
  for (const AccuracyConfig& accuracy : accel::triangle_and_box_levels())
    digests.insert(near.reference(accuracy).digest.hex());
  EXPECT_GE(digests.size(), 4u);
  cell.away = 100;
  TestScene& far = scenes.of(cell);
  digests.clear();
  for (const auto& level : kEnumNames<TransformLevel>) {
    AccuracyConfig accuracy;
    accuracy.transform = level.value;
    digests.insert(far.reference(accuracy).digest.hex());
  }
  EXPECT_EQ(digests.size(), kEnumNames<TransformLevel>.size());
}

}  // namespace
}  // namespace carousel::ringbus
