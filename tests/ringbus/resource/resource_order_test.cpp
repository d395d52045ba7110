// Packets in any order: a mock engine that shuffles every step and reuses slots at once. A packet that still carries
// the ID of a ray that completed too early finds out, and a ray that completes too late is missing at the end.
#include <gtest/gtest.h>

#include "accel/traverse/reference_tracer.h"
#include "accel/traverse/verifying_workload.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/ringbus/resource/mock_ring.h"

namespace carousel::ringbus {
namespace {

using accel::same_result;

/// Runs all rays through a mock ring, choosing at random whose packet moves next.
class Shuffler {
 public:
  Shuffler(const Config& config, const scene::Scene& scene, RayBatch rays, std::uint32_t seed)
      : ring_(config, scene), rays_(std::move(rays)), random_(seed), got_(rays_.size()), seen_(rays_.size(), 0) {
    for (std::uint32_t i = 0; i < rays_.size(); ++i) rays_[i].tag.path = i;
  }

  void run() {
    for (std::size_t step = 0; completed_ < rays_.size(); ++step) {
      ASSERT_LT(step, 400000u) << "a ray never completed";
      admit();
      if (under_way_.size() < 12 && random_() % 2) issue();
      move();
      ASSERT_NO_FATAL_FAILURE(check());
    }
    while (!under_way_.empty()) move();
    for (const auto& r : ring_.resources) {
      EXPECT_TRUE(r->idle());
      EXPECT_EQ(r->packets_in_flight(), 0u);
    }
    for (std::size_t r = 0; r < ring_.free_slots.size(); ++r)
      EXPECT_EQ(ring_.free_slots[r].size(), ring_.stores[r]->slots());
    for (const int times : seen_) EXPECT_EQ(times, 1);
  }

  std::size_t wrong() const {
    HitBatch expected;
    IntersectionCounts counts;
    accel::trace_depth_first(ring_.accel, rays_, expected, counts);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) wrong += !same_result(expected[i], got_[i]);
    return wrong;
  }
  std::uint64_t reserve_entered() const {
    std::uint64_t sum = 0;
    for (const auto& sink : ring_.sinks) sum += sink->statistics().stalls[StallReason::kReserve];
    return sum;
  }
  std::uint64_t storage_refusals() const { return storage_refusals_; }

 private:
  struct UnderWay {
    std::unique_ptr<Packet> packet;
    std::uint32_t visits = 0;  // resources it has been to
  };

  std::uint32_t resources() const { return static_cast<std::uint32_t>(ring_.resources.size()); }

  void admit() {
    const std::uint32_t issuer = random_() % resources();
    std::vector<RayId> ids;
    const std::size_t room = std::min<std::size_t>(ring_.resources[issuer]->admissible(),
                                                   static_cast<std::size_t>(ring_.config.packets.rays));
    while (next_ < rays_.size() && ids.size() < room) {
      const std::uint32_t owner = ring_.config.collections.home == Home::kLocal ? issuer : random_() % resources();
      if (ring_.free_slots[owner].empty()) break;
      ids.push_back(ring_.load(owner, rays_[next_++]));
    }
    ring_.resources[issuer]->admit(ids);
    pending_ += static_cast<std::int64_t>(ids.size());
  }

  void issue() {
    auto packet = std::make_unique<Packet>(ring_.packet());
    const Resource::Offer offer = ring_.resources[random_() % resources()]->offer(true, *packet);
    storage_refusals_ += offer == Resource::Offer::kStorage;
    if (offer == Resource::Offer::kPacket) under_way_.push_back({std::move(packet)});
  }

