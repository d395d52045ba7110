// Which worker gets a completed ray.
#include "ringbus/cycle/shading/shade_queues.h"

#include <gtest/gtest.h>

#include "ringbus/cycle/shading/shade_sorter.h"

namespace carousel::ringbus::cycle {
namespace {

using Distribute = ShadingConfig::Distribute;

RayResult ray_of_path(std::uint32_t path) {
  RayResult r;
  r.tag.path = path;
  return r;
}

ShadeQueues queues(Distribute distribute, std::size_t workers, std::int64_t lanes = 1, bool sorted = false) {
  ShadingConfig config;
  config.distribute = distribute;
  config.lanes = lanes;
  config.sort = sorted ? ShadingConfig::Sort::kShader : ShadingConfig::Sort::kNone;
  return ShadeQueues(config, workers, 7);
}

std::vector<std::uint32_t> vector_of(ShadeQueues& queues, std::uint32_t worker) {
  std::vector<std::uint32_t> paths;
  ShadeVector vector;
  const bool any = queues.take(worker, vector);
  EXPECT_EQ(any, !vector.rays.empty());
  EXPECT_EQ(vector.rays.size(), vector.shaders.size());
  for (const RayResult& ray : vector.rays) paths.push_back(ray.tag.path);
  return paths;
}

std::vector<std::uint32_t> paths_of(ShadeQueues& queues, std::uint32_t worker) {
  std::vector<std::uint32_t> paths;
  for (;;) {
    const std::vector<std::uint32_t> next = vector_of(queues, worker);
    if (next.empty()) return paths;
    paths.insert(paths.end(), next.begin(), next.end());
  }
}

TEST(ShadeQueues, FifoFillGivesTheOldestToWhoeverAsks) {
  ShadeQueues q = queues(Distribute::kFifoFill, 3);
  for (std::uint32_t path = 0; path < 5; ++path) q.push(ray_of_path(path), 0);
  EXPECT_EQ(vector_of(q, 2), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(vector_of(q, 0), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(q.take_any()->tag.path, 2u);
  EXPECT_EQ(q.size(), 2u);
  EXPECT_EQ(paths_of(q, 1), (std::vector<std::uint32_t>{3, 4}));
  EXPECT_TRUE(q.empty());
  EXPECT_FALSE(q.take_any());
}

TEST(ShadeQueues, RoundRobinTakesTurns) {
  ShadeQueues q = queues(Distribute::kRoundRobin, 3);
  for (std::uint32_t path = 0; path < 7; ++path) q.push(ray_of_path(path), 0);
  EXPECT_EQ(paths_of(q, 1), (std::vector<std::uint32_t>{1, 4}));
  EXPECT_EQ(paths_of(q, 0), (std::vector<std::uint32_t>{0, 3, 6}));
  EXPECT_EQ(paths_of(q, 0), (std::vector<std::uint32_t>{}));  // not of others
  EXPECT_EQ(paths_of(q, 2), (std::vector<std::uint32_t>{2, 5}));
}

TEST(ShadeQueues, LoadCountsWhatIsInHand) {
  ShadeQueues q = queues(Distribute::kLoad, 3);
  q.set_in_work(0, 1);
  q.set_in_work(1, 3);
  for (std::uint32_t path = 0; path < 5; ++path) q.push(ray_of_path(path), 0);  // 2, then 0 or 2, the first first
  EXPECT_EQ(paths_of(q, 2), (std::vector<std::uint32_t>{0, 2, 4}));
  EXPECT_EQ(paths_of(q, 0), (std::vector<std::uint32_t>{1, 3}));
  EXPECT_EQ(paths_of(q, 1), (std::vector<std::uint32_t>{}));
  q.set_in_work(1, 0);
  q.push(ray_of_path(9), 0);
  EXPECT_EQ(paths_of(q, 1), (std::vector<std::uint32_t>{9}));
}

TEST(ShadeQueues, RandomDependsOnTheRayAlone) {
  ShadeQueues forward = queues(Distribute::kRandom, 4), backward = queues(Distribute::kRandom, 4);
  for (std::uint32_t path = 0; path < 4000; ++path) forward.push(ray_of_path(path), 0);
  for (std::uint32_t path = 4000; path-- > 0;) backward.push(ray_of_path(path), 0);
  for (std::uint32_t worker = 0; worker < 4; ++worker) {
    const std::vector<std::uint32_t> paths = paths_of(forward, worker);
    std::vector<std::uint32_t> others = paths_of(backward, worker);
    std::reverse(others.begin(), others.end());
    EXPECT_EQ(paths, others);
    EXPECT_NEAR(static_cast<double>(paths.size()), 1000, 100);
  }
  ShadeQueues kinds = queues(Distribute::kRandom, 4);
  RayResult shadow = ray_of_path(0);
  shadow.tag.kind = RayKind::kShadow;
  for (std::uint8_t bounce = 0; bounce < 100; ++bounce) {
    shadow.tag.bounce = bounce;
    kinds.push(shadow, 0);
  }
  for (std::uint32_t worker = 0; worker < 4; ++worker) EXPECT_GT(paths_of(kinds, worker).size(), 5u);
}

TEST(ShadeQueues, HelpersTakeFromTheLongest) {
  ShadeQueues q = queues(Distribute::kLoad, 2);
  q.set_in_work(0, 100);
  for (std::uint32_t path = 0; path < 3; ++path) q.push(ray_of_path(path), 0);
  q.set_in_work(0, 0);
  q.push(ray_of_path(3), 0);  // to worker 0, which has none waiting
  EXPECT_EQ(q.take_any()->tag.path, 0u);
  EXPECT_EQ(q.take_any()->tag.path, 1u);
  EXPECT_EQ(q.size(), 2u);
}

TEST(ShadeQueues, AVectorHasTheOldestRays) {
  ShadeQueues q = queues(Distribute::kFifoFill, 1, 4);
  for (std::uint32_t path = 0; path < 6; ++path) q.push(ray_of_path(path), path % 2);
  EXPECT_EQ(vector_of(q, 0), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(vector_of(q, 0), (std::vector<std::uint32_t>{4, 5}));
}

TEST(ShadeQueues, ASortedVectorHasOneShader) {
  ShadeQueues q = queues(Distribute::kFifoFill, 1, 3, true);
  for (const std::uint32_t shader : {2, 0, 0, 5, 5, 0, 5, 0})
    q.push(ray_of_path(static_cast<std::uint32_t>(q.size())), shader);
  EXPECT_EQ(vector_of(q, 0), (std::vector<std::uint32_t>{1, 2, 5}));  // fills a vector, and came before the other
  EXPECT_EQ(vector_of(q, 0), (std::vector<std::uint32_t>{3, 4, 6}));
  EXPECT_EQ(vector_of(q, 0), (std::vector<std::uint32_t>{0}));  // none fills one: the first to come
  q.push(ray_of_path(8), 0);
  EXPECT_EQ(vector_of(q, 0), (std::vector<std::uint32_t>{7, 8}));  // its empty places are filled
  EXPECT_TRUE(q.empty());
}

TEST(ShadeSorter, TakesSoManyRaysACycle) {
  ShadeSorter sorter(2);
  for (std::uint32_t path = 0; path < 3; ++path) sorter.push(ray_of_path(path), 10);  // in cycles 10, 10, 11
  sorter.push(ray_of_path(3), 11);
  sorter.push(ray_of_path(4), 20);
  std::vector<Cycle> at;
  while (sorter.size() > 0) {
    at.push_back(sorter.next());
    EXPECT_EQ(sorter.take().tag.path, at.size() - 1);
  }
  EXPECT_EQ(at, (std::vector<Cycle>{11, 11, 12, 12, 21}));
  EXPECT_EQ(sorter.next(), kNever);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
