// A list of several parts, of which one is the product's.
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/config/parts.h"

namespace carousel::part_list_test {
namespace {

struct FilterPart {
  struct Keys {
    std::int64_t size = 0;
  };
  struct Counts {
    std::uint64_t passed = 0;
    static constexpr auto counters() { return std::array{Counter{"passed", &Counts::passed, "lines", "lines"}}; }
    friend bool operator==(const Counts&, const Counts&) = default;
  };
  static constexpr const char *kSection = "filter", *kSwitch = "size", *kAbsent = "there is no filter",
                              *kName = "filter", *kMeaning = "", *kCountsMeaning = "", *kAreaMeaning = "",
                              *kEnergyMeaning = "";
  static bool is_built(const Keys& keys) { return keys.size > 0; }
  static PartArea area(const Keys&, const Costs&) { return {}; }
  static PartEnergy energy(const Counts&, const Keys&, const Costs&) { return {}; }
};
using Two = PartList<StridePrefetcherPart, FilterPart>;

TEST(PartLists, HaveSectionsAndCountsOfEachPart) {
  PartKeys<Two> keys;
  keys.of<FilterPart>().size = 3;
  std::vector<std::string> built, all;
  Two::for_each([&]<class P>(std::size_t i) {
    EXPECT_EQ(i, all.size());
    all.emplace_back(P::kSection);
    if (P::is_built(keys.of<P>())) built.emplace_back(P::kSection);
  });
  EXPECT_EQ(all, (std::vector<std::string>{"prefetcher", "filter"}));
  EXPECT_EQ(built, std::vector<std::string>{"filter"});
  PartCounts<Two> counts, same;
  EXPECT_FALSE(counts.of<FilterPart>() || counts.of<StridePrefetcherPart>());
  counts.of<FilterPart>().emplace().passed = 5;
  EXPECT_NE(counts, same);
  same.of<FilterPart>() = {{.passed = 5}};
  EXPECT_EQ(counts, same);
}

TEST(PartLists, ThePrefetcherSaysWhatItCosts) {
  using Prefetcher = StridePrefetcherPart;
  Costs costs;
  EXPECT_EQ(Prefetcher::area({.lines = 2}, costs).mm2, 0);
  costs.values[cost_index(Cost::kSramArea)] = 0.5;
  costs.values[cost_index(Cost::kSram8)] = costs.values[cost_index(Cost::kSram32)] = 10;
  const PartArea area = Prefetcher::area({.lines = 2, .streams = 64}, costs);  // of 16 bytes
  EXPECT_EQ(area.size, 1);
  EXPECT_EQ(area.mm2, 0.5);
  const PartEnergy energy = Prefetcher::energy({.hints = 3}, {.lines = 2, .streams = 4}, costs);
  EXPECT_EQ(energy.events, 3 * (2 * 4 + 2));
  EXPECT_EQ(energy.pj_each, 10);
}

// The figures were computed with forty decimal digits. An access takes e = low (high / low)^(ln(s / s_low) / ln(s_high
// / s_low)); the host's logarithm has no part in it.
TEST(Costs, OfAnAccessGoWithTheSizeOfTheStore) {
  Costs costs;
  costs.values[cost_index(Cost::kSram8)] = 10;
  costs.values[cost_index(Cost::kSram32)] = 20;
  costs.values[cost_index(Cost::kSram1024)] = 100;
  EXPECT_EQ(costs.sram_access_pj(8), 10);
  EXPECT_EQ(costs.sram_access_pj(32), 20);
  for (const auto& [kib, pj] : std::vector<std::pair<double, double>>{{0.0625, 0.88388347648318440550},
                                                                      {2, 5},
                                                                      {36, 21.12440530221043794178},
                                                                      {128, 38.07307877431756979793},
                                                                      {1024, 100},
                                                                      {2048, 137.9729661461214832390}})
    EXPECT_NEAR(costs.sram_access_pj(kib) / pj, 1, 4e-15) << kib;
  EXPECT_EQ(Costs().sram_access_pj(128), 0) << "without a profile";
}

}  // namespace
}  // namespace carousel::part_list_test
