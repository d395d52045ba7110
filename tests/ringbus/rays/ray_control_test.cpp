#include "ringbus/rays/ray_control.h"

#include <map>
#include <random>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "core/config/config.h"

namespace carousel::ringbus {
namespace {

struct Bench {
  Config config;
  std::vector<std::unique_ptr<RayStore>> stores;
  std::unique_ptr<RayControl> control;

  Bench(Placement placement, Home home, std::int64_t resources, std::int64_t slots, std::int64_t packet_rays) {
    config.rays.placement = placement;
    config.collections.home = home;
    config.topology.resources = resources;
    config.rays.slots_per_resource = slots;
    config.packets.rays = packet_rays;
    for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(resources); ++r)
      stores.push_back(std::make_unique<RayStore>(ResourceId(r), static_cast<std::uint32_t>(slots)));
    control = std::make_unique<RayControl>(
        ray_control_settings(config.rays, config.collections, config.packets, config.bundles, 1, 1.0f), stores);
  }
  std::vector<RayGroup> collect(std::uint32_t resource) {
    std::vector<RayGroup> groups;
    control->collect(ResourceId(resource), groups);
    return groups;
  }
  ResourceId owner(RayId id) const { return stores[0]->layout().owner(id); }
  std::uint32_t path(RayId id) const {
    RayStore& store = *stores[owner(id).value];
    return store.record(store.slot(id)).tag.path;
  }
  /// All groups of all resources: (issuer, group).
  std::vector<std::pair<std::uint32_t, RayGroup>> collect_all() {
    std::vector<std::pair<std::uint32_t, RayGroup>> out;
    for (std::uint32_t r = 0; r < stores.size(); ++r)
      for (RayGroup& group : collect(r)) out.emplace_back(r, std::move(group));
    return out;
  }
};

RayBatch rays(std::uint32_t count, std::uint32_t first = 0) {
  RayBatch batch(count);
  for (std::uint32_t i = 0; i < count; ++i) batch[i].tag.path = first + i;
  return batch;
}

TEST(RayControl, BalancedSpreadsEachGroupInEqualRuns) {
  Bench bench(Placement::kBalanced, Home::kIssuer, 4, 64, 32);
  bench.control->submit(rays(64));
  std::map<std::uint32_t, int> at;
  const auto groups = bench.collect_all();
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_NE(groups[0].first, groups[1].first);  // issued by different resources
  for (const auto& [issuer, group] : groups) {
    ASSERT_EQ(group.ids.size(), 32u);
    std::map<std::uint32_t, std::vector<std::uint32_t>> paths;
    for (const RayId id : group.ids) paths[bench.owner(id).value].push_back(bench.path(id));
    ASSERT_EQ(paths.size(), 4u);
    for (const auto& [owner, run] : paths) {
      ASSERT_EQ(run.size(), 8u);
      EXPECT_EQ(run.back() - run.front(), 7u);  // neighbours stay together
    }
  }
}

// The packet process 9 serves eight resources, and 10 serves one, whose 32 slots are fewer than a quarter of the mean.
TEST(RayControl, APacketProcessWithFewSlotsGetsRaysToo) {
  std::vector<std::unique_ptr<RayStore>> stores;
  for (std::uint32_t r = 0; r < 11; ++r) stores.push_back(std::make_unique<RayStore>(ResourceId(r), r < 9 ? 32 : 0));
  Config config;
  config.packets.rays = 64;
  RayControlSettings settings =
      ray_control_settings(config.rays, config.collections, config.packets, config.bundles, 1, 1.0f);
  settings.manager_of = {9, 9, 9, 9, 9, 9, 9, 9, 10, 9, 10};
  RayControl control(settings, stores);
  control.submit(rays(5 * 64));
  std::vector<RayGroup> many, few;
  control.collect(ResourceId(9), many);
  control.collect(ResourceId(10), few);
  EXPECT_EQ(many.size(), 4u);
  ASSERT_EQ(few.size(), 1u);
  EXPECT_EQ(few[0].ids.size(), 32u);
  for (const RayId id : few[0].ids) EXPECT_EQ(stores[0]->layout().owner(id), ResourceId(8));
}

// Four resources with 16 slots each: the packet process 4 serves the first three, and 5 the last.
TEST(RayControl, GroupsAvoidWhatHasStopped) {
  for (const std::int64_t bundled : {0, 4})
    for (const std::uint32_t stopped : {0u, 3u, 4u, 5u}) {
      SCOPED_TRACE(bundled);
      SCOPED_TRACE(stopped);
      Config config;
      config.packets.rays = 8;
      config.bundles.size = bundled;
      const auto stores = make_ray_stores({16, 16, 16, 16, 0, 0}, config.bundles);
      RayControlSettings settings =
          ray_control_settings(config.rays, config.collections, config.packets, config.bundles, 1, 1.0f);
      settings.manager_of = {4, 4, 4, 5, 4, 5};
      RayControl control(settings, stores);
      EXPECT_EQ(control.exclude(ResourceId(stopped)), stopped == 4 ? 48u : 16u);
      control.submit(rays(64));
      std::size_t placed = 0;
      for (const std::uint32_t issuer : {4u, 5u}) {
        std::vector<RayGroup> groups;
        control.collect(ResourceId(issuer), groups);
        EXPECT_EQ(groups.empty(), stopped == issuer || (stopped == 3 && issuer == 5));
        for (const RayGroup& group : groups)
          for (const RayId id : group.ids) {
            const ResourceId owner = stores[0]->layout().owner(id);
            EXPECT_NE(owner, ResourceId(stopped));
            EXPECT_EQ(settings.manager_of[owner.value], issuer);
            const std::uint32_t slot = stores[0]->layout().slot(id);
            const RayStore& store = *stores[owner.value];
            placed += store.is_bundle(slot) ? store.rays_of(slot).size() : 1;
          }
      }
      EXPECT_EQ(placed, stopped == 4 ? 16u : 48u);
    }
}

// A quarter of the slots that were there at first would be more than the resource that is left ever has.
TEST(RayControl, WhatIsLeftOfAMachineIsEnough) {
  std::vector<std::unique_ptr<RayStore>> stores;
  for (std::uint32_t r = 0; r < 2; ++r) stores.push_back(std::make_unique<RayStore>(ResourceId(r), r == 0 ? 1024 : 16));
  Config config;
  config.packets.rays = 64;
  RayControl control(ray_control_settings(config.rays, config.collections, config.packets, config.bundles, 1, 1.0f),
                     stores);
  EXPECT_EQ(control.exclude(ResourceId(0)), 1024u);
  control.submit(rays(64));
  EXPECT_EQ(control.slots_used(), 16u);
}

TEST(RayControl, RoundRobinDealsRaysOneByOne) {
  Bench bench(Placement::kRoundRobin, Home::kIssuer, 3, 64, 6);
  bench.control->submit(rays(6));
  const auto groups = bench.collect_all();
  ASSERT_EQ(groups.size(), 1u);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(bench.owner(groups[0].second.ids[i]).value, (bench.owner(groups[0].second.ids[0]).value + i) % 3);
}

TEST(RayControl, LocalHomeKeepsAGroupWhereItIsIssued) {
  for (const Placement placement : {Placement::kBalanced, Placement::kRoundRobin}) {
    Bench bench(placement, Home::kLocal, 4, 64, 16);
    bench.control->submit(rays(128));
    std::map<std::uint32_t, int> at;
    for (const auto& [issuer, group] : bench.collect_all()) {
      for (const RayId id : group.ids) EXPECT_EQ(bench.owner(id).value, issuer);
      ++at[issuer];
    }
    for (std::uint32_t r = 0; r < 4; ++r) EXPECT_EQ(at[r], 2);
  }
}

TEST(RayControl, FirstTakerAndAddressedSendTheRaysThemselves) {
  for (const Placement placement : {Placement::kFirstTaker, Placement::kAddressed}) {
    Bench bench(placement, Home::kIssuer, 4, 64, 16);
    EXPECT_TRUE(bench.control->rays_travel());
    bench.control->submit(rays(32));
    std::size_t total = 0;
    for (const auto& [issuer, group] : bench.collect_all()) {
      EXPECT_TRUE(group.ids.empty());
      total += group.rays.size();
      EXPECT_EQ(group.addresses.size(), placement == Placement::kAddressed ? group.rays.size() : 0u);
      std::map<std::uint32_t, int> addressed;
      for (const ResourceId r : group.addresses) ++addressed[r.value];
      for (const auto& [resource, count] : addressed) EXPECT_EQ(count, 4);
    }
    EXPECT_EQ(total, 32u);
    EXPECT_EQ(bench.control->free_slots(), 4 * 64u);
  }
}

TEST(RayControl, GivesEverySlotOnceUntilItIsFreed) {
  Bench bench(Placement::kFirstTaker, Home::kIssuer, 2, 5, 4);
  for (int round = 0; round < 3; ++round) {
    std::set<std::uint32_t> slots;
    while (const auto id = bench.control->load(ResourceId(1), RayRequest{}))
      EXPECT_TRUE(slots.insert(bench.stores[1]->slot(*id)).second);
    EXPECT_EQ(slots.size(), 5u);
    EXPECT_EQ(bench.control->free_slots(ResourceId(1)), 0u);
    EXPECT_EQ(bench.control->free_slots(ResourceId(0)), 5u);
    const std::vector<std::uint32_t> freed(slots.begin(), slots.end());
    for (const std::uint32_t slot : freed) bench.stores[1]->retire(slot);
    bench.control->free(ResourceId(1), freed);
  }
  EXPECT_EQ(bench.control->slots_used(), 15u);
}

TEST(RayControl, RaysWaitForSlotsInTheirOrder) {
  Bench bench(Placement::kBalanced, Home::kIssuer, 2, 2, 4);
  bench.control->submit(rays(10));
  bench.control->submit(rays(3, 10));  // behind the waiting rays
  std::vector<std::uint32_t> order;
  for (int round = 0; round < 20; ++round) {
    for (const auto& [issuer, group] : bench.collect_all()) {
      for (const RayId id : group.ids) {
        order.push_back(bench.path(id));
        RayStore& store = *bench.stores[bench.owner(id).value];
        const std::uint32_t slot = store.slot(id);
        store.retire(slot);
        bench.control->free(bench.owner(id), {&slot, 1});
      }
    }
    bench.control->place_waiting();
  }
  ASSERT_EQ(order.size(), 13u);
  for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  EXPECT_GT(bench.control->slot_waits(), 0u);
  EXPECT_FALSE(bench.control->place_waiting());
}

// Every ray that is submitted comes out once, in a slot that no other ray has, in whatever order slots are freed.
TEST(RayControl, AGroupThatWaitsCostsNoTurn) {
  Bench bench(Placement::kBalanced, Home::kIssuer, 2, 4, 8);
  bench.control->submit(rays(16));
  const auto first = bench.collect_all();
  ASSERT_EQ(first.size(), 1u);  // no slot is left for the second group
  EXPECT_EQ(first[0].first, 0u);
  bench.control->place_waiting();  // however often it is tried
  for (std::uint32_t r = 0; r < 2; ++r) bench.control->free(ResourceId(r), std::vector<std::uint32_t>{0, 1, 2, 3});
  bench.control->place_waiting();
  const auto second = bench.collect_all();
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0].first, 1u);
}

