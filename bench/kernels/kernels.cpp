// Measures one test, and one step of the depth-first tracer, with all data in the first-level caches.
#include "accel/traverse/kernels.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "accel/box/slab.h"
#include "accel/builders/build.h"
#include "accel/primitive/watertight.h"
#include "accel/structure/accel.h"
#include "accel/traverse/ray_check.h"
#include "bench/common/ray_sets.h"
#include "bench/kernels/terrain_packet.h"
#include "core/config/config.h"
#include "core/system/executor.h"
#include "scene/builtin/builtin.h"

namespace carousel::bench {

namespace {

/// A small terrain and rays that bounce off it, made once for all benchmarks.
struct Setting {
  scene::Scene scene = scene::make_terrain(kTriangles, 1);
  accel::Accel accel;
  std::vector<RayRecord> rays;
  accel::NodeKey node, leaf;  // the root of the terrain's mesh, and a leaf

  Setting() {
    accel = accel::build(scene, BvhConfig{}, *make_sequential_executor());
    for (const RaySet& set : make_ray_sets(scene, accel, kImageSide, 1)) {
      if (set.name != "shuffled") continue;
      for (std::size_t i = 0; i < std::min(kRays, set.size); ++i) accel::start_record(set[i], rays.emplace_back());
    }
    node = {0, accel.instances.at(0).root};
    for (leaf = node; leaf.ref.is_inner();) leaf = accel.child_key(leaf, 0);
  }

  static const Setting& get() {
    static const Setting setting;
    return setting;
  }
};

void ray_setup_slab(benchmark::State& state) {
  const Setting& s = Setting::get();
  for (auto _ : state)
    for (const RayRecord& record : s.rays) benchmark::DoNotOptimize(accel::SlabRay(record.ray));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.rays.size()));
}
BENCHMARK(ray_setup_slab);

void ray_setup_watertight(benchmark::State& state) {
  const Setting& s = Setting::get();
  for (auto _ : state)
    for (const RayRecord& record : s.rays) benchmark::DoNotOptimize(accel::WatertightRay<float>(record.ray));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.rays.size()));
}
BENCHMARK(ray_setup_watertight);

/// Items are rays: one ray against the eight boxes of a node, as a packet does it.
void strip_of_boxes(benchmark::State& state) {
  const Setting& s = Setting::get();
  std::vector<RayRecord> rays = s.rays;
  std::vector<std::uint8_t> masks(rays.size());
  std::array<float, accel::kMaxWidth> nearest;
  IntersectionCounts counts;
  for (auto _ : state) {
    nearest.fill(kInfinity);
    accel::test_strip(s.accel, s.node, ~0u, {rays.data(), nullptr, rays.size()},
                      {masks.data(), nearest.data(), nullptr}, counts);
    benchmark::DoNotOptimize(masks.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK(strip_of_boxes);

/// Items are rays: one ray against the triangles of a leaf, most of them missed.
void strip_of_triangles(benchmark::State& state) {
  const Setting& s = Setting::get();
  std::vector<RayRecord> rays = s.rays;
  IntersectionCounts counts;
  for (auto _ : state) {
    accel::test_strip(s.accel, s.leaf, ~0u, {rays.data(), nullptr, rays.size()}, {}, counts);
    benchmark::DoNotOptimize(rays.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK(strip_of_triangles);

/// Items are rays, traced from the root to their hits.
void whole_tree(benchmark::State& state) {
  const Setting& s = Setting::get();
  std::vector<RayRecord> rays;
  IntersectionCounts counts;
  for (auto _ : state) {
    rays = s.rays;
    accel::trace_subtree(s.accel, s.accel.root_key(), {rays.data(), nullptr, rays.size()}, counts);
    benchmark::DoNotOptimize(rays.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK(whole_tree);

}  // namespace

}  // namespace carousel::bench
