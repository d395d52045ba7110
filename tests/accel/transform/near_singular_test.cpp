// Instances that are nearly singular: a closed mesh stays closed for rays inside it, as far as double holds its matrix.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "accel/box/bundle_intersect.h"
#include "accel/certificate/properties.h"
#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "core/numeric/condition.h"
#include "tests/accel/structure/placements.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

constexpr double kWorst = 1e8;

/// Turned, scaled and turned again, so that the ratio of the scales is `thin`.
scene::Affine thin_placement(double thin, Random& random) {
  const auto turn = [&] { return rotation(random_direction(random), 360.0 * random.uniform()); };
  const DVec3 scale(thin, log_uniform(random, thin, 1), random.below(2) ? 1 : -1);
  const DMat3 second = turn(), first = turn();
  const DVec3 away = random.below(2) ? DVec3(0) : log_uniform(random, 1e-3, 1e3) * random_direction(random);
  return {Mat3(second * DMat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z) * first), Vec3(away)};
}

/// Rays from inside of a placed ball of radius 1, at its edges: where they start has been rounded in the world, so the
/// place in the model is found with 113 bits.
RayBatch rays_inside(const scene::Scene& scene, int count, Random& random) {
  const scene::Affine& m = scene.instances[0].world_from_model;
  const scene::Mesh& mesh = scene.meshes[0];
  const QuadInverse inverse(m);
  const DMat3 linear(m.linear);
  const double near = std::min(1.0, 0x1p19 / skeel_condition(linear));
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    const DVec3 inside = near * DVec3(random.in_box(Vec3{-0.4f}, Vec3{0.4f}));
    const Vec3 from = i % 4 == 0 ? m.translation : Vec3(DVec3(m.translation) + linear * inside);
    if (QuadInverse::norm(inverse.point(from)) > 0.8) continue;
    const std::uint32_t corner = random.below(static_cast<std::uint32_t>(mesh.indices.size())),
                        next = corner % 3 == 2 ? corner - 2 : corner + 1;
    const DVec3 a(mesh.positions[mesh.indices[corner]]), b(mesh.positions[mesh.indices[next]]);
    rays.push_back(ray_to(from, Vec3(linear * (a + double{random.uniform()} * (b - a) - inside))));
  }
  return rays;
}

std::size_t escaped(const Accel& accel, const RayBatch& rays) {
  std::size_t escaped = 0;
  for (const RayResult& r : trace(accel, rays)) escaped += !r.hit.valid();
  return escaped;
}

/// Takes rays through the tree below an instance in bundles, which are split where they do not know.
void trace_bundled(const Accel& accel, NodeKey key, RayRecord* records, const std::vector<std::uint32_t>& slots,
                   IntersectionCounts& counts) {
  const RayMembers members{records, slots.data(), slots.size()};
  if (!key.ref.is_inner()) return test_strip(accel, key, ~0u, members, {}, counts);
  BundleRecord bundle;
  for (const std::uint32_t slot : slots)
    bundle.widen(accel.instances[key.instance].transform.to_model(records[slot].ray), records[slot].hit.t);
  bundle.count = static_cast<std::uint8_t>(slots.size());
  const Node& node = accel.nodes[key.ref.node()];
  const BundleAnswer answer = test_bundle(accel, node, (1u << node.count) - 1, bundle, BundlesConfig{}, counts);
  std::vector<std::uint8_t> masks(slots.size());
  float nearest[kMaxWidth];
  std::fill_n(nearest, kMaxWidth, kInfinity);
  test_strip(accel, key, answer.undecided, members, {masks.data(), nearest, nullptr}, counts);
  for (int lane = 0; lane < node.count; ++lane) {
    std::vector<std::uint32_t> some;
    for (std::size_t i = 0; i < slots.size(); ++i)
      if ((answer.all | masks[i]) >> lane & 1) some.push_back(slots[i]);
    if (!some.empty()) trace_bundled(accel, accel.child_key(key, lane), records, some, counts);
  }
}

