// Equal distances: the smallest (instance, primitive) wins, whatever the order of tests.
#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "accel/traverse/verifying_workload.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

const std::vector<Vec3> kTriangle{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};

scene::Scene coincident_triangles(std::uint32_t copies) {
  scene::Mesh mesh;
  mesh.positions = kTriangle;
  for (std::uint32_t i = 0; i < copies; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  return scene_of(std::move(mesh));
}

TEST(Ties, CoincidentTrianglesGiveSmallestPrimitive) {
  for (const std::uint32_t copies : {2u, 8u, 9u, 33u, 200u}) {
    for (const std::int64_t leaf : {1, 4, 16}) {
      for (const std::int64_t width : {2, 8}) {
        const Accel accel = build_sequential(coincident_triangles(copies), width, leaf);
        Random random(61);
        for (int i = 0; i < 200; ++i) {
          const Vec3 from = random.in_box({-2, -2, 1}, {2, 2, 3});
          const Hit hit = trace_one(accel, ray_to(from, Vec3{random.uniform(-0.2f, 0.2f), -0.3f, 0} - from));
          ASSERT_TRUE(hit.valid());
          ASSERT_EQ(hit.primitive, 0u);
        }
      }
    }
  }
}

// Rotated corners: the same triangle, other weights, so a wrong choice shows in u and v as well.
TEST(Ties, CoincidentTrianglesOfAnyOrderAgreeWithBruteForce) {
  Random random(62);
  for (int round = 0; round < 20; ++round) {
    scene::Mesh mesh;
    mesh.positions = kTriangle;
    std::vector<std::uint32_t> order{0, 1, 2};
    for (int i = 0; i < 24; ++i) {
      mesh.indices.insert(mesh.indices.end(), order.begin(), order.end());
      std::next_permutation(order.begin(), order.end());
    }
    const scene::Scene scene = scene_of(std::move(mesh));
    const Accel accel = build_sequential(scene, 2 + round % 7, round % 2 ? 1 : 4);
    for (int i = 0; i < 100; ++i) {
      const Vec3 from = random.in_box({-2, -2, 1}, {2, 2, 3});
      const RayRequest ray = ray_to(from, Vec3{random.uniform(-0.2f, 0.2f), -0.3f, 0} - from);
      ASSERT_TRUE(same_result({ray.ray, brute_force(scene, ray), ray.tag}, {ray.ray, trace_one(accel, ray), ray.tag}));
    }
  }
}

TEST(Ties, CoincidentInstancesGiveSmallestInstance) {
  for (const std::uint32_t copies : {2u, 8u, 40u}) {
    for (int direction = 0; direction < 2; ++direction) {
      scene::Scene scene = empty_scene();
      const std::uint32_t triangle = add_mesh(scene, soup(kTriangle));
      scene::Mesh twice = soup(kTriangle);
      twice.indices = {0, 1, 2, 0, 1, 2, 0, 1, 2};
      const std::uint32_t other = add_mesh(scene, twice);
      for (std::uint32_t i = 0; i < copies; ++i)
        add_instance(scene, (i + static_cast<std::uint32_t>(direction)) % 2 ? triangle : other,
                     {Mat3(2.0f), {0.5f, 0.25f, 1}});
      const Accel accel = build_sequential(scene, 2);
      Random random(63);
      for (int i = 0; i < 200; ++i) {
        const Vec3 from = random.in_box({-2, -2, 3}, {2, 2, 5});
        const Hit hit = trace_one(accel, ray_to(from, Vec3{0.5f, random.uniform(-0.4f, 0.4f), 1} - from));
        ASSERT_TRUE(hit.valid());
        ASSERT_EQ(hit.instance, 0u);
        ASSERT_EQ(hit.primitive, 0u);
      }
    }
  }
}

// The tie must hold in every order in which the leaves of coincident triangles can be visited.
TEST(Ties, EveryOrderOfVisitsGivesSameHit) {
  const Accel accel = build_sequential(coincident_triangles(8), 8, 1);
  std::vector<NodeKey> leaves;
  const NodeKey mesh{0, accel.instances[0].root};
  const Node& node = accel.nodes[mesh.ref.node()];
  for (int lane = 0; lane < node.count; ++lane) leaves.push_back(accel.child_key(mesh, lane));
  ASSERT_EQ(leaves.size(), 8u);
  std::vector<int> order(8);
  std::iota(order.begin(), order.end(), 0);
  const RayRequest ray = ray_to({0.1f, 0.2f, 3}, {0.02f, -0.1f, -1});
  const Hit expected = trace_one(accel, ray);
  ASSERT_EQ(expected.primitive, 0u);
  int orders = 0;
  do {
    RayRecord record;
    start_record(ray, record);
    IntersectionCounts counts;
    for (const int i : order)
      test_strip(accel, leaves[static_cast<std::size_t>(i)], ~0u, {&record, nullptr, 1}, {}, counts);
    ASSERT_TRUE(same_result({ray.ray, record.hit, ray.tag}, {ray.ray, expected, ray.tag}));
    ++orders;
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(orders, 40320);
}

TEST(Ties, EveryOrderOfInstancesGivesSameHit) {
  scene::Scene scene = empty_scene();
  const std::uint32_t triangle = add_mesh(scene, soup(kTriangle));
  for (int i = 0; i < 6; ++i) add_instance(scene, triangle, {Mat3(2.0f), {0.5f, 0.25f, 1}});
  const Accel accel = build_sequential(scene);
  const RayRequest ray = ray_to({0.6f, 0.2f, 3}, {0.02f, -0.1f, -1});
  const Hit expected = trace_one(accel, ray);
  ASSERT_TRUE(expected.valid());
  ASSERT_EQ(expected.instance, 0u);
  std::vector<std::uint32_t> order(6);
  std::iota(order.begin(), order.end(), 0u);
  do {
    RayRecord record;
    start_record(ray, record);
    IntersectionCounts counts;
    for (const std::uint32_t i : order)
      test_strip(accel, {i, accel.instances[i].root}, ~0u, {&record, nullptr, 1}, {}, counts);
    ASSERT_TRUE(same_result({ray.ray, record.hit, ray.tag}, {ray.ray, expected, ray.tag}));
  } while (std::next_permutation(order.begin(), order.end()));
}

// Triangles that touch: a shared vertex gives many triangles the same t, to the bit or nearly so.
TEST(Ties, RaysAtSharedVerticesAgreeInAnyOrderOfSubtrees) {
  const scene::Scene scene = icosphere_scene(3);
  const Accel accel = build_sequential(scene, 2, 1);
  const Accel other = build_sequential(scene, 8, 16);
  Random random(64);
  for (int i = 0; i < 20000; ++i) {
    const std::array<Vec3, 3> p = random_triangle(scene, random);
    const Vec3 from = random.in_box(Vec3{-3}, Vec3{3});
    const RayRequest ray = ray_to(from, p[0] - from);
    ASSERT_TRUE(same_result({ray.ray, trace_one(accel, ray), ray.tag}, {ray.ray, trace_one(other, ray), ray.tag})) << i;
  }
}

}  // namespace
}  // namespace carousel::accel