TEST(RayControl, AFullQueueHoldsNewRaysBack) {
  Bench bench(Placement::kRoundRobin, Home::kIssuer, 2, 64, 8);
  bench.control->queue_groups(QueueKind::kSpscRing, 2);
  bench.control->submit(rays(56));  // seven groups for two queues of two
  EXPECT_EQ(bench.control->free_slots(), 128u - 32);
  RayGroup more;
  more.ids.push_back(RayId{});
  EXPECT_FALSE(bench.control->deliver(ResourceId(1), more));
  EXPECT_EQ(more.ids.size(), 1u);  // as it was
  std::vector<std::uint32_t> order;
  for (const std::size_t groups : {4, 3, 0}) {
    const auto found = bench.collect_all();
    ASSERT_EQ(found.size(), groups);
    for (const auto& [issuer, group] : found)
      for (const RayId id : group.ids) order.push_back(bench.path(id));
    EXPECT_EQ(bench.control->place_waiting(), groups == 4);
  }
  std::sort(order.begin(), order.end());
  ASSERT_EQ(order.size(), 56u);
  for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  const QueueUse use = bench.control->groups_sent();
  EXPECT_EQ(use.sent, 7u);
  EXPECT_EQ(use.rays, 56u);
  EXPECT_EQ(use.places, 2u);
  EXPECT_EQ(use.waiting_most, 2u);
  EXPECT_EQ(bench.control->slot_waits(), 0u);  // there were slots
}

