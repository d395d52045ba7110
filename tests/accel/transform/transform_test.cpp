#include "accel/transform/transform.h"

#include <cmath>
#include <limits>

#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "accel/box/slab.h"
#include "accel/traverse/verifying_workload.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

scene::Affine random_affine(Random& random) {
  scene::Affine m;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      m.linear[c][r] = std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(9)) - 4);
  for (int r = 0; r < 3; ++r)
    m.translation[r] = std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(20)) - 4);
  return m;
}

TEST(Transform, IdentityDoesNoArithmetic) {
  InstanceTransform t;
  ASSERT_TRUE(make_transform({}, t));
  EXPECT_TRUE(t.identity);
  const Ray r{{0.1f, -0.0f, 3e-42f}, 0.5f, {1e-45f, -2, 7}, 9};
  const Ray moved = t.to_model(r);
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(moved.origin[a]), std::bit_cast<std::uint32_t>(r.origin[a]));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(moved.direction[a]), std::bit_cast<std::uint32_t>(r.direction[a]));
  }
}

TEST(Transform, KeepsTheMeaningOfT) {
  InstanceTransform t;
  ASSERT_TRUE(make_transform({Mat3(4.0f), {1, 2, 3}}, t));
  const Ray moved = t.to_model({{1, 2, 7}, 0.25f, {0, 0, 8}, 5});
  EXPECT_EQ(moved.origin, (Vec3{0, 0, 1}));
  EXPECT_EQ(moved.direction, (Vec3{0, 0, 2}));  // not renormalised
  EXPECT_EQ(moved.tmin, 0.25f);
  EXPECT_EQ(moved.tmax, 5);
}

// Far from the world's origin and near the instance's: the case in which one matrix product loses all digits.
TEST(Transform, TwoStepsKeepDigitsNearTheTranslation) {
  Random random(41);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    scene::Affine m = random_affine(random);
    m.translation = 1e6f * random.in_box(Vec3{-1}, Vec3{1});
    const double det = std::fabs(glm::determinant(DMat3(m.linear)));
    if (det < 0.05) continue;
    InstanceTransform t;
    ASSERT_TRUE(make_transform(m, t));
    const Vec3 world = m.translation + random.in_box(Vec3{-4}, Vec3{4});
    const Vec3 got = t.to_model({world, 0, {0, 0, 1}, 1}).origin;
    const DMat3 inverse = glm::inverse(DMat3(m.linear));
    const DVec3 offset = DVec3(world) - DVec3(m.translation);
    for (int row = 0; row < 3; ++row) {
      double exact = 0, size = 0;
      for (int c = 0; c < 3; ++c) {
        exact += inverse[c][row] * offset[c];
        size += std::fabs(inverse[c][row] * offset[c]);
      }
      if (size > 0) worst = std::max(worst, std::fabs(got[row] - exact) / size);
    }
  }
  EXPECT_LT(worst, 3.0e-7);  // gamma(5)
}

TEST(Transform, SingularAndOverflowingOnesMustBeBaked) {
  InstanceTransform t;
  EXPECT_FALSE(make_transform({Mat3(0.0f), {}}, t));
  EXPECT_FALSE(make_transform({Mat3(1, 2, 3, 2, 4, 6, 0, 0, 1), {}}, t));
  EXPECT_FALSE(make_transform({Mat3(1e-39f, 0, 0, 0, 1, 0, 0, 0, 1), {}}, t));
  EXPECT_FALSE(make_transform({Mat3(std::numeric_limits<float>::infinity()), {}}, t));
  EXPECT_FALSE(make_transform({Mat3(std::numeric_limits<float>::quiet_NaN()), {}}, t));
  EXPECT_TRUE(make_transform({Mat3(-1.0f), {}}, t));
  EXPECT_TRUE(make_transform({Mat3(1e-30f), {}}, t));
}

