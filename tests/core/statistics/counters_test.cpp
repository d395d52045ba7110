// Every counter struct: its list names each key once, and addition adds each counter.
#include "core/statistics/counters.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/statistics/bundle_counts.h"
#include "core/statistics/cache_counts.h"
#include "core/statistics/collection_counts.h"
#include "core/statistics/cull_counts.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/link_fault_counts.h"
#include "core/statistics/raster_counts.h"
#include "core/statistics/ray_bytes.h"
#include "core/statistics/resource_counts.h"
#include "core/statistics/shape_buffer_counts.h"
#include "core/statistics/stall_counts.h"

namespace carousel {
namespace {

template <class S>
class CounterStructs : public testing::Test {};

using All =
    testing::Types<IntersectionCounts, CullLevel, BundleCounts, LinkFaultCounts, StallCounts, ResourceCounts,
                   CollectionCounts, CacheCounts, ShapeBufferCounts, StackTraffic, TransformedRayBytes, RasterCounts>;
TYPED_TEST_SUITE(CounterStructs, All);

/// Each counter another number, from `first` on.
template <class S>
S numbered(std::uint64_t first) {
  S counts;
  for (const Counter<S>& row : kCounters<S>)
    if (row.member != nullptr) counts.*row.member = first++;
  return counts;
}

TYPED_TEST(CounterStructs, AddEveryCounter) {
  TypeParam sum = numbered<TypeParam>(1);
  sum += numbered<TypeParam>(1000);
  std::uint64_t expected = 1001;
  for (const Counter<TypeParam>& row : kCounters<TypeParam>) {
    if (row.member == nullptr) continue;
    EXPECT_EQ(row.value(sum), expected) << row.name;
    expected += 2;
  }
  EXPECT_NE(sum, numbered<TypeParam>(1));
}

TYPED_TEST(CounterStructs, NameEveryKeyOnceWithItsUnitAndMeaning) {
  std::set<std::string> names;
  for (const Counter<TypeParam>& row : kCounters<TypeParam>) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_STRNE(row.unit, "") << row.name;
    EXPECT_STRNE(row.meaning, "") << row.name;
  }
}

TEST(Counters, DerivedNumbersFollowFromCounters) {
  const CullLevel level{.nodes = 1, .leaves = 2, .instances = 4};
  constexpr const auto& kList = kCounters<CullLevel>;
  const auto row = std::find_if(kList.begin(), kList.end(), [](const auto& r) { return r.member == nullptr; });
  ASSERT_NE(row, kList.end());
  EXPECT_STREQ(row->name, "culled");
  EXPECT_EQ(row->value(level), 7u);
}

TEST(Counters, EachStallReasonHasItsCounter) {
  StallCounts stalls;
  stalls[StallReason::kCredits] = 1;
  stalls[StallReason::kLink] = 2;
  stalls[StallReason::kSlots] = 3;
  stalls[StallReason::kStorage] = 4;
  stalls[StallReason::kReserve] = 5;
  EXPECT_EQ(stalls, (StallCounts{1, 2, 3, 4, 5}));
}

/// Collects what a visitor of the report is given.
struct Keys {
  std::vector<std::string> keys;
  void field(const char* key, std::uint64_t, const char*, const char*) { keys.emplace_back(key); }
};

TEST(Counters, DescribeThemselvesWithoutIngredients) {
  Keys seen;
  describe(seen, CullLevel{});
  EXPECT_EQ(seen.keys,
            (std::vector<std::string>{"children_tested", "plane_tests", "culled", "box_tests_spared", "nodes_spared",
                                      "leaves_spared", "triangle_tests_spared", "transforms_spared"}));
}

}  // namespace
}  // namespace carousel
