#include "ringbus/resource/collections/collection_store.h"

#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/system/error.h"
#include "core/types/enum_names.h"

namespace carousel::ringbus {
namespace {

using accel::NodeKey;
using accel::NodeRef;

NodeKey key(std::uint32_t node) {
  return {0, NodeRef::inner(node)};
}
RayId ray(std::uint32_t bits) {
  RayId id;
  id.bits = bits;
  return id;
}
std::vector<RayId> ray_ids(std::uint32_t first, std::uint32_t count) {
  std::vector<RayId> out;
  for (std::uint32_t i = 0; i < count; ++i) out.push_back(ray(first + i));
  return out;
}

CollectionStore::Settings settings(Policy policy, Select select) {
  CollectionStore::Settings s;
  s.block_rays = s.packet_rays = 4;
  s.ready = 8;
  s.capacity_blocks = 100;
  s.policy = policy;
  s.select = select;
  s.scene_size = 10;
  s.max_depth = 12;
  return s;
}

/// Keys in the order in which all collections are issued, one block at a time.
std::vector<std::uint32_t> drain(CollectionStore& store) {
  std::vector<std::uint32_t> order;
  std::vector<RayId> out;
  while (const auto best = store.best(true)) {
    order.push_back(store.key(*best).ref.node());
    store.take(*best, out);
  }
  EXPECT_TRUE(store.empty());
  return order;
}

using Keys = std::vector<std::uint32_t>;

TEST(IssuePolicy, EveryNameHasItsRow) {
  for (const auto& entry : kEnumNames<Policy>) EXPECT_EQ(issue_policy(entry.value).policy, entry.value) << entry.name;
}

TEST(IssuePolicy, TakesPoliciesThatAreNotInTheTable) {
  // The narrowest collection first, which no built-in policy is.
  const auto narrowest = [](const CollectionFacts& c, const PolicyScale&) { return std::min(c.rays, 255u); };
  const Policy own = register_policy("narrowest", {.policy = Policy::kOldest, .bucket = narrowest});
  const Policy other =
      register_policy("narrowest_newest", {.policy = Policy::kOldest, .bucket = narrowest, .newest_first = true});
  EXPECT_NE(own, other);
  EXPECT_EQ(enum_name(other), "narrowest_newest");
  const std::string text = "scene: {builtin: cornell}\ncollections: {policy: narrowest}\n";
  EXPECT_EQ(load_config({text, "own.yaml"}).config.collections.policy, own);
  EXPECT_THROW(register_policy("narrowest", {.policy = {}, .bucket = narrowest}), SimulationError);
  EXPECT_THROW(register_policy("oldest", {.policy = {}, .bucket = narrowest}), SimulationError);
  EXPECT_FALSE(issue_policy(own).newest_first);
  EXPECT_TRUE(issue_policy(other).newest_first);
  CollectionStore store(settings(own, Select::kStrict));
  store.add(key(1), 1, 1, ray_ids(0, 2));
  store.add(key(2), 1, 1, ray_ids(10, 1));
  store.add(key(3), 1, 1, ray_ids(20, 3));
  EXPECT_EQ(drain(store), (Keys{2, 1, 3}));
  EXPECT_THROW(issue_policy(static_cast<Policy>(99)), SimulationError);
}

// The facts of a policy's table row, whose order the tests below see only through the store.
TEST(IssuePolicy, BucketsStayInTheirRange) {
  const PolicyScale scale{8, 12, 10};
  for (const auto& entry : kEnumNames<Policy>)
    for (const float entered : {-1.0f, 0.0f, 1e-30f, 3.0f, 1e30f, kInfinity})
      for (const std::uint32_t count : {1u, 8u, 1000000u})
        EXPECT_LT(issue_policy(entry.value).bucket({key(1), count, entered, 65535}, scale), PriorityLists::kBuckets);
}

TEST(CollectionStore, FullestFirst) {
  CollectionStore store(settings(Policy::kFullest, Select::kStrict));
  store.add(key(1), 1, 1, ray_ids(0, 1));
  store.add(key(2), 1, 1, ray_ids(10, 3));
  store.add(key(3), 1, 1, ray_ids(20, 2));
  EXPECT_EQ(drain(store), (Keys{2, 3, 1}));
}

TEST(CollectionStore, OldestFirstAndNewestFirst) {
  for (const Policy policy : {Policy::kOldest, Policy::kNewest}) {
    CollectionStore store(settings(policy, Select::kStrict));
    for (const std::uint32_t k : {5u, 3u, 9u}) store.add(key(k), 1, 1, ray_ids(k, 2));
    store.add(key(5), 1, 1, ray_ids(50, 1));  // growing does not make it younger
    EXPECT_EQ(drain(store), policy == Policy::kOldest ? (Keys{5, 3, 9}) : (Keys{9, 3, 5}));
  }
}

TEST(CollectionStore, DeepestFirst) {
  CollectionStore store(settings(Policy::kDeepest, Select::kStrict));
  store.add(key(1), 3, 1, ray_ids(0, 4));
  store.add(key(2), 7, 1, ray_ids(10, 1));
  store.add(key(3), 5, 1, ray_ids(20, 2));
  EXPECT_EQ(store.key(*store.deepest()), key(2));
  EXPECT_EQ(drain(store), (Keys{2, 3, 1}));
  EXPECT_FALSE(store.deepest());
}

TEST(CollectionStore, NearestFirstAndAnEarlierEntryBringsForward) {
  CollectionStore store(settings(Policy::kNearest, Select::kStrict));
  store.add(key(1), 1, 8.0f, ray_ids(0, 1));
  store.add(key(2), 1, 0.5f, ray_ids(10, 1));
  store.add(key(3), 1, 2.0f, ray_ids(20, 1));
  store.add(key(4), 1, 0.0f, ray_ids(30, 1));
  store.add(key(1), 1, 1.0f, ray_ids(40, 1));
  store.add(key(2), 1, 9.0f, ray_ids(50, 1));  // a later one changes nothing
  EXPECT_EQ(drain(store), (Keys{4, 2, 1, 3}));
}

TEST(CollectionStore, FullFirstOffersReadyOnesOnly) {
  for (const Policy policy : {Policy::kFullest, Policy::kOldest, Policy::kNewest, Policy::kDeepest, Policy::kNearest}) {
    CollectionStore store(settings(policy, Select::kFullFirst));
    store.add(key(1), 9, 0.1f, ray_ids(0, 7));
    EXPECT_FALSE(store.best(false));
    EXPECT_EQ(store.key(*store.best(true)), key(1));
    store.add(key(2), 1, 5.0f, ray_ids(10, 8));
    EXPECT_EQ(store.key(*store.best(false)), key(2));
    EXPECT_EQ(store.key(*store.best(true)), key(2));  // before better ones that are not ready
    std::vector<RayId> out;
    store.take(*store.best(false), out);
    EXPECT_FALSE(store.best(false));  // four are left: not ready any more
    store.add(key(1), 9, 0.1f, ray_ids(20, 1));
    EXPECT_EQ(store.key(*store.best(false)), key(1));
  }
}

TEST(CollectionStore, GivesRaysBlockByBlockInTheirOrder) {
  CollectionStore store(settings(Policy::kOldest, Select::kStrict));
  store.add(key(1), 1, 1, ray_ids(0, 3));
  store.add(key(1), 1, 1, ray_ids(3, 4));
  store.add(key(1), 1, 1, ray_ids(7, 3));
  std::vector<RayId> out;
  for (const std::uint32_t expected : {4u, 4u, 2u}) {
    ASSERT_EQ(store.front_rays(*store.best(true)), expected);
    store.take(*store.best(true), out);
    ASSERT_EQ(out.size(), expected);
  }
  EXPECT_EQ(out[0].bits, 8u);
  EXPECT_EQ(out[1].bits, 9u);
}

TEST(CollectionStore, CountsBlocksBeyondItsCapacityAsSpilled) {
  CollectionStore::Settings s = settings(Policy::kOldest, Select::kStrict);
  s.capacity_blocks = 2;
  CollectionStore store(s);
  store.add(key(1), 1, 1, ray_ids(0, 8));
  EXPECT_EQ(store.free_blocks(), 0);
  EXPECT_EQ(store.statistics().spilled, 0u);
  store.add(key(2), 1, 1, ray_ids(8, 3));
  EXPECT_EQ(store.free_blocks(), -1);
  EXPECT_EQ(store.statistics().spilled, 3u);
  drain(store);
  EXPECT_EQ(store.free_blocks(), 2);
}

TEST(CollectionStore, TellsHowLongCollectionsHadWaited) {
  CollectionStore store(settings(Policy::kOldest, Select::kFullFirst));
  store.ripen(10);
  store.add(key(1), 0, 1, ray_ids(0, 4));
  store.ripen(30);
  store.add(key(1), 0, 1, ray_ids(4, 1));  // it has waited since its first ray
  std::vector<RayId> out;
  store.ripen(50);
  store.take(*store.best(true), out);  // 40 cycles
  store.ripen(53);
  store.discard();
  store.add(key(2), 0, 1, ray_ids(5, 5));
  store.ripen(59);
  store.take(*store.best(true), out);  // 6 cycles
  store.ripen(60);
  store.take(*store.best(true), out);  // the rest waited for 1
  EXPECT_EQ(store.ages().count(), 3u);
  EXPECT_EQ(store.ages().sum(), 47u);
  EXPECT_EQ(store.ages().max(), 40u);
  EXPECT_EQ(store.ages().in_class(6), 1u);  // 32 to 63
  EXPECT_EQ(store.ages().in_class(3), 1u);  // 4 to 7
  EXPECT_EQ(store.ages().in_class(1), 1u);
}

TEST(CollectionStore, ACollectionIsReadyWhenItHasWaitedForLongEnough) {
  CollectionStore::Settings s = settings(Policy::kOldest, Select::kFullFirst);
  s.ripe_after = 100;
  CollectionStore store(s);
  const auto best = [&]() -> std::optional<std::uint32_t> {
    const auto id = store.best(false);
    return id ? std::optional(store.key(*id).ref.node()) : std::nullopt;
  };
  store.ripen(10);
  store.add(key(1), 0, 1, ray_ids(0, 4));
  store.ripen(30);
  store.add(key(2), 0, 1, ray_ids(4, 1));
  store.add(key(1), 0, 1, ray_ids(5, 1));  // it has waited since its first ray
  EXPECT_EQ(store.next_ripe(), 110u);
  store.ripen(109);
  EXPECT_EQ(best(), std::nullopt);
  store.ripen(110);
  EXPECT_EQ(best(), 1u);
  EXPECT_EQ(store.next_ripe(), 130u);
  std::vector<RayId> out;
  store.take(*store.best(false), out);
  EXPECT_EQ(out.size(), 4u);
  EXPECT_EQ(best(), std::nullopt);  // its last ray waits anew
  store.ripen(150);
  EXPECT_EQ(best(), 2u);
  EXPECT_EQ(store.next_ripe(), 210u);
  store.take(*store.best(false), out);
  store.add(key(1), 0, 1, ray_ids(6, 7));  // full: it need not wait
  EXPECT_EQ(best(), 1u);
  EXPECT_EQ(store.next_ripe(), std::nullopt);
  store.discard();
  store.add(key(3), 0, 1, ray_ids(13, 1));
  EXPECT_EQ(store.next_ripe(), 250u);
}

// Against a map of lists: the policy allows every collection that is offered, and the rays that are taken are those
// that were added.
TEST(CollectionStore, BehavesAsAMapOfListsUnderRandomCalls) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::minstd_rand random(seed);
    CollectionStore::Settings s = settings(static_cast<Policy>(seed % 5), static_cast<Select>(seed / 5 % 2));
    s.packet_rays = 1 + random() % 6;
    s.block_rays = seed % 3 == 0 ? 1 : s.packet_rays;
    s.ready = 1 + random() % 12;
    CollectionStore store(s);
    struct Collection {
      std::vector<std::uint32_t> rays;
      float entry = 1e30f;
      std::uint16_t depth = 0;
      int born = 0;
    };
    std::map<std::uint32_t, Collection> model;
    std::uint32_t next_ray = 0;
    std::size_t memberships = 0, blocks = 0;
    const auto blocks_of = [&](std::size_t n) { return (n + s.block_rays - 1) / s.block_rays; };
    for (int i = 0; i < 2500; ++i) {
      if (random() % 5 < (i < 2000 ? 3u : 1u)) {
        const std::uint32_t k = random() % 12;
        Collection& c = model[k];
        if (c.rays.empty()) c = {{}, 1e30f, static_cast<std::uint16_t>(k % 7), i};
        const float entry = 0.01f * static_cast<float>(random() % 1000);
        c.entry = std::min(c.entry, entry);
        const auto batch = ray_ids(next_ray, 1 + random() % s.packet_rays);
        next_ray += static_cast<std::uint32_t>(batch.size());
        blocks -= blocks_of(c.rays.size());
        for (const RayId r : batch) c.rays.push_back(r.bits);
        blocks += blocks_of(c.rays.size());
        memberships += batch.size();
        store.add(key(k), c.depth, entry, batch);
      } else if (!model.empty()) {
        const auto best = store.best(true);
        ASSERT_TRUE(best);
        const auto it = model.find(store.key(*best).ref.node());
        ASSERT_NE(it, model.end());
        const Collection& c = it->second;
        ASSERT_EQ(store.depth(*best), c.depth);
        ASSERT_EQ(store.entry(*best), c.entry);
        const auto ready = [&](const Collection& o) { return s.select == Select::kStrict || o.rays.size() >= s.ready; };
        ASSERT_EQ(store.best(false).has_value(),
                  std::any_of(model.begin(), model.end(), [&](const auto& o) { return ready(o.second); }));
        for (const auto& [other_key, other] : model) {
          if (ready(other) && !ready(c)) FAIL() << "a ready collection was passed over";
          if (ready(other) != ready(c)) continue;
          switch (s.policy) {
            case Policy::kDeepest:
              ASSERT_GE(c.depth, other.depth);
              break;
            case Policy::kNearest:
              ASSERT_LE(c.entry, other.entry * 1.126f);
              break;                // buckets of an eighth octave
            case Policy::kFullest:  // two ready sizes fill the scale
              if (other.rays.size() < 2 * s.ready) {
                ASSERT_GE((c.rays.size() + 1) * 128 / s.ready + 1, other.rays.size() * 128 / s.ready);
              }
              break;
            default:
              break;  // age is tested below, without `full first`, where readiness changes no order
          }
          if (s.select != Select::kStrict) continue;
          ASSERT_TRUE(s.policy != Policy::kOldest || c.born <= other.born);
          ASSERT_TRUE(s.policy != Policy::kNewest || c.born >= other.born);
        }
        const std::uint32_t front = store.front_rays(*best), front_blocks = store.front_blocks(*best);
        std::vector<RayId> out;
        store.take(*best, out);
        ASSERT_EQ(out.size(), std::min<std::size_t>(c.rays.size(), s.packet_rays));
        ASSERT_EQ(out.size(), front);
        for (std::size_t r = 0; r < out.size(); ++r) ASSERT_EQ(out[r].bits, c.rays[r]);
        memberships -= out.size();
        ASSERT_EQ(front_blocks, blocks_of(out.size()));
        blocks -= front_blocks;
        it->second.rays.erase(it->second.rays.begin(),
                              it->second.rays.begin() + static_cast<std::ptrdiff_t>(out.size()));
        if (it->second.rays.empty()) model.erase(it);
      }
      ASSERT_EQ(store.collections(), model.size());
      ASSERT_EQ(store.memberships(), memberships);
      ASSERT_EQ(store.free_blocks(), std::int64_t{s.capacity_blocks} - static_cast<std::int64_t>(blocks));
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