TEST(WorldBox, HoldsTheExactlyTransformedCorners) {
  Random random(42);
  for (int i = 0; i < 50000; ++i) {
    const scene::Affine m = random_affine(random);
    Aabb model;
    model.extend(random.in_box(Vec3{-3}, Vec3{3}));
    model.extend(random.in_box(Vec3{-3}, Vec3{3}));
    const Aabb box = world_box(m, model);
    for (int corner = 0; corner < 8; ++corner) {
      for (int row = 0; row < 3; ++row) {
        // 24 by 24 bits fit a long double, and so do sums of four terms this close in size, to a last bit.
        long double x = m.translation[row];
        for (int c = 0; c < 3; ++c)
          x += static_cast<long double>(m.linear[c][row]) * (corner >> c & 1 ? model.hi[c] : model.lo[c]);
        ASSERT_LE(box.lo[row], x) << i;
        ASSERT_GE(box.hi[row], x) << i;
      }
    }
  }
}

// The pad has to cover what rounding does to the ray on its way into the model: whatever the instance's
// triangles report as hit, the world box must not have pruned.
TEST(WorldBox, PrunesNoHitOfTheModel) {
  Random random(43);
  std::size_t hits = 0;
  for (int i = 0; i < 1500; ++i) {
    scene::Scene scene = icosphere_scene(0);
    const scene::Affine m = random_affine(random);
    if (std::fabs(glm::determinant(DMat3(m.linear))) < 1e-3) continue;
    scene.instances[0].world_from_model = m;
    const Accel accel = build_sequential(scene);
    Accel open = accel;  // with a world box that no ray can miss
    for (int axis = 0; axis < 3; ++axis) {
      open.instances[0].world.lo[axis] = -std::numeric_limits<float>::max();
      open.instances[0].world.hi[axis] = std::numeric_limits<float>::max();
      open.nodes[open.root_key().ref.node()].plane[axis][0] = open.instances[0].world.lo[axis];
      open.nodes[open.root_key().ref.node()].plane[axis + 3][0] = open.instances[0].world.hi[axis];
    }
    const RayBatch rays = mixed_rays(scene, 60, static_cast<std::uint64_t>(i));
    const HitBatch a = trace(accel, rays), b = trace(open, rays);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      // Rays that touch the silhouette within rounding may be decided either way; the sphere's inner hits not.
      if (b[k].hit.valid() && !a[k].hit.valid()) {
        EXPECT_LT(std::min({b[k].hit.u, b[k].hit.v, 1 - b[k].hit.u - b[k].hit.v}), 1e-4f) << i << " " << k;
      }
      hits += a[k].hit.valid();
    }
  }
  EXPECT_GT(hits, 10000u);
}

// A ray from inside the box that the level's rounded transform takes to a point of the model has to be in the world
// box there, or the box would cut off what the triangles report.
TEST(WorldBox, HoldsWhatEveryLevelsTransformReaches) {
  for (const auto& level : kEnumNames<TransformLevel>) {
    Random random(44);
    std::size_t reached = 0, beyond_the_corners = 0;
    for (int i = 0; i < 100000; ++i) {
      scene::Affine m = random_affine(random);
      if (i % 4 == 0) m.translation = 1e6f * m.translation;
      Aabb model;
      model.extend(random.in_box(Vec3{-3}, Vec3{3}));
      model.extend(random.in_box(Vec3{-3}, Vec3{3}));
      InstanceTransform t;
      if (!make_transform(m, t, level.value)) continue;
      const Aabb box = world_box(m, model, level.value), tight = world_box(m, model, TransformLevel::kTwoStepDouble);
      Vec3 corner;  // the outermost along some axis
      const int axis = static_cast<int>(random.below(3));
      for (int a = 0; a < 3; ++a) corner[a] = m.linear[a][axis] < 0 ? model.lo[a] : model.hi[a];
      const Vec3 from = random.in_box(tight.lo, tight.hi);
      DVec3 target = DMat3(m.linear) * DVec3(corner) + DVec3(m.translation);
      // Beyond the corner, from hardly to further than the box.
      target[axis] += std::ldexp(1.2, -static_cast<int>(random.below(12))) * (double(box.hi[axis]) - target[axis]);
      const Ray world{from, 0, Vec3(target - DVec3(from)), kInfinity};
      const Ray ray = t.to_model(world);
      const DVec3 at = DVec3(ray.origin) + DVec3(ray.direction), point = DVec3(world.origin) + DVec3(world.direction);
      // Rounding takes it to this side of the corner or to that one.
      if (glm::any(glm::lessThan(at, DVec3(model.lo))) || glm::any(glm::greaterThan(at, DVec3(model.hi)))) continue;
      ++reached;
      for (int row = 0; row < 3; ++row) {
        beyond_the_corners += point[row] < tight.lo[row] || point[row] > tight.hi[row];
        ASSERT_GE(point[row], box.lo[row]) << level.name << " " << i;
        ASSERT_LE(point[row], box.hi[row]) << level.name << " " << i;
      }
    }
    EXPECT_GT(reached, 1000u) << level.name;
    EXPECT_TRUE(level.value != TransformLevel::kInverseMatrix || beyond_the_corners > 100) << beyond_the_corners;
  }
}

