#include "accel/traverse/verifying_workload.h"

#include <gtest/gtest.h>

#include "accel/traverse/kernels.h"
#include "accel/traverse/reference_tracer.h"
#include "core/system/error.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

/// Gives out a list of rays once and counts what comes back.
class ListWorkload final : public Workload {
 public:
  explicit ListWorkload(RayBatch rays) : rays_(std::move(rays)) {}
  Generated generate(WorkerId, std::size_t max_rays, RayBatch& out) override {
    std::size_t count = 0;
    for (; count < max_rays && next_ < rays_.size(); ++count) out.push_back(rays_[next_++]);
    return {count, next_ == rays_.size()};
  }
  void shade(WorkerId, const HitBatch& completed, RayBatch&) override { shaded_ += completed.size(); }
  std::size_t shaded() const { return shaded_; }

 private:
  RayBatch rays_;
  std::size_t next_ = 0, shaded_ = 0;
};

class VerifyingWorkloadTest : public testing::Test {
 protected:
  scene::Scene scene_ = icosphere_scene(2);
  Accel accel_ = build_sequential(scene_);
  HitOracle oracle_{scene_, AccuracyConfig{}, nullptr};
  RayBatch rays_ = mixed_rays(scene_, 500, 71);
};

TEST_F(VerifyingWorkloadTest, FindsNothingWhenAllIsRight) {
  ListWorkload inner(rays_);
  VerifyingWorkload verifying(inner, oracle_);
  const ReferenceRun run = run_reference(accel_, verifying, 64);
  EXPECT_EQ(run.rays, rays_.size());
  EXPECT_EQ(inner.shaded(), rays_.size());
  EXPECT_EQ(verifying.compared(), rays_.size());
  EXPECT_EQ(verifying.mismatches(), 0u);
  EXPECT_FALSE(verifying.example());
}

TEST_F(VerifyingWorkloadTest, FindsEveryKindOfPlantedFault) {
  const HitBatch right = trace(accel_, rays_);
  const auto mismatches = [&](const RayResult& wrong) {
    ListWorkload inner({});
    VerifyingWorkload verifying(inner, oracle_);
    RayBatch out;
    verifying.shade(WorkerId{0}, {wrong}, out);
    EXPECT_EQ(verifying.example().has_value(), verifying.mismatches() == 1);
    return verifying.mismatches();
  };
  std::size_t closest = 0, shadow = 0;
  for (const RayResult& r : right) {
    ASSERT_EQ(mismatches(r), 0u);
    RayResult wrong = r;
    wrong.hit.t = std::nextafter(r.hit.t, 0.0f);
    if (r.tag.kind == RayKind::kShadow) {
      EXPECT_EQ(mismatches(wrong), 0u);  // only occluded or visible is known
      wrong.hit.instance = r.hit.valid() ? kNoInstance : 0;
      EXPECT_EQ(mismatches(wrong), 1u);
      ++shadow;
      continue;
    }
    ++closest;
    EXPECT_EQ(mismatches(wrong), 1u);
    wrong = r;
    wrong.hit.primitive ^= 1;
    EXPECT_EQ(mismatches(wrong), 1u);
    wrong = r;
    wrong.hit.u = -r.hit.u;  // a sign bit, zeros included
    EXPECT_EQ(mismatches(wrong), 1u);
    wrong = r;
    wrong.hit.v += 0.5f;
    EXPECT_EQ(mismatches(wrong), 1u);
    wrong = r;
    wrong.hit = r.hit.valid() ? Hit{} : Hit{1, 0, 0, 0, 0};
    EXPECT_EQ(mismatches(wrong), 1u);
  }
  EXPECT_GT(closest, 100u);
  EXPECT_GT(shadow, 30u);
}

