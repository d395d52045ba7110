// One packet, step by step: its exact cost and effects.
#include "ringbus/resource/resource.h"

#include <bit>

#include <gtest/gtest.h>

#include "accel/box/slab.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/ringbus/resource/mock_ring.h"

namespace carousel::ringbus {
namespace {

using accel::empty_scene;
using accel::ray_to;

Config config(Traversal traversal = Traversal::kSpread, PacketShapes shapes = PacketShapes::kStrip) {
  Config c;
  c.topology.resources = 2;
  c.rays.slots_per_resource = 64;
  c.packets.rays = 8;
  c.packets.shapes = shapes;
  c.collections.traversal = traversal;
  c.collections.ready = 8;
  c.collections.when_full = WhenFull::kSpill;
  c.bvh.width = 4;
  return c;
}

/// A sphere, and eight rays, four at each of two resources, most of which hit it.
class ResourceTest : public testing::Test {
 protected:
  void start(const Config& c, const Vec3& direction = {0, 0, 1}) {
    ring_ = std::make_unique<MockRing>(c, scene_);
    for (std::uint32_t i = 0; i < 8; ++i) {
      const float x = 0.3f * static_cast<float>(i) - 1.0f;
      ids_.push_back(ring_->load(i % 2, ray_to(Vec3{x, 0.1f, 0} - 3.0f * direction, direction)));
    }
    resource(0).admit(ids_);
    packet_ = ring_->packet();
  }
  Resource& resource(std::uint32_t r) { return *ring_->resources[r]; }
  const ResourceStatistics& statistics(std::uint32_t r) { return ring_->sinks[r]->statistics(); }

  scene::Scene scene_ = accel::icosphere_scene(2);
  std::unique_ptr<MockRing> ring_;
  std::vector<RayId> ids_;
  Packet packet_;
};

TEST_F(ResourceTest, OneStripTestsLocalRaysAndNoOthers) {
  start(config());
  ASSERT_EQ(resource(0).offer(false, packet_), Resource::Offer::kPacket);
  EXPECT_EQ(packet_.kind, PacketKind::kTest);
  EXPECT_EQ(packet_.owner, ResourceId(0));
  EXPECT_EQ(packet_.key, ring_->accel.root_key());
  EXPECT_EQ(packet_.depth, 0);
  EXPECT_EQ(packet_.owners[0], 3u);
  ASSERT_EQ(packet_.members.size(), 8u);
  EXPECT_EQ(resource(0).packets_in_flight(), 1u);
  const auto boxes = static_cast<std::uint64_t>(ring_->accel.nodes[packet_.key.ref.node()].count);

  const TestOutcome outcome = resource(0).test(packet_);
  EXPECT_EQ(outcome.rays, 4u);
  EXPECT_EQ(outcome.reads, 4u);
  EXPECT_EQ(outcome.counts.box, 4 * boxes);
  EXPECT_EQ(outcome.bundles, nullptr);
  EXPECT_TRUE(outcome.any_hit_calls.empty());
  EXPECT_EQ(statistics(0).visits, 1u);
  EXPECT_EQ(statistics(0).local_rays, 4u);
  EXPECT_EQ(statistics(0).seen_rays, 8u);
  EXPECT_EQ(statistics(0).tests.box, 4 * boxes);
  EXPECT_EQ(statistics(0).tests.triangle, 0u);
  for (std::size_t i = 1; i < 8; i += 2) {
    EXPECT_EQ(packet_.members[i].mask, 0);  // the other resource's
    EXPECT_EQ(ring_->record(ids_[i]).pending, 1);
  }
  resource(1).test(packet_);
  std::uint64_t memberships = 0;
  std::size_t done = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const int hits = std::popcount(packet_.members[i].mask);
    EXPECT_EQ(ring_->record(ids_[i]).pending, hits);  // 1 + hits - 1
    memberships += static_cast<std::uint64_t>(hits);
    done += hits == 0;
  }
  EXPECT_GT(memberships, 4u);
  EXPECT_EQ(resource(0).completed().size() + resource(1).completed().size(), done);
  EXPECT_EQ(resource(0).collections().memberships(), 0u);  // not before it is back
  resource(0).retire(packet_);
  EXPECT_EQ(resource(0).collections().memberships(), memberships);
  EXPECT_EQ(statistics(0).memberships, memberships);
  EXPECT_EQ(statistics(0).packets_retired, 1u);
  EXPECT_EQ(resource(0).packets_in_flight(), 0u);
}

TEST_F(ResourceTest, BubbleCostsNothing) {
  Config c = config();
  c.topology.resources = 3;
  start(c);
  ASSERT_EQ(resource(0).offer(false, packet_), Resource::Offer::kPacket);
  resource(2).test(packet_);
  EXPECT_EQ(statistics(2).bubbles, 1u);
  EXPECT_EQ(statistics(2).local_rays, 0u);
  EXPECT_EQ(statistics(2).tests.box, 0u);
  for (const PacketMember& member : packet_.members) EXPECT_EQ(member.mask, 0);
}

TEST_F(ResourceTest, SingleShapesGoOutOneAPacket) {
  start(config(Traversal::kSpread, PacketShapes::kSingle));
  const int shapes = ring_->accel.strip_size(ring_->accel.root_key());
  ASSERT_GT(shapes, 1);
  for (const RayId id : ids_) EXPECT_EQ(ring_->record(id).pending, shapes);
  std::uint32_t lanes = 0;
  for (int i = 0; i < shapes; ++i) {
    Packet packet = ring_->packet();
    ASSERT_EQ(resource(0).offer(true, packet), Resource::Offer::kPacket);
    EXPECT_EQ(std::popcount(packet.lanes), 1);
    EXPECT_EQ(packet.members.size(), 8u);
    lanes |= packet.lanes;
    const std::int32_t before = ring_->record(ids_[0]).pending;
    resource(0).test(packet);
    EXPECT_EQ(statistics(0).tests.box, 4u * static_cast<unsigned>(i + 1));
    // One shape less to wait for; a hit child brings all of its own.
    const int lane = std::countr_zero(packet.lanes);
    const int below = ring_->accel.strip_size(ring_->accel.child_key(packet.key, lane));
    EXPECT_EQ(ring_->record(ids_[0]).pending, before - 1 + (packet.members[0].mask != 0 ? below : 0));
  }
  EXPECT_EQ(lanes, (1u << shapes) - 1);
  EXPECT_EQ(resource(0).offer(true, packet_), Resource::Offer::kNothing);  // nothing has been retired yet
}

TEST_F(ResourceTest, OrderedWritesTheNearestChildIntoThePacket) {
  start(config(Traversal::kOrdered), {0.9f, 0.8f, 1});  // through several children each
  ASSERT_EQ(resource(0).offer(false, packet_), Resource::Offer::kPacket);
  resource(0).test(packet_);
  resource(1).test(packet_);
  std::uint64_t going = 0, several = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const NextNode& next = packet_.next[i];
    EXPECT_EQ(next.any, ring_->record(ids_[i]).pending > 0);
    going += next.any;
    if (!next.any) continue;
    EXPECT_EQ(next.depth, 1);
    EXPECT_EQ(ring_->record(ids_[i]).pending, 1);  // in one collection at a time
    const accel::Node& node = ring_->accel.nodes[packet_.key.ref.node()];
    float nearest = kInfinity;
    int children = 0;
    for (int lane = 0; lane < node.count; ++lane) {
      Aabb box;
      for (int a = 0; a < 3; ++a) box.lo[a] = node.plane[a][lane], box.hi[a] = node.plane[a + 3][lane];
      float entry;
      if (!accel::slab(accel::SlabRay(ring_->record(ids_[i]).ray), box, kInfinity, entry)) continue;
      nearest = std::min(nearest, entry);
      ++children;
    }
    several += children > 1;
    EXPECT_EQ(next.entry, nearest);
  }
  EXPECT_GT(several, 3u);
  resource(0).retire(packet_);
  EXPECT_EQ(resource(0).collections().memberships(), going);
}