TEST(Transform, TransposesRotationsAndReflectionsOnly) {
  const Mat3 turned{{0.8f, 0.6f, 0}, {-0.6f, 0.8f, 0}, {0, 0, 1}},
      mirrored{{0.8f, 0.6f, 0}, {0.6f, -0.8f, 0}, {0, 0, 1}};
  EXPECT_TRUE(is_rotation(turned));
  EXPECT_TRUE(is_rotation(mirrored));
  for (const float factor : {1 - 4e-7f, 1 + 4e-7f}) EXPECT_FALSE(is_rotation(factor * turned));
  EXPECT_FALSE(is_rotation(Mat3({1, 1e-6f, 0}, {0, 1, 0}, {0, 0, 1})));
  EXPECT_FALSE(is_rotation(Mat3(std::numeric_limits<float>::quiet_NaN())));
  for (const Mat3& m : {turned, mirrored}) {
    InstanceTransform t;
    ASSERT_TRUE(make_transform({m, {1, 2, 3}}, t, TransformLevel::kTransposeIfRotation));
    EXPECT_TRUE(t.transposed);
    EXPECT_EQ(t.inverse_linear, glm::transpose(m));
  }
  const Mat3 sheared{{1, 0, 0}, {0.5f, 1, 0}, {0, 0, 1}};
  InstanceTransform t, two_step;
  ASSERT_TRUE(make_transform({sheared, {1, 2, 3}}, t, TransformLevel::kTransposeIfRotation));
  ASSERT_TRUE(make_transform({sheared, {1, 2, 3}}, two_step, TransformLevel::kTwoStep));
  EXPECT_FALSE(t.transposed);
  EXPECT_EQ(t.inverse_linear, two_step.inverse_linear);
}

TEST(Transform, EveryLevelIsTracedAsBruteForceDoes) {
  const scene::Scene scene = small_builtin(BuiltinScene::kInstances, 100, 8);
  const RayBatch rays = mixed_rays(scene, 600, 45);
  for (const auto& level : kEnumNames<TransformLevel>) {
    AccuracyConfig accuracy;
    accuracy.transform = level.value;
    const HitBatch got = trace(build(scene, BvhConfig{}, *make_sequential_executor(), accuracy), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const RayResult expected{rays[i].ray, brute_force(scene, rays[i], accuracy), rays[i].tag};
      ASSERT_TRUE(same_result(expected, got[i])) << level.name << " ray " << i;
    }
  }
}

TEST(Transform, OneMatrixThatOverflowsMustBeBaked) {
  InstanceTransform t;
  const scene::Affine far{Mat3(1e-10f), Vec3{1e30f}};  // R^-1 T is beyond float, T is not
  EXPECT_TRUE(make_transform(far, t, TransformLevel::kTwoStep));
  EXPECT_FALSE(make_transform(far, t, TransformLevel::kInverseMatrix));
}

TEST(WorldBox, OfNothingIsEmpty) {
  EXPECT_TRUE(world_box({Mat3(2.0f), {1, 1, 1}}, Aabb{}).empty());
}

}  // namespace
}  // namespace carousel::accel
