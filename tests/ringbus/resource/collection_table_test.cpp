#include "ringbus/resource/collections/collection_table.h"

#include <random>
#include <unordered_map>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

using accel::NodeKey;
using accel::NodeRef;

NodeKey key(std::uint32_t instance, std::uint32_t bits) {
  return {instance, NodeRef::from_bits(bits)};
}

TEST(CollectionTable, FindsNothingWhenEmpty) {
  const CollectionTable table;
  EXPECT_FALSE(table.find(key(0, 0)));
  EXPECT_EQ(table.size(), 0u);
}

// One node in two instances makes two collections, and so do two nodes of one instance.
TEST(CollectionTable, TellsInstancesAndNodesApart) {
  CollectionTable table;
  std::uint32_t value = 0;
  for (std::uint32_t instance : {0u, 1u, 2u, 0x10000u, accel::kMaxBlocks, kNoInstance})
    for (std::uint32_t node : {0u, 1u, 0x10000u, 0x3fffffffu, 0x40000000u, 0x80000001u})
      table.insert(key(instance, node), value++);
  value = 0;
  for (std::uint32_t instance : {0u, 1u, 2u, 0x10000u, accel::kMaxBlocks, kNoInstance})
    for (std::uint32_t node : {0u, 1u, 0x10000u, 0x3fffffffu, 0x40000000u, 0x80000001u})
      EXPECT_EQ(table.find(key(instance, node)), value++);
}

TEST(CollectionTable, BehavesAsAMapUnderRandomCalls) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    CollectionTable table;
    std::unordered_map<std::uint64_t, std::uint32_t> model;
    std::vector<NodeKey> keys;
    // Few distinct keys collide often; keys that differ in high bits only test what the hash keeps.
    const std::uint32_t range = 1u << (2 + random() % 10);
    const int shift = seed % 3 == 0 ? 20 : 0;
    for (int i = 0; i < 6000; ++i) {
      const NodeKey k = key((random() % 4) << shift, (random() % range) << shift >> (seed % 3 == 0 ? 4 : 0));
      const auto it = model.find(k.bits());
      const auto found = table.find(k);
      ASSERT_EQ(found.has_value(), it != model.end());
      if (found) {
        ASSERT_EQ(*found, it->second);
        if (random() % 2) {
          table.erase(k);
          model.erase(it);
        }
      } else {
        const std::uint32_t value = random();
        table.insert(k, value);
        model.emplace(k.bits(), value);
        keys.push_back(k);
      }
      ASSERT_EQ(table.size(), model.size());
    }
    for (const NodeKey& k : keys) {
      const auto it = model.find(k.bits());
      ASSERT_EQ(table.find(k).has_value(), it != model.end());
      if (it != model.end()) {
        ASSERT_EQ(*table.find(k), it->second);
      }
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
