// Measures each level of the triangle and the box test by SIMD target, and Embree on the same rays.
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <benchmark/benchmark.h>

#include "accel/builders/build.h"
#include "accel/structure/accel.h"
#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "bench/common/embree_peer.h"
#include "bench/common/ray_sets.h"
#include "bench/kernels/terrain_packet.h"
#include "core/config/config.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "core/types/enum_names.h"
#include "scene/builtin/builtin.h"

namespace carousel::bench {

namespace {

constexpr std::int64_t kLeafTriangles = 16;  // so that the set-up of a ray weighs little beside the tests

/// A terrain and rays that bounce off it, with a structure for each pair of levels.
class LevelSetting {
 public:
  static LevelSetting& get() {
    static LevelSetting setting;
    return setting;
  }

  const accel::Accel& accel(TriangleLevel triangle, BoxLevel box, std::int64_t leaf) {
    auto& built = accels_[{triangle, box, leaf}];
    if (!built) {
      BvhConfig bvh;
      bvh.leaf_triangles = leaf;
      AccuracyConfig accuracy;
      accuracy.triangle = triangle;
      accuracy.box = box;
      built = std::make_unique<accel::Accel>(accel::build(scene_, bvh, *make_sequential_executor(), accuracy));
    }
    return *built;
  }
  const scene::Scene& scene() const { return scene_; }
  const std::vector<RayRecord>& rays() const { return rays_; }

 private:
  LevelSetting() : scene_(scene::make_terrain(kTriangles, 1)) {
    const accel::Accel& any = accel(TriangleLevel::kWatertight, BoxLevel::kConservative, 4);
    for (const RaySet& set : make_ray_sets(scene_, any, kImageSide, 1)) {
      if (set.name != "shuffled") continue;
      for (std::size_t i = 0; i < std::min(kRays, set.size); ++i) accel::start_record(set[i], rays_.emplace_back());
    }
  }

  scene::Scene scene_;
  std::map<std::tuple<TriangleLevel, BoxLevel, std::int64_t>, std::unique_ptr<accel::Accel>> accels_;
  std::vector<RayRecord> rays_;
};

/// Restricts the kernels to a target while a benchmark runs; false, with the benchmark skipped, where there is none.
class OnTarget {
 public:
  OnTarget(benchmark::State& state, SimdTarget target) {
    try {
      accel::select_simd_target(target);
      usable_ = true;
    } catch (const ConfigError&) {
      state.SkipWithError("this machine or build has no such target");
    }
  }
  ~OnTarget() { accel::select_simd_target(SimdTarget::kAuto); }
  explicit operator bool() const { return usable_; }

 private:
  bool usable_ = false;
};

/// Items are boxes: a ray, set up, against the eight children of the mesh's root.
void boxes(benchmark::State& state, BoxLevel level, SimdTarget target) {
  LevelSetting& s = LevelSetting::get();
  const accel::Accel& a = s.accel(TriangleLevel::kWatertight, level, kLeafTriangles);
  std::vector<RayRecord> rays = s.rays();
  std::vector<std::uint8_t> masks(rays.size());
  std::array<float, accel::kMaxWidth> nearest;
  const OnTarget on(state, target);
  if (!on) return;
  const accel::NodeKey root{0, a.instances.at(0).root};
  IntersectionCounts counts;
  for (auto _ : state) {
    nearest.fill(kInfinity);
    accel::test_strip(a, root, ~0u, {rays.data(), nullptr, rays.size()}, {masks.data(), nearest.data(), nullptr},
                      counts);
    benchmark::DoNotOptimize(masks.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(counts.box));
}

/// Items are triangles: a ray, set up, against a full leaf.
void leaf_triangles(benchmark::State& state, TriangleLevel level, SimdTarget target) {
  LevelSetting& s = LevelSetting::get();
  const accel::Accel& a = s.accel(level, BoxLevel::kConservative, kLeafTriangles);
  accel::NodeKey leaf{0, a.instances.at(0).root};
  while (leaf.ref.is_inner()) {
    const accel::Node& node = a.nodes[leaf.ref.node()];
    leaf = a.child_key(
        leaf, static_cast<int>(std::max_element(node.strip_size, node.strip_size + node.count) - node.strip_size));
  }
  std::vector<RayRecord> rays = s.rays();
  const OnTarget on(state, target);
  if (!on) return;
  IntersectionCounts counts;
  for (auto _ : state) {
    accel::test_strip(a, leaf, ~0u, {rays.data(), nullptr, rays.size()}, {}, counts);
    benchmark::DoNotOptimize(rays.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(counts.triangle));
}

/// Items are rays, traced from the root to their hits.
void whole_trace(benchmark::State& state, TriangleLevel triangle, BoxLevel box) {
  LevelSetting& s = LevelSetting::get();
  const accel::Accel& a = s.accel(triangle, box, 4);
  std::vector<RayRecord> rays;
  IntersectionCounts counts;
  for (auto _ : state) {
    rays = s.rays();
    accel::trace_subtree(a, a.root_key(), {rays.data(), nullptr, rays.size()}, counts);
    benchmark::DoNotOptimize(rays.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}

/// Traces the rays of the setting in Embree, one at a time.
void whole_trace_embree(benchmark::State& state, bool robust) {
  LevelSetting& s = LevelSetting::get();
  EmbreeSettings settings;
  settings.robust = robust;
  const EmbreePeer peer(s.scene(), settings);
  RaySet set;
  for (const RayRecord& record : s.rays()) set.push_back(record.ray);
  HitList hits(set.size);
  for (auto _ : state) {
    peer.trace_single(set, 1, hits);
    benchmark::DoNotOptimize(hits.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(set.size));
}

std::string name(std::string_view what, std::string_view level, std::string_view target) {
  return std::string(what) + "/" + std::string(level) + "/" + std::string(target);
}

/// Names follow the configuration's words: kernel, level, target.
const bool kRegistered = [] {
  for (const auto& target : kEnumNames<SimdTarget>) {
    if (target.value == SimdTarget::kAuto || target.value == SimdTarget::kScalar)
      continue;  // scalar: not in every build
    for (const auto& level : kEnumNames<BoxLevel>)
      benchmark::RegisterBenchmark(name("boxes", level.name, target.name).c_str(), boxes, level.value, target.value);
    for (const auto& level : kEnumNames<TriangleLevel>)
      benchmark::RegisterBenchmark(name("triangles", level.name, target.name).c_str(), leaf_triangles, level.value,
                                   target.value);
  }
  for (const auto& triangle : kEnumNames<TriangleLevel>)
    for (const auto& box : kEnumNames<BoxLevel>)
      benchmark::RegisterBenchmark(name("whole_trace", triangle.name, box.name).c_str(), whole_trace, triangle.value,
                                   box.value);
  benchmark::RegisterBenchmark("whole_trace/embree_default", whole_trace_embree, false);
  benchmark::RegisterBenchmark("whole_trace/embree_robust", whole_trace_embree, true);
  return true;
}();

}  // namespace

}  // namespace carousel::bench