TEST_F(ResourceTest, TreeletIsTracedWholeInOneVisit) {
  Config c = config(Traversal::kTreelet);
  c.bvh.treelet_triangles = 1 << 20;
  start(c);
  ASSERT_EQ(resource(0).offer(false, packet_), Resource::Offer::kPacket);
  resource(0).test(packet_);
  EXPECT_EQ(resource(0).completed().size(), 4u);
  for (const RayResult& r : resource(0).completed())
    EXPECT_EQ(r.hit.valid(), accel::brute_force(scene_, {r.ray, r.tag}).valid());
  resource(1).test(packet_);
  EXPECT_EQ(resource(1).completed().size(), 4u);
  resource(0).retire(packet_);
  EXPECT_TRUE(resource(0).idle());
}

TEST_F(ResourceTest, PartialCollectionsWaitUnlessAskedFor) {
  Config c = config();
  c.collections.select = Select::kFullFirst;
  c.collections.ready = 9;
  start(c);
  EXPECT_EQ(resource(0).offer(false, packet_), Resource::Offer::kNothing);
  EXPECT_EQ(resource(0).offer(true, packet_), Resource::Offer::kPacket);
  EXPECT_EQ(resource(1).offer(true, packet_), Resource::Offer::kNothing);
}

TEST_F(ResourceTest, ShadowRayThatIsDoneIsSkippedButDrains) {
  Config c = config();
  ring_ = std::make_unique<MockRing>(c, scene_);
  RayRequest shadow = ray_to({0, 0.1f, -3}, {0, 0, 1}, 0, kInfinity, RayKind::kShadow);
  const RayId id = ring_->load(0, shadow);
  resource(0).admit({&id, 1});
  // Leaves first, so that the hit is found while other tests are still due.
  bool done_early = false;
  while (!resource(0).idle()) {
    packet_ = ring_->packet();
    ASSERT_EQ(resource(0).offer(true, packet_), Resource::Offer::kPacket);
    const bool done = ring_->record(id).hit.valid();
    const IntersectionCounts before = statistics(0).tests;
    EXPECT_TRUE(resource(0).completed().empty());
    resource(0).test(packet_);
    if (done) {
      done_early = true;
      EXPECT_EQ(statistics(0).tests.box, before.box);  // nothing more is tested
    }
    resource(0).retire(packet_);
  }
  EXPECT_TRUE(done_early);
  ASSERT_EQ(resource(0).completed().size(), 1u);
  EXPECT_TRUE(resource(0).completed()[0].hit.valid());
}

TEST(Resource, EmptySceneCompletesRaysAsMisses) {
  for (const PacketShapes shapes : {PacketShapes::kStrip, PacketShapes::kSingle}) {
    MockRing ring(config(Traversal::kSpread, shapes), empty_scene());
    const RayId id = ring.load(0, ray_to({0, 0, 0}, {0, 0, 1}));
    ring.resources[0]->admit({&id, 1});
    Packet packet = ring.packet();
    ASSERT_EQ(ring.resources[0]->offer(true, packet), Resource::Offer::kPacket);
    ring.resources[0]->test(packet);
    ring.resources[0]->retire(packet);
    ASSERT_EQ(ring.resources[0]->completed().size(), 1u);
    EXPECT_FALSE(ring.resources[0]->completed()[0].hit.valid());
    EXPECT_TRUE(ring.resources[0]->idle());
  }
}

}  // namespace
}  // namespace carousel::ringbus
