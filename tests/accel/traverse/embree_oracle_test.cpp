// Ring and tracer share kernels, so their agreement proves little. Here Embree traces the same rays; where the
// two disagree, exact arithmetic says who is right, and it must never be Embree alone.
#include <iostream>

#include <gtest/gtest.h>

#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/exact/exact_oracle.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/embree_peer.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

bool agree(const Hit& a, const Hit& b) {
  if (!a.valid() || !b.valid()) return a.valid() == b.valid();
  return a.instance == b.instance && a.primitive == b.primitive && std::fabs(a.t - b.t) <= 1e-6f * std::fabs(a.t);
}

void expect_explained(const scene::Scene& scene, std::size_t rays) {
  const Accel accel = build_sequential(scene);
  const EmbreePeer embree(scene);
  const ExactOracle oracle(scene);
  std::size_t disagree = 0, ties = 0, embree_wrong = 0, unexplained = 0, hits = 0;
  constexpr std::size_t kBatch = 50000;
  for (std::size_t begin = 0; begin < rays; begin += kBatch) {
    const std::uint64_t seed = std::uint64_t{run_seed() - 1} << 32 | (1000 + begin);
    const RayBatch batch = whole_rays(scene, std::min(kBatch, rays - begin), seed);
    for (const RayResult& ours : trace(accel, batch)) {
      const Hit theirs = embree.closest(ours.ray);
      hits += ours.hit.valid();
      if (agree(ours.hit, theirs)) continue;
      ++disagree;
      const bool we = oracle.acceptable(ours.ray, ours.hit), they = oracle.acceptable(ours.ray, theirs);
      ties += we && they;
      embree_wrong += we && !they;
      if (we) continue;
      ++unexplained;
      const Ray& r = ours.ray;
      if (unexplained <= 3)
        ADD_FAILURE() << "CAROUSEL_SEED=" << run_seed() << " within 50000 rays of ray " << begin << std::hexfloat
                      << ": origin " << r.origin.x << " " << r.origin.y << " " << r.origin.z << " direction "
                      << r.direction.x << " " << r.direction.y << " " << r.direction.z << "\n ours " << ours.hit.t
                      << " " << static_cast<int>(ours.hit.instance) << " " << ours.hit.primitive << "\n Embree "
                      << theirs.t << " " << static_cast<int>(theirs.instance) << " " << theirs.primitive
                      << (they ? " (right)" : " (wrong too)");
    }
  }
  std::cout << rays << " rays, " << hits << " hits, " << disagree << " disagreements: " << ties << " ties, "
            << embree_wrong << " decided for us, " << unexplained << " unexplained\n";
  EXPECT_EQ(unexplained, 0u);
  EXPECT_GT(hits, rays / 4);
}

TEST(EmbreeOracle, ExplainsEveryDisagreementOnCornell) {
  expect_explained(small_builtin(BuiltinScene::kCornell), oracle_rays() / 5);
}
TEST(EmbreeOracle, ExplainsEveryDisagreementOnSpheres) {
  expect_explained(small_builtin(BuiltinScene::kSpheres, 3000), oracle_rays() / 5);
}
TEST(EmbreeOracle, ExplainsEveryDisagreementOnTerrain) {
  expect_explained(small_builtin(BuiltinScene::kTerrain, 3000), oracle_rays() / 5);
}
TEST(EmbreeOracle, ExplainsEveryDisagreementOnSliver) {
  expect_explained(small_builtin(BuiltinScene::kSliver, 1000), oracle_rays() / 5);
}
TEST(EmbreeOracle, ExplainsEveryDisagreementOnInstances) {
  expect_explained(small_builtin(BuiltinScene::kInstances, 0, 12), oracle_rays() / 5);
}

}  // namespace
}  // namespace carousel::accel