TEST(RayControl, LosesAndDoublesNothingUnderRandomCalls) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::minstd_rand random(seed);
    Bench bench(static_cast<Placement>(seed % 2), static_cast<Home>(seed / 2 % 3), 1 + random() % 6, 1 + random() % 20,
                1 + random() % 9);
    if (const std::uint32_t places = random() % 4; places > 0)
      bench.control->queue_groups(QueueKind::kMpmcRing, places);
    std::uint32_t submitted = 0;
    std::set<std::uint32_t> seen;
    std::set<std::pair<std::uint32_t, std::uint32_t>> in_use;
    for (int i = 0; i < 500 || seen.size() < submitted; ++i) {
      ASSERT_LT(i, 20000) << "rays wait for ever";
      if (i < 400 && random() % 3 == 0) {
        const std::uint32_t n = random() % 30;
        bench.control->submit(rays(n, submitted));
        submitted += n;
      }
      bench.control->place_waiting();
      for (const auto& [issuer, group] : bench.collect_all()) {
        EXPECT_LE(group.ids.size(), static_cast<std::size_t>(bench.config.packets.rays));
        for (const RayId id : group.ids) {
          ASSERT_TRUE(seen.insert(bench.path(id)).second);
          ASSERT_TRUE(in_use.insert({bench.owner(id).value, bench.stores[0]->layout().slot(id)}).second);
        }
      }
      for (auto it = in_use.begin(); it != in_use.end();) {
        if (random() % 3) {
          ++it;
          continue;
        }
        bench.stores[it->first]->retire(it->second);
        bench.control->free(ResourceId(it->first), {&it->second, 1});
        it = in_use.erase(it);
      }
      ASSERT_EQ(bench.control->free_slots() + in_use.size(),
                static_cast<std::size_t>(bench.config.topology.resources * bench.config.rays.slots_per_resource));
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
