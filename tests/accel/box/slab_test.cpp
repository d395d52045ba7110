#include "accel/box/slab.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "accel/traverse/kernels.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

bool hits(const Ray& ray, const Aabb& box, float& entry, float tmax = kInfinity) {
  return slab(SlabRay(ray), box, tmax, entry);
}
bool hits(const Ray& ray, const Aabb& box) {
  float entry;
  return hits(ray, box, entry);
}
Ray unit_ray(const Vec3& origin, const Vec3& direction, float tmin = 0) {
  return {origin, tmin, direction, kInfinity};
}

const Aabb kUnitBox{Vec3{-1}, Vec3{1}};

// The ray lies exactly in a face, along the axes: 0 * inf.
TEST(Slab, RayInFacePlaneHits) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      for (int other = 1; other < 3; ++other) {
        for (const float side : {-1.0f, 1.0f}) {
          for (const float zero : {0.0f, -0.0f}) {
            Ray r = unit_ray(Vec3{0}, Vec3{zero});
            r.origin[axis] = -3 * sign;
            r.direction[axis] = sign;
            r.origin[(axis + other) % 3] = side;
            float entry = -1;
            EXPECT_TRUE(hits(r, kUnitBox, entry));
            EXPECT_EQ(entry, 2);
          }
        }
      }
    }
  }
}

TEST(Slab, RayBesideBoxWithZeroComponentMisses) {
  for (const float zero : {0.0f, -0.0f}) {
    for (const float side : {-1.5f, 1.5f}) {
      float entry;
      EXPECT_FALSE(hits(unit_ray({side, 0, -3}, {zero, zero, 1}), kUnitBox, entry, 1e30f));
      EXPECT_FALSE(hits(unit_ray({0, side, -3}, {zero, zero, 1}), kUnitBox, entry, 1e30f));
    }
  }
}

TEST(Slab, FlatAndPointBoxesAreHit) {
  EXPECT_TRUE(hits(unit_ray({0, 0, -1}, {0, 0, 1}), {{-1, -1, 0}, {1, 1, 0}}));  // face on
  EXPECT_TRUE(hits(unit_ray({-2, 0, 0}, {1, 0, 0}), {{-1, -1, 0}, {1, 1, 0}}));  // edge on
  EXPECT_TRUE(hits(unit_ray({-2, 0, 0}, {1, 0, 0}), {{0, 0, 0}, {0, 0, 0}}));    // a point, dead on
  EXPECT_TRUE(hits(unit_ray({1, 2, 3}, {1, 2, 3}), {{2, 4, 6}, {2, 4, 6}}));
  EXPECT_FALSE(hits(unit_ray({-2, 0.001f, 0.001f}, {1, 1e-9f, 0}), {{0, 0, 0}, {0, 0, 0}}));
}

TEST(Slab, OriginInsideEntersAtTmin) {
  float entry = -1;
  EXPECT_TRUE(hits(unit_ray({0.5f, 0, 0}, {0.3f, -0.2f, 0.9f}), kUnitBox, entry));
  EXPECT_EQ(entry, 0);
  EXPECT_TRUE(hits(unit_ray({0.5f, 0, 0}, {0.3f, -0.2f, 0.9f}, 0.25f), kUnitBox, entry));
  EXPECT_EQ(entry, 0.25f);
}

TEST(Slab, TmaxAtEntryStillHits) {
  float entry;
  EXPECT_TRUE(hits(unit_ray({0, 0, -3}, {0, 0, 1}), kUnitBox, entry, 2.0f));
  EXPECT_FALSE(hits(unit_ray({0, 0, -3}, {0, 0, 1}), kUnitBox, entry, std::nextafter(2.0f, 0.0f)));
}

