// The cycles that bundles take: bundle units, the port of the ray store, and the tests that wait for them.
#include <gtest/gtest.h>

#include "ringbus/cycle/testers/tester.h"

namespace carousel::ringbus::cycle {
namespace {

constexpr auto kOrder = CullPlanesConfig::Order::kBoxFirst;

TestersConfig bundle_testers() {
  TestersConfig c;
  c.units[UnitKind::kBox] = {8, 1, 4};
  c.units[UnitKind::kBundle] = {1, 1, 3};
  c.units[UnitKind::kTriangle] = {2, 1, 5};
  c.units[UnitKind::kReciprocal] = {1, 2, 6};
  return c;
}

IntersectionCounts counts(std::uint64_t box, std::uint64_t bundle) {
  IntersectionCounts c;
  c.box = box;
  c.bundle = bundle;
  return c;
}

TEST(BundleUnits, OnePassAfterTheOther) {
  Tester tester(bundle_testers());
  EXPECT_EQ(tester.strip(0, counts(0, 8), 1, {.first = 8}), 7u + 3u);
  EXPECT_EQ(tester.bank(UnitKind::kBundle).busy(), 8u);
  EXPECT_EQ(tester.bank(UnitKind::kBox).busy(), 0u);
}

TEST(BundleUnits, EdgesOfASilhouetteArePasses) {
  Tester tester(bundle_testers());
  EXPECT_EQ(tester.strip(0, counts(0, 8), 1, {.first = 40}), 39u + 3u);
}

// By intervals a bundle's tests wait for all of its six divisions, one in two cycles.
TEST(BundleUnits, IntervalsWaitForDivisions) {
  Tester tester(bundle_testers());
  EXPECT_EQ(tester.strip(0, counts(0, 2), 1, {.first = 2, .divided_before = 6}), 5u * 2u + 6u + 1u + 3u);
  EXPECT_EQ(tester.bank(UnitKind::kReciprocal).busy(), 12u);
  EXPECT_EQ(tester.bank(UnitKind::kBundle).busy(), 2u);
  // The tests of a second bundle wait for its divisions: they begin with those of the first, which have all directions.
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 20), 1, {.first = 20, .divided_before = 6}),
            5u * 2u + 6u + 19u + 3u);
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 4), 2, {.first = 4, .divided_before = 12}), 11u * 2u + 6u + 3u);
}

// By silhouettes only the distance of a box that is entered is divided, behind its test.
TEST(BundleUnits, SilhouettesDivideForDistancesAlone) {
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 2), 1, {.first = 2}), 1u + 3u);
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 2), 1, {.first = 2, .divided_after = 1}), 1u + 3u + 6u);
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 2), 1, {.first = 1, .second = 1, .divided_after = 2}),
            3u + 3u + 2u + 6u);
}

TEST(BundleUnits, ASecondTestWaitsForTheAnswerToTheFirst) {
  // A box: its second test starts in cycle 3, with the answer to the first. Both at once: in cycles 0 and 1.
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 2), 1, {.first = 1, .second = 1}), 3u + 3u);
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 2), 1, {.first = 2}), 1u + 3u);
  // Eight boxes keep the unit busy until the first answers are there.
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 12), 1, {.first = 8, .second = 4}), 11u + 3u);
}

TEST(BundleUnits, APairOfBlocksMakesBothTestsAtOnce) {
  TestersConfig pairs = bundle_testers();
  pairs.bundle_blocks = TestersConfig::BundleBlocks::kPairs;
  EXPECT_EQ(Tester(bundle_testers()).strip(0, counts(0, 16), 1, {.first = 16, .at_once = 8}), 15u + 3u);
  EXPECT_EQ(Tester(pairs).strip(0, counts(0, 16), 1, {.first = 16, .at_once = 8}), 7u + 3u);
}