TEST(NearSingular, ClosedMeshesLoseNoRayUpToConditionTenToTheEight) {
  Random random(run_seed() + 1000);
  std::size_t rays = 0, at_planes = 0, in_bundles = 0, promoted = 0, culled = 0;
  const auto wanted = static_cast<std::size_t>(scaled(100'000));
  while (rays < wanted) {
    scene::Scene scene = icosphere_scene(2);
    scene.instances[0].world_from_model = thin_placement(log_uniform(random, 1 / kWorst, 1), random);
    const RayBatch batch = rays_inside(scene, 128, random);
    rays += batch.size();
    const Accel accel = build_sequential(scene);
    promoted += accel.promoted_instances;
    EXPECT_EQ(escaped(accel, batch), 0u) << "CAROUSEL_SEED=" << run_seed();
    if (random.below(4) != 0) continue;
    CullPlanesConfig planes;
    planes.count = 4;
    const Accel with_planes = build(scene, BvhConfig{}, *make_sequential_executor(), {}, planes);
    culled += with_planes.planes.size();
    at_planes += batch.size();
    EXPECT_EQ(escaped(with_planes, batch), 0u) << "CAROUSEL_SEED=" << run_seed();
    std::vector<RayRecord> records(batch.size());
    std::vector<std::uint32_t> slots(batch.size());
    for (std::uint32_t i = 0; i < batch.size(); ++i) start_record(batch[i], records[slots[i] = i]);
    IntersectionCounts counts;
    trace_bundled(accel, {0, accel.instances[0].root}, records.data(), slots, counts);
    for (const RayRecord& record : records) in_bundles += record.hit.valid();
  }
  EXPECT_EQ(in_bundles, at_planes) << "CAROUSEL_SEED=" << run_seed();
  EXPECT_GT(promoted, wanted / 1000);
  EXPECT_GT(culled, 0u);
}

TEST(NearSingular, TheCertificatesInstancesAreClosed) {
  const Property property = placed_mesh_property();
  const std::vector<AccuracyConfig> levels = levels_of(property);
  std::size_t judged = 0, leaks_by_inverse = 0;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(scaled(10'000, 2'000)); ++i) {
    CaseRandom random(run_seed(), property.number, i);
    std::vector<Judgement> out(levels.size());
    property.judge(property.make(random), levels, out, nullptr);
    for (std::size_t l = 0; l < levels.size(); ++l) {
      if (!out[l].applies) continue;
      ++judged;
      if (levels[l].transform == TransformLevel::kInverseMatrix)
        leaks_by_inverse += out[l].broken;
      else
        EXPECT_FALSE(out[l].broken) << "case " << i << ", " << level_name(property, levels[l])
                                    << ", CAROUSEL_SEED=" << run_seed();
    }
  }
  EXPECT_GT(judged, 4000u);
  EXPECT_GT(leaks_by_inverse, 10u);  // or the cases were not hard
}

TEST(NearSingular, OnlyMatricesThatFloatCannotHoldArePromoted) {
  InstanceTransform transform;
  const auto promoted = [&](const DVec3& scale, double degrees, TransformLevel level) {
    const DMat3 turn = rotation({1, 2, 3}, degrees);
    EXPECT_TRUE(
        make_transform({Mat3(turn * DMat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z)), Vec3(7)}, transform, level));
    return transform.promoted;
  };
  using enum TransformLevel;
  EXPECT_FALSE(promoted({1, 1, 1}, 40, kTwoStep));
  EXPECT_FALSE(promoted({1, 0.01, 5}, 40, kTwoStep));
  EXPECT_FALSE(promoted({1, 1e-8, 1}, 0, kTwoStep));  // nothing is added where it is not turned
  EXPECT_TRUE(promoted({1, 1e-4, 1}, 40, kTwoStep));
  EXPECT_EQ(transform.form, InstanceTransform::Form::kTwoStepDouble);
  EXPECT_TRUE(promoted({1, 1e-4, 1}, 40, kTransposeIfRotation));
  EXPECT_FALSE(promoted({1, 1e-4, 1}, 40, kTwoStepDouble));
  EXPECT_FALSE(promoted({1, 1e-4, 1}, 40, kInverseMatrix));
}

// Any position, such as a light's, takes the two steps that a ray's origin takes.
TEST(NearSingular, PositionsTakeTheWayOfRayOrigins) {
  Random random(run_seed() + 1001);
  for (int i = 0; i < 200; ++i) {
    const scene::Affine m = thin_placement(log_uniform(random, 1 / kWorst, 1), random);
    const Vec3 light = m.translation + random.in_box(Vec3{-2}, Vec3{2});
    const QuadInverse inverse(m);
    const QuadInverse::Vec exact = inverse.point(light), terms = inverse.terms(light);
    InstanceTransform transform;
    ASSERT_TRUE(make_transform(m, transform));
    const Vec3 found = transform.position_to_model(light);
    EXPECT_EQ(found, transform.to_model(ray_to(light, {1, 0, 0}).ray).origin);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double bound = transform.promoted ? 0x1p-24 * std::fabs(static_cast<double>(exact[axis])) +
                                                    0x1p-46 * static_cast<double>(terms[axis])
                                              : 5.1 * 0x1p-24 * static_cast<double>(terms[axis]);
      EXPECT_LE(std::fabs(static_cast<double>(exact[axis]) - found[static_cast<int>(axis)]), bound) << i;
    }
  }
}

}  // namespace
}  // namespace carousel::accel