TEST(Slab, BoxBehindOrEmptyMisses) {
  EXPECT_FALSE(hits(unit_ray({0, 0, 3}, {0, 0, 1}), kUnitBox));
  EXPECT_FALSE(hits(unit_ray({0, 0, -3}, {0, 0, 1}, 4.1f), kUnitBox));
  float entry;
  EXPECT_FALSE(hits(unit_ray({0, 0, -3}, {0.1f, 0.2f, 1}), Aabb{}, entry, 1e30f));
}

TEST(Slab, EmptyLanesAreNeverHitWhateverTheRay) {
  const Node node;
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    Ray r = unit_ray(random.in_box(Vec3{-1}, Vec3{1}), random.in_box(Vec3{-1}, Vec3{1}));
    r.direction[static_cast<int>(random.below(3))] = random.below(2) ? 0.0f : random.any_bits();
    Accel accel;
    RayRecord record;
    record.ray = r;
    record.hit.t = kInfinity;
    if (!std::isfinite(r.direction.x + r.direction.y + r.direction.z)) continue;
    accel.nodes.push_back(node);
    accel.nodes[0].count = 8;  // so that the lanes count as children
    std::uint8_t mask = 0xff;
    float nearest[kMaxWidth] = {};
    IntersectionCounts counts;
    test_strip(accel, {kNoInstance, NodeRef::inner(0)}, ~0u, {&record, nullptr, 1}, {&mask, nearest, nullptr}, counts);
    ASSERT_EQ(mask, 0) << i;
  }
}

// Rays that fill registers together, whatever their bits, and some that are done.
TEST(Slab, RaysTogetherMeetWhatEachMeetsAlone) {
  Random random(50);
  for (const SimdTarget target : usable_simd_targets()) {
    const SimdGuard guard;
    select_simd_target(target);
    std::size_t met = 0;
    for (std::size_t rays = 1; rays <= 40; ++rays) {
      Accel accel;
      Node& node = accel.nodes.emplace_back();
      node.count = static_cast<std::uint8_t>(1 + random.below(8));
      for (int lane = 0; lane < node.count; ++lane) {
        const Vec3 a = random.in_box(Vec3{-1}, Vec3{1}), b = random.in_box(Vec3{-1}, Vec3{1});
        for (int axis = 0; axis < 3; ++axis) {
          node.plane[axis][lane] = std::min(a[axis], b[axis]);
          node.plane[axis + 3][lane] = std::max(a[axis], b[axis]);
        }
      }
      std::vector<RayRecord> records(rays);
      for (std::size_t i = 0; i < rays; ++i) {
        RayRecord& record = records[i];
        record.ray.origin = random.in_box(Vec3{-2}, Vec3{2});
        record.ray.direction = random.in_box(Vec3{-0.5f}, Vec3{0.5f}) - record.ray.origin;
        const int axis = static_cast<int>(random.below(3));
        if (i % 4 == 0) record.ray.origin[axis] = node.plane[axis][0];
        if (i % 3 == 0) record.ray.direction[axis] = i % 2 == 0 ? 0.0f : random.any_bits();
        if (i % 7 == 0) record.ray.tmin = random.any_bits();
        record.hit.t = i % 5 == 0 ? random.any_bits() : kInfinity;
        record.tag.flags = i % 6 == 0 ? kRayDone : 0;
      }
      const NodeKey key{kNoInstance, NodeRef::inner(0)};
      float nearest[2][kMaxWidth];
      for (float* const each : nearest) std::fill(each, each + kMaxWidth, kInfinity);
      IntersectionCounts counts[2];
      std::vector<std::uint8_t> together(rays), alone(rays);
      test_strip(accel, key, 0x7f, {records.data(), nullptr, rays}, {together.data(), nearest[0], nullptr}, counts[0]);
      for (std::size_t i = 0; i < rays; ++i)
        test_strip(accel, key, 0x7f, {&records[i], nullptr, 1}, {&alone[i], nearest[1], nullptr}, counts[1]);
      ASSERT_EQ(together, alone) << rays << " rays, target " << enum_name(target);
      for (int lane = 0; lane < kMaxWidth; ++lane) ASSERT_EQ(nearest[0][lane], nearest[1][lane]) << lane;
      ASSERT_EQ(counts[0].box, counts[1].box);
      for (const std::uint8_t mask : alone) met += mask != 0;
    }
    EXPECT_GT(met, 100u);
  }
}

