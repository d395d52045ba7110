#include "ringbus/rays/ray_store.h"

#include <string>

#include <gtest/gtest.h>

#include "ringbus/resource/traversal/ray_stacks.h"

namespace carousel::ringbus {
namespace {

TEST(RayId, KeepsOwnerAndSlotApart) {
  for (const std::uint32_t slots : {1u, 2u, 3u, 1000u, 1024u, 1u << 20}) {
    const RayIdLayout layout(slots);
    for (const std::uint32_t owner : {0u, 1u, 2u, 255u, 1023u}) {
      for (const std::uint32_t slot : {0u, slots / 2, slots - 1}) {
        const RayId id = layout.make(ResourceId(owner), slot);
        EXPECT_EQ(layout.owner(id), ResourceId(owner));
        EXPECT_EQ(layout.slot(id), slot);
      }
    }
  }
}

TEST(RayId, CarriesItsGenerationInCheckedBuildsOnly) {
  EXPECT_EQ(sizeof(RayId), kChecked ? 8u : 4u);
}

RayRequest request(float tmax = kInfinity) {
  RayRequest r;
  r.ray.tmax = tmax;
  r.tag.path = 9;
  return r;
}

TEST(RayStore, LoadsAFreshRecord) {
  RayStore store(ResourceId(3), 5);
  store.record(2).hit = {1, 0.5f, 0.5f, 4, 4};  // left by an earlier ray
  store.record(2).tag.flags = 0xff;
  const RayId id = store.load(2, request(8), 3);
  EXPECT_TRUE(store.owns(id));
  EXPECT_EQ(store.slot(id), 2u);
  const RayRecord& record = store.record(2);
  EXPECT_EQ(record.pending, 3);
  EXPECT_FALSE(record.hit.valid());
  EXPECT_EQ(record.hit.t, 8);
  EXPECT_EQ(record.tag.flags, 0);
  EXPECT_EQ(record.tag.path, 9u);
}

TEST(RayStore, OwnsNoRayOfAnother) {
  RayStore store(ResourceId(3), 5), other(ResourceId(4), 5);
  EXPECT_FALSE(store.owns(other.load(0, request(), 1)));
}

TEST(RayStore, CatchesStaleIds) {
  if constexpr (!kChecked) GTEST_SKIP() << "IDs carry no generation in this build";
  RayStore store(ResourceId(1), 2);
  const RayId first = store.load(0, request(), 1);
  EXPECT_NO_THROW(store.slot(first));
  store.retire(0);
  EXPECT_THROW(store.slot(first), SimulationError);  // freed
  const RayId second = store.load(0, request(), 1);
  EXPECT_NO_THROW(store.slot(second));
  try {
    store.slot(first);  // handed out again
    FAIL();
  } catch (const SimulationError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("stale ray ID: resource 1 slot 0"), std::string::npos) << text;
    EXPECT_NE(text.find("generation"), std::string::npos) << text;
  }
}

NextNode node(float entry, std::uint32_t ref) {
  return {{0, accel::NodeRef::from_bits(ref)}, entry, 1, true};
}

TEST(RayStacks, PopsTheLastPushedThatIsNotBeyondTmax) {
  RayStacks stacks(2, 8, 4);
  stacks.clear(0);
  stacks.clear(1);
  EXPECT_FALSE(stacks.pop(0, kInfinity).any);
  stacks.push(0, node(5, 1));
  stacks.push(0, node(3, 2));
  stacks.push(1, node(9, 3));
  EXPECT_EQ(stacks.pop(0, 4).key.ref.bits(), 2u);
  stacks.push(0, node(6, 4));
  EXPECT_EQ(stacks.pop(0, 5).key.ref.bits(), 1u);  // 6 is beyond; 5 is not
  EXPECT_FALSE(stacks.pop(0, kInfinity).any);
  EXPECT_EQ(stacks.pop(1, 9).key.ref.bits(), 3u);  // the neighbour's is untouched
  stacks.push(1, node(1, 5));
  stacks.clear(1);
  EXPECT_FALSE(stacks.pop(1, kInfinity).any);
}

TEST(RayStacks, HoldTheDeepestStackPossible) {
  for (const int width : {2, 8}) {
    for (const int depth : {1, 3, 10}) {
      RayStacks stacks(3, width, depth);
      ASSERT_GE(stacks.capacity(), static_cast<std::size_t>((width - 1) * depth + 1));
      for (std::uint32_t slot = 0; slot < 3; ++slot) {
        stacks.clear(slot);
        for (std::uint32_t i = 0; i < stacks.capacity(); ++i) stacks.push(slot, node(1, 1000 * slot + i));
      }
      for (std::uint32_t slot = 0; slot < 3; ++slot)
        for (auto i = static_cast<std::uint32_t>(stacks.capacity()); i-- > 0;)
          ASSERT_EQ(stacks.pop(slot, 1).key.ref.bits(), 1000 * slot + i);
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