TEST(BundleUnits, SharedBlocksAreTheBoxUnits) {
  TestersConfig shared = bundle_testers();
  shared.bundle_blocks = TestersConfig::BundleBlocks::kShared;
  Tester tester(shared);
  EXPECT_EQ(tester.strip(0, counts(32, 8), 1, {.first = 8}), 4u + 3u + 4u);  // eight units, then four cycles of rays
  EXPECT_EQ(tester.bank(UnitKind::kBundle).busy(), 0u);
  EXPECT_EQ(tester.bank(UnitKind::kBox).busy(), 1u + 4u);
}

TEST(BundleUnits, RaysThatAreRegroupedPassTheBuilder) {
  Tester tester(bundle_testers(), kOrder, 0, 2);
  const Cycle tested = Tester(bundle_testers()).strip(0, counts(16, 8), 1, {.first = 8});
  EXPECT_EQ(tester.strip(0, counts(16, 8), 1, {.first = 8, .regrouped = 11}), tested + 6);
  EXPECT_EQ(Tester(bundle_testers(), kOrder, 0, 1024).strip(0, counts(16, 8), 1, {.first = 8, .regrouped = 11}),
            tested + 1);
}

TEST(BundleUnits, RaysThatLeaveABundleAreTestedAfterIt) {
  Tester tester(bundle_testers());
  EXPECT_EQ(tester.strip(10, counts(32, 8), 33, {.first = 8}),
            10u + 7u + 3u + 4u);  // the last to leave, the last to be tested
  Tester many(bundle_testers());
  EXPECT_EQ(many.strip(10, counts(256, 2), 33, {.first = 2}),
            10u + 3u + 31u + 4u);  // 32 cycles of boxes from the first answer on
}

TEST(BundleUnits, ANarrowStoreHoldsUpWhatIsTested) {
  Tester wide(bundle_testers()), narrow(bundle_testers(), kOrder, 2);
  EXPECT_EQ(wide.strip(0, counts(8, 0), 10), 4u);
  EXPECT_EQ(narrow.strip(0, counts(8, 0), 10),
            5u + 4u);  // five cycles of reading, the last record a cycle after the fifth
  EXPECT_EQ(narrow.store().busy(), 5u);
  EXPECT_EQ(wide.store().busy(), 0u);
  EXPECT_EQ(narrow.strip(8, counts(8, 0), 2), 8u + 1u + 4u);
}

TEST(BundleUnits, ABundleReadsOneRecordWhereItsRaysReadAllOfTheirs) {
  Tester as_bundle(bundle_testers(), kOrder, 1), as_rays(bundle_testers(), kOrder, 1);
  EXPECT_EQ(as_bundle.strip(0, counts(0, 8), 1, {.first = 8}), 1u + 7u + 3u);
  EXPECT_EQ(as_rays.strip(0, counts(256, 0), 32), 32u + 4u);
}

TEST(BundleUnits, RaysOfAWalkBeginAsTheirRecordsAreRead) {
  Tester one(bundle_testers(), kOrder, 1), two(bundle_testers(), kOrder, 2), wide(bundle_testers());
  for (Cycle ray = 1; ray <= 32; ++ray) {
    EXPECT_EQ(one.read(5, 1), 5 + ray);
    EXPECT_EQ(two.read(5, 1), 5 + ceil_div(ray, 2));
    EXPECT_EQ(wide.read(5, 1), 5u);
  }
}

// Rays that need no test any more are read all the same, and the visit lasts as long as that: busy cycles beyond the
// resource's time in test would leave its ledger with less than nothing.
TEST(BundleUnits, AVisitLastsAsLongAsItsReading) {
  Tester strip(bundle_testers(), kOrder, 1), walk(bundle_testers(), kOrder, 1);
  const Cycle strip_done = strip.strip(10, counts(0, 0), 6), walk_done = walk.read(10, 6);
  EXPECT_EQ(strip.store().busy(), 6u);
  EXPECT_EQ(strip_done, 10u + strip.store().busy());
  EXPECT_EQ(walk_done, 10u + walk.store().busy());
}

}  // namespace
}  // namespace carousel::ringbus::cycle