TEST(Slab, DenormalDirectionsAreConservative) {
  const float tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_TRUE(hits(unit_ray({0, 0, -1}, {tiny, tiny, 1}), kUnitBox));
  EXPECT_TRUE(hits(unit_ray({1, 0, -3}, {tiny, 0, 1}), kUnitBox));
  EXPECT_TRUE(hits(unit_ray({-1, 0, -3}, {-tiny, 0, 1}), kUnitBox));
  float entry = 0;
  EXPECT_TRUE(hits(unit_ray({0, 0, -3}, {0, 0, tiny}), kUnitBox, entry));  // 2 / tiny is beyond every float
}

// Their reciprocal overflows, but the distance to a near plane need not.
TEST(Slab, DenormalDirectionsEnterNoLaterThanExactly) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      Ray r = unit_ray(Vec3{0}, Vec3{0});
      r.origin[axis] = -1.001f * sign;
      r.direction[axis] = 2e-39f * sign;  // enters at 5e35
      float entry = 0;
      EXPECT_TRUE(hits(r, kUnitBox, entry, 1e38f));
      EXPECT_LE(entry, 0.5e36f);
    }
  }
}

// Pruning is independent of the tree because every box around a hit box is hit, and entered no later.
TEST(Slab, EnclosingBoxIsHitAndEnteredNoLater) {
  Random random(2);
  int both = 0;
  for (int i = 0; i < 300000; ++i) {
    Aabb inner;
    inner.extend(random.in_box(Vec3{-1}, Vec3{1}));
    if (i % 4) inner.extend(random.in_box(Vec3{-1}, Vec3{1}));
    Aabb outer = inner;
    if (i % 3) outer.extend(random.in_box(Vec3{-2}, Vec3{2}));
    Ray r = unit_ray(random.in_box(Vec3{-3}, Vec3{3}), Vec3{0});
    const Vec3 target = i % 2 ? inner.lo : random.in_box(inner.lo, inner.hi);
    r.direction = target - r.origin;
    if (i % 5 == 0) r.origin[static_cast<int>(random.below(3))] = inner.hi.x;
    if (i % 7 == 0) r.direction[static_cast<int>(random.below(3))] = i % 2 ? 0.0f : -0.0f;
    if (i % 11 == 0) r.direction[static_cast<int>(random.below(3))] = random.uniform() * 1e-40f;
    if (i % 13 == 0) r.tmin = random.uniform();
    const float tmax = i % 2 ? kInfinity : random.uniform(0, 3);
    float in, out;
    if (!hits(r, inner, in, tmax)) continue;
    ASSERT_TRUE(hits(r, outer, out, tmax)) << i;
    ASSERT_LE(out, in) << i;
    ++both;
  }
  EXPECT_GT(both, 100000);
}

// Differences of such floats and products of two of them are exact in long double's 64 bits, so this compares
// entry_i <= exit_j for all axes without error.
bool exactly_hit(const Ray& r, const Aabb& box) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto plane = [&](int axis, bool near) {
        const bool low = (r.direction[axis] > 0) == near;
        return (static_cast<long double>(low ? box.lo[axis] : box.hi[axis]) - r.origin[axis]);
      };
      if (r.direction[i] == 0) {
        if (r.origin[i] < box.lo[i] || r.origin[i] > box.hi[i]) return false;
        continue;
      }
      if (plane(i, false) * r.direction[i] < 0) return false;  // behind
      if (r.direction[j] == 0) continue;
      if (plane(i, true) * std::fabs(r.direction[j]) * (r.direction[i] < 0 ? -1 : 1) >
          plane(j, false) * std::fabs(r.direction[i]) * (r.direction[j] < 0 ? -1 : 1))
        return false;
    }
  }
  return true;
}

