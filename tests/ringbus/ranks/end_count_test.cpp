#include "ringbus/ranks/end_count.h"

#include <deque>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

/// Ranks that send each other items for a while, over a network that delays them at random.
class EndCountNetwork {
 public:
  explicit EndCountNetwork(std::uint32_t ranks, std::uint64_t seed) : random_(seed), work_(ranks, 2), to_(ranks) {
    for (std::uint32_t r = 0; r < ranks; ++r) counts_.emplace_back(r, ranks);
  }

  /// Returns the items that were lost sight of when rank 0 found the end; steps until then.
  std::size_t items_at_the_end() {
    for (int step = 0; step < 1'000'000 && !counts_[0].ended(); ++step) {
      const auto r = static_cast<std::uint32_t>(random_() % counts_.size());
      if (!to_[r].empty() && random_() % 4 == 0) {
        to_[r].pop_front();
        counts_[r].received(1);
        for (auto more = random_() % 3; more > 0 && answers_ > 0; --more, --answers_) ++work_[r];
      } else if (work_[r] > 0) {
        --work_[r];
        const auto other = static_cast<std::uint32_t>(random_() % counts_.size());
        counts_[r].sent(1);
        to_[other].push_back(0);
      }
      // The token overtakes items: only the counts tell that they are under way.
      if (const std::optional<EndToken> token = counts_[r].pass(work_[r] == 0))
        counts_[(r + 1) % counts_.size()].take(*token);
    }
    EXPECT_TRUE(counts_[0].ended());
    std::size_t left = 0;
    for (std::size_t r = 0; r < counts_.size(); ++r) left += to_[r].size() + static_cast<std::size_t>(work_[r]);
    return left;
  }

 private:
  std::mt19937_64 random_;
  int answers_ = 100;  // items that others may still cause
  std::vector<int> work_;
  std::vector<std::deque<int>> to_;
  std::vector<EndCount> counts_;
};

TEST(EndCount, FindsTheEndAndNeverBefore) {
  for (std::uint32_t ranks : {1u, 2u, 3u, 7u})
    for (std::uint64_t seed = 0; seed < 2000; ++seed)
      ASSERT_EQ(EndCountNetwork(ranks, seed).items_at_the_end(), 0u) << ranks << " ranks, seed " << seed;
}

}  // namespace
}  // namespace carousel::ringbus
