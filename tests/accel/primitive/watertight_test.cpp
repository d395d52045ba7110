#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/traverse/verifying_workload.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

// Rays from inside a closed mesh, aimed at its edges and vertices: each one that gets out is a leak.
std::size_t leaks(const scene::Scene& scene, const Accel& accel, std::size_t count, const Vec3& centre, float inside,
                  std::uint64_t seed) {
  Random random(seed);
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Vec3, 3> p = random_triangle(scene, random);
    const Vec3 from = centre + random.in_box(Vec3{-inside}, Vec3{inside});
    const Vec3 at = i % 3 == 0 ? p[i % 2] : i % 3 == 1 ? p[0] + random.uniform() * (p[1] - p[0]) : 0.5f * (p[1] + p[2]);
    rays.push_back(ray_to(i % 5 ? from : centre, at - (i % 5 ? from : centre)));
  }
  std::size_t leaks = 0;
  for (const RayResult& r : trace(accel, rays)) leaks += !r.hit.valid();
  return leaks;
}

TEST(Watertight, ClosedSphereLeaksNothing) {
  const scene::Scene scene = icosphere_scene(3);
  for (const std::int64_t leaf : {1, 4, 16})
    EXPECT_EQ(leaks(scene, build_sequential(scene, 8, leaf), 100000, Vec3{0}, 0.5f, 31), 0u);
}

TEST(Watertight, ClosedSphereFarFromOriginLeaksNothing) {
  const Vec3 centre{1000, -3000, 500};
  const scene::Scene scene = icosphere_scene(3, centre, 1.0f);
  EXPECT_EQ(leaks(scene, build_sequential(scene), 100000, centre, 0.25f, 32), 0u);
}

TEST(Watertight, TransformedSphereLeaksNothing) {
  scene::Scene scene = icosphere_scene(2);
  scene.instances[0].world_from_model = {Mat3{0.3f, 0.8f, -0.5f, -1.9f, 0.6f, 0.1f, 0.2f, 0.3f, 0.9f}, {5, 6, 7}};
  EXPECT_EQ(leaks(scene, build_sequential(scene), 100000, {5, 6, 7}, 0.1f, 33), 0u);
}

// A mesh whose edges run along the axes: edge values of exactly zero, which take the double path.
TEST(Watertight, GridAlignedBoxLeaksNothing) {
  scene::Mesh box;
  const auto index = [&](const Vec3& p) {
    const auto it = std::find(box.positions.begin(), box.positions.end(), p);
    if (it != box.positions.end()) return static_cast<std::uint32_t>(it - box.positions.begin());
    box.positions.push_back(p);
    return static_cast<std::uint32_t>(box.positions.size() - 1);
  };
  constexpr int kSteps = 8;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
          std::uint32_t q[2][2];
          for (int a = 0; a < 2; ++a) {
            for (int b = 0; b < 2; ++b) {
              Vec3 p;
              p[axis] = side;
              p[(axis + 1) % 3] = -1 + 2.0f * static_cast<float>(i + a) / kSteps;
              p[(axis + 2) % 3] = -1 + 2.0f * static_cast<float>(j + b) / kSteps;
              q[a][b] = index(p);
            }
          }
          box.indices.insert(box.indices.end(), {q[0][0], q[1][0], q[1][1], q[0][0], q[1][1], q[0][1]});
        }
      }
    }
  }
  const scene::Scene scene = scene_of(box);
  const Accel accel = build_sequential(scene);
  EXPECT_EQ(leaks(scene, accel, 100000, Vec3{0}, 0.5f, 34), 0u);
  RayBatch along;  // along the axes, through vertices and edges
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      for (int i = -2 * kSteps; i <= 2 * kSteps; ++i) {
        for (int j = -2 * kSteps; j <= 2 * kSteps; ++j) {
          RayRequest r = ray_to(Vec3{0}, Vec3{0});
          r.ray.origin[(axis + 1) % 3] = static_cast<float>(i) / (2 * kSteps);
          r.ray.origin[(axis + 2) % 3] = static_cast<float>(j) / (2 * kSteps);
          r.ray.direction[axis] = sign;
          along.push_back(r);
        }
      }
    }
  }
  for (const RayResult& r : trace(accel, along)) ASSERT_TRUE(r.hit.valid()) << r.ray.origin.x << " " << r.ray.origin.y;
}

