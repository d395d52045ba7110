// What bundles take of a resource's clock: bundle units, the port of the ray store, and what waits for them.
#include <gtest/gtest.h>

#include "ringbus/cycle/tester.h"

namespace carousel::ringbus::cycle {
namespace {

constexpr auto kOrder = CullPlanesConfig::Order::kBoxFirst;

TestersConfig testers() {
  TestersConfig c;
  c.box = {8, 1, 4};
  c.bundle = {1, 1, 3};
  c.triangle = {2, 1, 5};
  return c;
}

TestCounts counts(std::uint64_t box, std::uint64_t bundle) {
  TestCounts c;
  c.box = box;
  c.bundle = bundle;
  return c;
}

TEST(BundleUnits, OnePassAfterTheOther) {
  Tester tester(testers());
  EXPECT_EQ(tester.strip(0, counts(0, 8), 1, 8), 7u + 3u);
  EXPECT_EQ(tester.bundle.busy(), 8u);
  EXPECT_EQ(tester.box.busy(), 0u);
}

TEST(BundleUnits, EdgesOfASilhouetteArePasses) {
  Tester tester(testers());
  EXPECT_EQ(tester.strip(0, counts(0, 8), 1, 40), 39u + 3u);
}

TEST(BundleUnits, RaysThatLeaveABundleAreTestedAfterIt) {
  Tester tester(testers());
  EXPECT_EQ(tester.strip(10, counts(32, 8), 33, 8), 10u + 7u + 3u + 4u);   // the last to leave, the last to be tested
  Tester many(testers());
  EXPECT_EQ(many.strip(10, counts(256, 2), 33, 2), 10u + 3u + 31u + 4u);   // 32 cycles of boxes from the first answer on
}

TEST(BundleUnits, ANarrowStoreHoldsUpWhatIsTested) {
  Tester wide(testers()), narrow(testers(), kOrder, 2);
  EXPECT_EQ(wide.strip(0, counts(8, 0), 10), 4u);
  EXPECT_EQ(narrow.strip(0, counts(8, 0), 10), 4u + 4u);   // five cycles of reading, the last record in the fifth
  EXPECT_EQ(narrow.store.busy(), 5u);
  EXPECT_EQ(wide.store.busy(), 0u);
  EXPECT_EQ(narrow.strip(8, counts(8, 0), 2), 8u + 4u);    // one cycle of reading hides nothing
}

TEST(BundleUnits, ABundleReadsOneRecordWhereItsRaysReadAllOfTheirs) {
  Tester as_bundle(testers(), kOrder, 1), as_rays(testers(), kOrder, 1);
  EXPECT_EQ(as_bundle.strip(0, counts(0, 8), 1, 8), 7u + 3u);
  EXPECT_EQ(as_rays.strip(0, counts(256, 0), 32), 31u + 4u);
}

TEST(BundleUnits, AWalkThroughASubtreeReadsItsRaysOnce) {
  Tester tester(testers(), kOrder, 1);
  EXPECT_EQ(tester.walk(5, counts(8, 0), 3, 32), 5u + 31u);
  EXPECT_EQ(tester.walk(100, counts(8, 0), 50, 32), 150u);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
