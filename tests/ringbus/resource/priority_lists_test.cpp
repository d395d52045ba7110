#include "ringbus/resource/collections/priority_lists.h"

#include <deque>
#include <map>
#include <random>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

TEST(PriorityLists, EmptyHasNoFirst) {
  PriorityLists lists;
  EXPECT_FALSE(lists.first());
  lists.resize(3);
  EXPECT_FALSE(lists.first());
}

TEST(PriorityLists, LowestBucketComesFirst) {
  PriorityLists lists;
  lists.resize(4);
  lists.push_back(0, 255);
  lists.push_back(1, 64);
  lists.push_back(2, 63);
  lists.push_back(3, 0);
  for (const std::uint32_t expected : {3u, 2u, 1u, 0u}) {
    EXPECT_EQ(lists.first(), expected);
    lists.remove(expected);
  }
  EXPECT_FALSE(lists.first());
}

TEST(PriorityLists, BehavesAsAMapOfDequesUnderRandomCalls) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::minstd_rand random(seed);
    PriorityLists lists;
    std::map<std::uint32_t, std::deque<std::uint32_t>> model;
    std::vector<std::uint32_t> present, absent;
    std::uint32_t elements = 0;
    for (int i = 0; i < 3000; ++i) {
      const std::uint32_t what = random() % 8;
      if (what == 0) {
        for (int k = 0; k < 3; ++k) absent.push_back(elements++);
        lists.resize(elements);
      } else if (what < 5 && !absent.empty()) {
        const std::uint32_t e = absent.back(), bucket = random() % (seed % 2 ? 256 : 3);
        absent.pop_back();
        present.push_back(e);
        if (random() % 2) {
          lists.push_back(e, bucket);
          model[bucket].push_back(e);
        } else {
          lists.push_front(e, bucket);
          model[bucket].push_front(e);
        }
        ASSERT_EQ(lists.bucket_of(e), bucket);
      } else if (!present.empty()) {
        std::swap(present[random() % present.size()], present.back());
        const std::uint32_t e = present.back();
        present.pop_back();
        absent.push_back(e);
        const auto it = model.find(lists.bucket_of(e));
        ASSERT_NE(it, model.end());
        lists.remove(e);
        std::erase(it->second, e);
        if (it->second.empty()) model.erase(it);
      }
      ASSERT_EQ(lists.first().has_value(), !model.empty());
      if (!model.empty()) {
        ASSERT_EQ(*lists.first(), model.begin()->second.front());
      }
    }
    // Draining shows the whole order.
    while (!model.empty()) {
      const std::uint32_t e = model.begin()->second.front();
      ASSERT_EQ(lists.first(), e);
      lists.remove(e);
      model.begin()->second.pop_front();
      if (model.begin()->second.empty()) model.erase(model.begin());
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