TEST(Slab, MissesNoBoxTheExactRayMeets) {
  Random random(3);
  const auto grid = [&] {
    return std::ldexp(static_cast<float>(static_cast<int>(random.below(1u << 17)) - (1 << 16)), -16);
  };
  int exact = 0, edge = 0;
  for (int i = 0; i < 300000; ++i) {
    Aabb box;
    box.extend({grid(), grid(), grid()});
    box.extend({grid(), grid(), grid()});
    Ray r = unit_ray({3 * grid(), 3 * grid(), 3 * grid()}, Vec3{0});
    // At edges and corners, where hit and miss are one unit of rounding apart.
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t where = random.below(3);
      r.direction[axis] = (where == 0 ? box.lo[axis] : where == 1 ? box.hi[axis] : grid()) - r.origin[axis];
    }
    if (r.direction == Vec3{0} || !exactly_hit(r, box)) continue;
    ++exact;
    ASSERT_TRUE(hits(r, box)) << i;
    Ray beside = r;  // nudged by a unit: about half still hit
    beside.direction[static_cast<int>(random.below(3))] *= 1 + 0x1p-23f;
    if (!exactly_hit(beside, box)) continue;
    ++edge;
    ASSERT_TRUE(hits(beside, box)) << i;
  }
  EXPECT_GT(exact, 20000);
  EXPECT_GT(edge, 5000);
}

// Lane by lane, target by target, the SIMD test is the scalar one, to the bit of the entry.
TEST(Slab, EveryLaneOfEveryTargetEqualsScalar) {
  for (const SimdTarget target : usable_simd_targets()) {
    const SimdGuard guard;
    select_simd_target(target);
    Random random(4);
    for (int i = 0; i < 3000; ++i) {
      Accel accel;
      Node& node = accel.nodes.emplace_back();
      node.count = static_cast<std::uint8_t>(1 + random.below(8));
      Aabb boxes[kMaxWidth];
      for (int lane = 0; lane < node.count; ++lane) {
        boxes[lane].extend(random.in_box(Vec3{-1}, Vec3{1}));
        boxes[lane].extend(random.in_box(Vec3{-1}, Vec3{1}));
        for (int axis = 0; axis < 3; ++axis) {
          node.plane[axis][lane] = boxes[lane].lo[axis];
          node.plane[axis + 3][lane] = boxes[lane].hi[axis];
        }
      }
      RayRecord record;
      record.ray = unit_ray(random.in_box(Vec3{-2}, Vec3{2}), random.in_box(Vec3{-1}, Vec3{1}));
      if (i % 3 == 0) record.ray.direction[static_cast<int>(random.below(3))] = i % 2 ? 0.0f : -0.0f;
      if (i % 5 == 0) record.ray.origin = boxes[0].lo;
      record.hit.t = i % 2 ? kInfinity : 1.0f;
      std::uint8_t mask = 0;
      float nearest[kMaxWidth], entries[kMaxWidth];
      std::fill(nearest, nearest + kMaxWidth, kInfinity);
      IntersectionCounts counts;
      const std::uint32_t lanes = i % 4 ? ~0u : 0x55u;
      test_strip(accel, {kNoInstance, NodeRef::inner(0)}, lanes, {&record, nullptr, 1}, {&mask, nearest, entries},
                 counts);
      for (int lane = 0; lane < node.count; ++lane) {
        float entry;
        const bool hit = hits(record.ray, boxes[lane], entry, record.hit.t) && (lanes >> lane & 1);
        ASSERT_EQ((mask >> lane & 1) != 0, hit);
        if (!hit) continue;
        ASSERT_EQ(std::bit_cast<std::uint32_t>(entries[lane]), std::bit_cast<std::uint32_t>(entry));
        ASSERT_EQ(nearest[lane], entry);
      }
      ASSERT_EQ(mask >> node.count, 0);
    }
  }
}

}  // namespace
}  // namespace carousel::accel