  // A packet goes round the ring from its owner, which retires it.
  void move() {
    if (under_way_.empty()) return issue();
    std::swap(under_way_[random_() % under_way_.size()], under_way_.back());
    UnderWay& u = under_way_.back();
    if (u.visits < resources()) {
      const std::uint32_t at = (u.packet->owner.value + u.visits++) % resources();
      if (u.packet->kind == PacketKind::kTest)
        ring_.resources[at]->test(*u.packet);
      else if (u.packet->home.value == at)
        ring_.resources[at]->join(*u.packet);
    } else {
      ring_.resources[u.packet->owner.value]->retire(*u.packet);
      under_way_.pop_back();
    }
    for (std::uint32_t r = 0; r < resources(); ++r) {
      for (const RayResult& result : ring_.take_completed(r)) {
        ++completed_;
        ++seen_[result.tag.path];
        got_[result.tag.path] = result;
      }
    }
  }

  void check() const {
    if (ring_.config.collections.when_full != WhenFull::kReserve) return;
    for (const auto& r : ring_.resources) ASSERT_GE(r->collections().free_blocks(), 0) << "storage overran";
  }

  MockRing ring_;
  RayBatch rays_;
  std::minstd_rand random_;
  HitBatch got_;
  std::vector<int> seen_;
  std::size_t next_ = 0, completed_ = 0;
  std::int64_t pending_ = 0;
  std::uint64_t storage_refusals_ = 0;
  std::vector<UnderWay> under_way_;
};

Config config_of(Traversal traversal, PacketShapes shapes, std::uint32_t seed) {
  Config c;
  c.topology.resources = 1 + seed % 4;
  c.rays.slots_per_resource = seed % 3 ? 12 : 3;
  c.packets.rays = std::array{1, 3, 8}[seed % 3];
  c.packets.shapes = shapes;
  c.collections.traversal = traversal;
  c.collections.policy = static_cast<Policy>(seed % 5);
  c.collections.select = static_cast<Select>(seed / 5 % 2);
  c.collections.home = static_cast<Home>(seed % 3);
  c.collections.when_full = c.collections.home == Home::kHash || seed % 4 == 0 ? WhenFull::kSpill : WhenFull::kReserve;
  c.collections.ready = 4;
  c.bvh.width = std::array{2, 4, 8}[seed / 2 % 3];
  c.bvh.leaf_triangles = std::array{1, 4, 16}[seed / 3 % 3];
  c.bvh.treelet_triangles = 20;
  return c;
}

void shuffle(Traversal traversal, PacketShapes shapes) {
  std::uint64_t reserve = 0, refusals = 0;
  for (const bool instanced : {false, true}) {
    const scene::Scene scene =
        instanced ? accel::small_builtin(BuiltinScene::kInstances, 100, 5) : accel::icosphere_scene(2);
    for (std::uint32_t seed = 1; seed <= 30; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << (instanced ? " instances" : " sphere"));
      Shuffler shuffler(config_of(traversal, shapes, seed), scene, accel::mixed_rays(scene, 60, seed), seed);
      ASSERT_NO_FATAL_FAILURE(shuffler.run());
      EXPECT_EQ(shuffler.wrong(), 0u);
      reserve += shuffler.reserve_entered();
      refusals += shuffler.storage_refusals();
    }
  }
  if (traversal == Traversal::kOrdered) return;  // needs no reserve
  EXPECT_GT(reserve, 0u);
  EXPECT_GT(refusals, 0u);
}

TEST(ResourceOrder, StripsOfSpreadRaysComeOutRight) {
  shuffle(Traversal::kSpread, PacketShapes::kStrip);
}
TEST(ResourceOrder, SingleShapesOfSpreadRaysComeOutRight) {
  shuffle(Traversal::kSpread, PacketShapes::kSingle);
}
TEST(ResourceOrder, OrderedRaysComeOutRight) {
  shuffle(Traversal::kOrdered, PacketShapes::kStrip);
}
TEST(ResourceOrder, StripsOfTreeletsComeOutRight) {
  shuffle(Traversal::kTreelet, PacketShapes::kStrip);
}
TEST(ResourceOrder, SingleShapesOfTreeletsComeOutRight) {
  shuffle(Traversal::kTreelet, PacketShapes::kSingle);
}

}  // namespace
}  // namespace carousel::ringbus
