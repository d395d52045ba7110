// The checks before a run: whether it can deadlock, the storage it needs, the memory it takes.
#include "ringbus/protocol/deadlock.h"

#include <gtest/gtest.h>

#include "ringbus/protocol/memory_estimate.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

TEST(DeadlockVerdict, NamesTheRuleThatProtects) {
  TopologyConfig c;
  c.resources = 5;
  c.link.depth = 2;
  c.flow = Flow::kCredits;
  EXPECT_FALSE(deadlock_verdict(c).can_deadlock);
  EXPECT_NE(deadlock_verdict(c).rule.find("credits: 5 resources with at most 2 packets each"), std::string::npos);
  c.flow = Flow::kBubble;
  EXPECT_FALSE(deadlock_verdict(c).can_deadlock);
  EXPECT_NE(deadlock_verdict(c).rule.find("bubble"), std::string::npos);
  c.flow = Flow::kNone;
  EXPECT_TRUE(deadlock_verdict(c).can_deadlock);
  c.resources = 1;
  EXPECT_FALSE(deadlock_verdict(c).can_deadlock);  // no links
  c.resources = 5;
  c.shape = TopologyShape::kIndependent;
  EXPECT_FALSE(deadlock_verdict(c).can_deadlock);
  EXPECT_NE(deadlock_verdict(c).rule.find("no packets"), std::string::npos);
}

TEST(CheckStorage, AsksForWhatDrainingNeeds) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 50, 1);
  const accel::Accel& accel = scene.accel(BvhConfig{});
  Config c;
  c.packets.rays = 8;
  c.collections.capacity = minimum_capacity(c, accel.most_ways(), accel.levels());
  EXPECT_TRUE(check_storage(c, accel).empty());
  --c.collections.capacity;
  const std::vector<ConfigIssue> issues = check_storage(c, accel);
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].key_path, "collections.capacity");
  EXPECT_NE(issues[0].message.find(fmt::format("expected at least {} ray IDs", c.collections.capacity + 1)),
            std::string::npos)
      << issues[0].message;
  EXPECT_NE(issues[0].message.find("when_full: spill"), std::string::npos);
  c.collections.when_full = WhenFull::kSpill;
  c.collections.capacity = 8;
  EXPECT_TRUE(check_storage(c, accel).empty());
}

TEST(MemoryEstimate, GrowsWithWhatTakesMemory) {
  Config c;
  const MemoryEstimate base = estimate_memory(c, 10);
  EXPECT_GE(base.ray_store, 8u * 1024 * sizeof(RayRecord));
  EXPECT_EQ(base.ray_stacks, 0u);
  EXPECT_EQ(base.total(), base.ray_store + base.collections + base.packets + base.rays_waiting);
  Config more = c;
  more.rays.slots_per_resource *= 4;
  EXPECT_EQ(estimate_memory(more, 10).ray_store, 4 * base.ray_store);
  more = c;
  more.topology.resources *= 2;
  EXPECT_GE(estimate_memory(more, 10).total(), 2 * base.ray_store + base.collections);
  more = c;
  more.collections.traversal = Traversal::kOrdered;
  EXPECT_GT(estimate_memory(more, 20).ray_stacks, estimate_memory(more, 10).ray_stacks);
  more = c;
  more.topology.shape = TopologyShape::kIndependent;
  EXPECT_GT(estimate_memory(more, 10).ray_stacks, 0u);
  EXPECT_EQ(estimate_memory(more, 10).packets + estimate_memory(more, 10).collections, 0u);
  more = c;
  more.topology.shape = TopologyShape::kBidirectional;
  EXPECT_GT(estimate_memory(more, 10).packets, base.packets);
  more = c;
  more.engine.kind = EngineKind::kCycle;
  more.shading.workers = 256;
  more.shading.instruction_cache = {.bytes = 1 << 24, .line_bytes = 8};
  EXPECT_EQ(estimate_memory(more, 10).worker_caches, 0u) << "no programs";
  more.shading.program.standard = "built_in";
  // Of each line its name and its time.
  EXPECT_EQ(estimate_memory(more, 10).worker_caches, std::uint64_t{256} << 25);
  EXPECT_EQ(estimate_memory(more, 10).total(), estimate_memory(c, 10).total() + (std::uint64_t{256} << 25));
}

}  // namespace
}  // namespace carousel::ringbus