/// Rays that mismatch when `accel` answers them.
std::uint64_t mismatches_of(const Accel& accel, const scene::Scene& scene, const RayBatch& rays) {
  const HitOracle oracle(scene, accel.accuracy, accel.any_hit);
  ListWorkload inner(rays);
  VerifyingWorkload verifying(inner, oracle);
  run_reference(accel, verifying, 64);
  EXPECT_EQ(verifying.compared(), rays.size());
  return verifying.mismatches();
}

/// A structure that the run and its verification shared would hide all of these.
TEST(Verification, FindsFaultsInEveryPartOfAStructure) {
  const scene::Scene scene = small_builtin(BuiltinScene::kInstances, 0, 30);
  const RayBatch rays = mixed_rays(scene, 2000, 5);
  BvhConfig bvh;
  bvh.storage = BvhConfig::Storage::kQuantised;
  const Accel right = build(scene, bvh, *make_sequential_executor());
  EXPECT_EQ(mismatches_of(right, scene, rays), 0u);
  Accel wrong = right;
  for (Node& node : wrong.nodes)  // boxes too small by a step of quantisation
    if (!node.above_instances)
      for (int lane = 0; lane < node.count; ++lane)
        node.plane[3][lane] -= 0.02f * (node.plane[3][lane] - node.plane[0][lane]);
  EXPECT_GT(mismatches_of(wrong, scene, rays), 0u) << "nodes of meshes";
  wrong = right;
  for (Node& node : wrong.nodes)
    if (node.above_instances) node.plane[4][0] = node.plane[1][0];
  EXPECT_GT(mismatches_of(wrong, scene, rays), 0u) << "nodes of the top level";
  wrong = right;
  wrong.blocks[0].vertex[1][2][0] += 0.1f;
  EXPECT_GT(mismatches_of(wrong, scene, rays), 0u) << "triangles";
  wrong = right;
  wrong.instances[3].transform.translation.x += 0.05f;
  EXPECT_GT(mismatches_of(wrong, scene, rays), 0u) << "transforms";
}

TEST(ReferenceRun, IsDividedAmongPieces) {
  const scene::Scene scene = icosphere_scene(2);
  const Accel accel = build_sequential(scene);
  RayBatch rays = mixed_rays(scene, 500, 71);
  constexpr std::uint32_t kPieces = 3;
  for (std::uint32_t i = 0; i < rays.size(); ++i) rays[i].tag.path = i;
  const auto piece_of = [](const RayTag& tag) { return tag.path / 10 % kPieces; };
  ListWorkload all(rays);
  const std::vector<ReferenceRun> runs = run_reference_by_piece(accel, all, kPieces, piece_of, 64);
  ASSERT_EQ(runs.size(), kPieces);
  EXPECT_EQ(all.shaded(), rays.size());
  for (std::uint32_t piece = 0; piece < kPieces; ++piece) {
    RayBatch own;
    for (const RayRequest& ray : rays)
      if (piece_of(ray.tag) == piece) own.push_back(ray);
    ListWorkload list(own);
    const ReferenceRun run = run_reference(accel, list);
    EXPECT_EQ(runs[piece].rays, own.size());
    EXPECT_EQ(runs[piece].tests.box, run.tests.box) << piece;
    EXPECT_EQ(runs[piece].tests.triangle, run.tests.triangle) << piece;
  }
}

TEST(SimdTargets, UnknownOnesAreNamedInTheError) {
  const SimdGuard guard;
  for (const SimdTarget target :
       {SimdTarget::kScalar, SimdTarget::kSsse3, SimdTarget::kSse4, SimdTarget::kAvx2, SimdTarget::kAvx3}) {
    try {
      select_simd_target(target);
      EXPECT_EQ(simd_targets().size(), 1u);
    } catch (const ConfigError& error) {
      ASSERT_EQ(error.issues().size(), 1u);
      EXPECT_EQ(error.issues()[0].key_path, "engine.simd");
      EXPECT_NE(error.issues()[0].message.find(simd_targets()[0]), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace carousel::accel
