// No ray of a bundle hits a primitive that the bundle's test leaves out: judged by the primitive test of each ray, at
// every level of accuracy, over bundles and triangles made to be hard.
#include "accel/box/bundle_primitives.h"

#include <bit>

#include <gtest/gtest.h>

#include "accel/traverse/kernels.h"
#include "scene/model/scene.h"
#include "tests/accel/box/bundle_cases.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

/// Triangles across the boxes of a case; some touch only edges and corners of them.
TriangleBlock triangles_in(const BundleCase& c, Random& random) {
  TriangleBlock block;
  for (std::uint32_t lane = 0; lane < BundleCase::kBoxes; ++lane) {
    const Aabb box = child_box(c.node, static_cast<int>(lane));
    for (auto& vertex : block.vertex) {
      for (int axis = 0; axis < 3; ++axis) {
        const std::uint32_t where = random.below(3);
        vertex[axis][lane] = where == 0   ? box.lo[axis]
                             : where == 1 ? box.hi[axis]
                                          : random.uniform(box.lo[axis], box.hi[axis]);
      }
    }
    block.primitive[lane] = lane;
  }
  return block;
}

/// Spheres likewise.
TriangleBlock spheres_in(const BundleCase& c, Random& random) {
  TriangleBlock block;
  for (std::uint32_t lane = 0; lane < BundleCase::kBoxes; ++lane) {
    const Aabb box = child_box(c.node, static_cast<int>(lane));
    for (int axis = 0; axis < 3; ++axis) block.vertex[0][axis][lane] = random.uniform(box.lo[axis], box.hi[axis]);
    const float radius = std::max(std::numeric_limits<float>::min(), random.uniform() * (box.hi[0] - box.lo[0]));
    block.vertex[1][0][lane] = radius;
    block.vertex[1][1][lane] = std::bit_cast<float>(scene::kNoProgram);
    for (int axis = 0; axis < 3; ++axis) block.vertex[2][axis][lane] = radius;
    block.primitive[lane] = lane;
  }
  return block;
}

bool hits(const Accel& accel, NodeRef leaf, std::uint32_t lane, const Ray& ray) {
  RayRecord record;
  record.ray = ray;
  record.hit.t = ray.tmax;
  IntersectionCounts counts;
  test_strip(accel, {0, leaf}, 1u << lane, {&record, nullptr, 1}, {}, counts);
  return record.hit.valid();
}

TEST(BundlePrimitives, LeaveOutNothingThatARayHits) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  Random random(1000 * std::uint64_t{run_seed()} + 117);
  std::uint64_t tested = 0, left_out = 0, hit = 0, wrong = 0;
  const std::vector<AccuracyConfig> levels = triangle_and_box_levels();
  for (std::int64_t i = 0; i < adversarial_cases() / 20; ++i) {
    const BundleCase c = bundle_case(random, 20, 10);
    BundleRecord record = record_of(c.rays);
    if (random.below(8) == 0) record.tmax = kInfinity;  // out of date
    const bool procedural = random.below(8) == 0;
    const NodeRef leaf = procedural ? NodeRef::procedural(0, BundleCase::kBoxes) : NodeRef::leaf(0, BundleCase::kBoxes);
    Accel accel;
    accel.instances.emplace_back();  // without a transform
    accel.accuracy = levels[random.below(static_cast<std::uint32_t>(levels.size()))];
    accel.blocks.push_back(procedural ? spheres_in(c, random) : triangles_in(c, random));
    const std::uint32_t reach = primitives_in_reach(accel, leaf, record);
    EXPECT_EQ(reach >> BundleCase::kBoxes, 0u);
    for (std::uint32_t lane = 0; lane < BundleCase::kBoxes; ++lane) {
      bool any = false;
      for (const Ray& ray : c.rays) any |= hits(accel, leaf, lane, ray);
      const bool out = (reach >> lane & 1) == 0;
      ++tested, left_out += out, hit += any;
      if (any && out && ++wrong <= 3) ADD_FAILURE() << "case " << i << " lane " << lane << " " << text(accel.accuracy);
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(left_out, tested / 10);  // or nothing was claimed
  EXPECT_GT(hit, tested / 20);
}

}  // namespace
}  // namespace carousel::accel
