#include "app/run/ray_list_workload.h"

#include <algorithm>
#include <thread>

#include <gtest/gtest.h>

#include "app/run/hit_recorder.h"

namespace carousel::app {
namespace {

RayBatch rays(std::size_t count) {
  RayBatch out(count);
  for (std::size_t i = 0; i < count; ++i) {
    out[i].tag.path = static_cast<std::uint32_t>(i);
    out[i].tag.kind = static_cast<RayKind>(i % 3);
  }
  return out;
}

HitBatch hits(const RayBatch& requests) {
  HitBatch out;
  for (const RayRequest& request : requests) {
    Hit hit;
    if (request.tag.path % 2 == 0) hit = {static_cast<float>(request.tag.path), 0, 0, 1, request.tag.path};
    out.push_back({request.ray, hit, request.tag});
  }
  return out;
}

TEST(RayListWorkload, GivesEachRayOnceToManyThreads) {
  constexpr std::size_t kRays = 10'007, kWorkers = 4;
  RayListWorkload workload(rays(kRays), kWorkers);
  std::vector<RayBatch> got(kWorkers);
  {
    std::vector<std::jthread> threads;
    for (std::uint32_t w = 0; w < kWorkers; ++w)
      threads.emplace_back([&, w] {
        while (!workload.generate(WorkerId(w), 1 + w * 7, got[w]).finished) {
        }
      });
  }
  std::vector<int> seen(kRays);
  for (const RayBatch& batch : got)
    for (const RayRequest& request : batch) ++seen[request.tag.path];
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ptrdiff_t{kRays});
  const auto emitted = workload.emitted();
  EXPECT_EQ(emitted[0] + emitted[1] + emitted[2], kRays);
  EXPECT_EQ(emitted[0], (kRays + 2) / 3);
}

TEST(RayListWorkload, IsFinishedAtOnceWhenThereIsNoRay) {
  RayListWorkload workload({}, 1);
  RayBatch out;
  EXPECT_TRUE(workload.generate(WorkerId(0), 10, out).finished);
  EXPECT_TRUE(out.empty());
}

TEST(RayListWorkload, DigestAndRowsDoNotDependOnOrderOrWorker) {
  const RayBatch list = rays(300);
  const HitBatch completed = hits(list);
  RayListWorkload one(list, 1), three(list, 3);
  HitRecorder one_recorder(1), three_recorder(3);
  one.set_recorder(&one_recorder);
  three.set_recorder(&three_recorder);
  RayBatch none;
  one.shade(WorkerId(0), completed, none);
  for (std::size_t i = completed.size(); i-- > 0;)
    three.shade(WorkerId(static_cast<std::uint32_t>(i % 3)), {completed[i]}, none);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(one.hits_digest(), three.hits_digest());
  EXPECT_NE(one.hits_digest(), HitsDigest{});
  const auto a = one_recorder.take(), b = three_recorder.take();
  ASSERT_EQ(a.size(), list.size());
  ASSERT_EQ(b.size(), list.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].pixel, i);
    EXPECT_EQ(b[i].pixel, i);
    EXPECT_EQ(b[i].result.hit.primitive, a[i].result.hit.primitive);
  }
}

}  // namespace
}  // namespace carousel::app