// Neither the lane a triangle stands in nor what stands beside it may change a bit of its hit.
TEST(Watertight, EveryLaneOfEveryTargetGivesSameBits) {
  Random random(35);
  for (int round = 0; round < 60; ++round) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 48; ++i) corners.push_back(random.in_box(Vec3{-1}, Vec3{1}));
    const scene::Scene scene = scene_of(soup(corners));
    Accel accel = build_sequential(scene, 8, 16);
    RayRecord start;
    start.ray = ray_to(random.in_box(Vec3{-2}, Vec3{2}), Vec3{0}).ray;
    const Vec3 aim = round % 2 ? corners[0] : random.in_box(Vec3{-1}, Vec3{1});
    start.ray.direction = aim - start.ray.origin;
    for (std::uint32_t triangle = 0; triangle < 16; ++triangle) {
      Hit expected;
      for (const SimdTarget target : usable_simd_targets()) {
        const SimdGuard guard;
        select_simd_target(target);
        for (int place = 0; place < 16; ++place) {
          // Odd places: alone, first in its block. Even ones: among 15 others, all lanes but its own switched off.
          const bool alone = place % 2 != 0;
          Accel moved = accel;
          moved.blocks.assign(4, TriangleBlock{});
          for (int p = 0; p < 16; ++p) {
            if (alone && p != place) continue;
            const std::uint32_t t = (triangle + static_cast<std::uint32_t>(p - place + 16)) % 16;
            TriangleBlock& block = moved.blocks[static_cast<std::size_t>(p / 4)];
            const int lane = alone ? 0 : p % 4;
            block.primitive[lane] = t;
            for (int k = 0; k < 3; ++k)
              for (int axis = 0; axis < 3; ++axis)
                block.vertex[k][axis][lane] = corners[3 * t + static_cast<std::uint32_t>(k)][axis];
          }
          RayRecord record = start;
          IntersectionCounts counts;
          const NodeRef leaf = alone ? NodeRef::leaf(static_cast<std::uint32_t>(place / 4), 1) : NodeRef::leaf(0, 16);
          test_strip(moved, {0, leaf}, alone ? ~0u : 1u << place, {&record, nullptr, 1}, {}, counts);
          const RayResult got{record.ray, record.hit, record.tag}, want{record.ray, expected, record.tag};
          if (place == 0 && target == SimdTarget::kAuto)
            expected = record.hit;
          else
            ASSERT_TRUE(same_result(got, want)) << "place " << place << " triangle " << triangle;
        }
      }
    }
  }
}

TEST(Watertight, BothWindingsAndMirrorsHit) {
  Random random(36);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 a = random.in_box(Vec3{-1}, Vec3{1}), b = random.in_box(Vec3{-1}, Vec3{1}),
               c = random.in_box(Vec3{-1}, Vec3{1});
    const Vec3 from = random.in_box(Vec3{-3}, Vec3{3});
    const float u = random.uniform(0.1f, 0.8f), v = random.uniform(0.05f, 0.9f - u);
    const Vec3 n = glm::cross(b - a, c - a), d = a + u * (b - a) + v * (c - a) - from;
    if (std::fabs(glm::dot(n, d)) < 1e-3f) continue;
    const Hit front = trace_one(build_sequential(scene_of(soup({a, b, c}))), ray_to(from, d));
    const Hit back = trace_one(build_sequential(scene_of(soup({a, c, b}))), ray_to(from, d));
    ASSERT_TRUE(front.valid());
    ASSERT_TRUE(back.valid());
    ASSERT_NEAR(front.u, back.v, 1e-4f);
    ASSERT_NEAR(front.t, back.t, 1e-4f);
    ASSERT_NEAR(front.t, 1, 1e-3f);
  }
}

TEST(Watertight, NanLanesAreNeverHit) {
  Random random(37);
  const scene::Scene scene = scene_of(soup({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}));
  for (const SimdTarget target : usable_simd_targets()) {
    const SimdGuard guard;
    select_simd_target(target);
    const Accel accel = build_sequential(scene);
    ASSERT_EQ(accel.blocks.size(), 1u);
    ASSERT_EQ(accel.blocks[0].primitive[1], kNoPrimitive);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 from = random.in_box(Vec3{-2}, Vec3{2});
      Vec3 direction = random.in_box(Vec3{-1}, Vec3{1}) - from;
      if (i % 3 == 0) direction[static_cast<int>(random.below(3))] = 0;
      if (direction == Vec3{0}) continue;
      const Hit hit = trace_one(accel, ray_to(from, direction));
      if (hit.valid()) {
        ASSERT_EQ(hit.primitive, 0u);
      }
    }
  }
}

TEST(Watertight, TriangleWithCoincidentVerticesIsMissed) {
  Random random(38);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 a = random.in_box(Vec3{-1}, Vec3{1}), b = random.in_box(Vec3{-1}, Vec3{1});
    const Vec3 from = random.in_box(Vec3{-3}, Vec3{3});
    const Accel accel = build_sequential(scene_of(soup({a, a, a, a, b, b, a, a, b, a, b, a})));
    EXPECT_FALSE(trace_one(accel, ray_to(from, a - from)).valid());
    EXPECT_FALSE(trace_one(accel, ray_to(from, b - from)).valid());
    EXPECT_FALSE(trace_one(accel, ray_to(from, 0.5f * (a + b) - from)).valid());
  }
}

// Three vertices on a line: shearing rounds, so a hit is possible, but only where the needle is.
TEST(Watertight, CollinearTriangleIsHitOnTheLineOnly) {
  const Vec3 b{1, 2, 3}, c{2, 4, 6};
  const Accel accel = build_sequential(scene_of(soup({Vec3{0}, b, c})));
  Random random(39);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 from = random.in_box(Vec3{-5}, Vec3{5});
    const float s = random.uniform(-0.5f, 2.5f);
    const Hit hit = trace_one(accel, ray_to(from, s * b + random.in_box(Vec3{-1e-3f}, Vec3{1e-3f}) - from));
    if (!hit.valid()) continue;
    ASSERT_GT(s, -1e-3f);
    ASSERT_LT(s, 2 + 1e-3f);
  }
}

}  // namespace
}  // namespace carousel::accel
