#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "accel/build/build.h"
#include "accel/structure/accel.h"
#include "accel/traverse/kernels.h"
#include "accel/traverse/reference_tracer.h"
#include "core/config/enum_names.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/native/native_engine.h"
#include "ringbus/protocol/deadlock.h"
#include "scene/builtin/builtin.h"
#include "tests/ringbus/queues/queue_kinds.h"
#include "tests/ringbus/support/scatter_workload.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus {

/// One machine to run a workload on: a configuration, and what is not in one.
struct Cell {
  Config config;
  std::size_t threads = 1;
  bool tight_storage = false;  ///< bounded collection storage at its least
  cycle::TraceWindow trace{};  ///< of the cycle engine
  std::stop_token stop{};      ///< ends the run, which is then incomplete

  /// Nothing of those without faults.
  std::string faults_text() const {
    const FaultsConfig& f = config.faults;
    std::string text;
    if (f.links.any())
      text += fmt::format(" links drop {} duplicate {} corrupt {} reorder {} delay {} by {}", f.links.drop,
                          f.links.duplicate, f.links.corrupt, f.links.reorder, f.links.delay, f.links.delay_cycles);
    if (f.resource.kind != FaultsConfig::Resource::Kind::kNone)
      text += fmt::format(" resource {} {} after {} cycles {} factor {} silence {}", f.resource.number,
                          enum_name(f.resource.kind), f.resource.after_rays, f.resource.cycles, f.resource.factor,
                          f.resource.silence_cycles);
    return text.empty() ? text : fmt::format("{} seed {}", text, f.seed);
  }
  std::string text() const { return machine_text() + faults_text(); }
  std::string machine_text() const {
    const Config& c = config;
    return fmt::format(
        "resources {} {} visit {} flow {} queue {} depth {} slots {} placement {} packet rays {} {} ready {} {} {} {} "
        "home {} {}{} contexts {} carry {} fetch {} ahead {} width {} leaf {} treelet {} {} mixed {} workers {} {}{} "
        "simd {} threads {}",
        c.topology.resources, enum_name(c.topology.shape), enum_name(c.topology.visit), enum_name(c.topology.flow),
        enum_name(c.topology.link.queue), c.topology.link.depth, c.rays.slots_per_resource, enum_name(c.rays.placement),
        c.packets.rays, enum_name(c.packets.shapes), c.collections.ready, enum_name(c.collections.traversal),
        enum_name(c.collections.policy), enum_name(c.collections.select), enum_name(c.collections.home),
        enum_name(c.collections.when_full), tight_storage ? " tight" : "", c.testers.contexts,
        enum_name(c.packets.carry), enum_name(c.memory.fetch), c.memory.fetch_ahead, c.bvh.width, c.bvh.leaf_triangles,
        c.bvh.treelet_triangles, enum_name(c.bvh.elements), c.bvh.mixed_triangles, c.shading.workers,
        enum_name(c.shading.distribute), c.shading.idle_resources_shade ? " idle resources shade" : "",
        enum_name(c.engine.simd), threads);
  }
};

/// Whether core/config_validate would accept the combination.
inline bool possible(const Config& c) {
  if (c.collections.traversal == Traversal::kOrdered && c.packets.shapes != PacketShapes::kStrip) return false;
  if (c.engine.kind == EngineKind::kCycle && c.packets.carry == PacketCarry::kData &&
      c.memory.fetch != MemoryConfig::Fetch::kPacket)
    return false;
  if (c.bundles.size > 0 &&
      (c.bundles.size > c.rays.slots_per_resource || c.collections.traversal == Traversal::kOrdered ||
       (c.bundles.strict && c.bundles.order == BundlesConfig::Order::kAnyHitOnly) ||
       c.packets.shapes == PacketShapes::kSingle || c.topology.shape == TopologyShape::kIndependent ||
       c.rays.placement == Placement::kFirstTaker || c.rays.placement == Placement::kAddressed))
    return false;
  if (c.bvh.elements == BvhConfig::Elements::kSpheres && (c.bundles.size > 0 || c.cull_planes.count > 0)) return false;
  if (c.collections.home == Home::kHash && c.collections.when_full != WhenFull::kSpill) return false;
  return c.topology.flow != Flow::kBubble || c.topology.link.depth >= 2;
}

/// A scene with its reference digest; structures are built once a (width, leaf size).
class TestScene {
 public:
  TestScene(scene::Scene scene, std::uint32_t paths, std::uint8_t bounces, float away = 0.5f,
            const AccuracyConfig& accuracy = {}, const AnyHit* any_hit = nullptr)
      : scene_(std::move(scene)),
        bounds_(scene_.bounds()),
        paths_(paths),
        bounces_(bounces),
        away_(away),
        accuracy_(accuracy),
        any_hit_(any_hit) {
    ScatterWorkload reference = workload();
    accel::run_reference(accel(BvhConfig{}), reference);
    digest_ = reference.digest();
    rays_ = reference.rays();
  }

  const accel::Accel& accel(const BvhConfig& bvh) {
    const CullPlanesConfig none{};
    return accel(bvh, none);
  }
  const accel::Accel& accel(const BvhConfig& bvh, const CullPlanesConfig& planes) {
    auto& built = accels_[{bvh.width, bvh.leaf_triangles, bvh.elements, bvh.mixed_triangles, planes.count, planes.nodes,
                           planes.fit, planes.shared_normals, planes.order, planes.levels}];
    if (!built) {
      built = std::make_unique<accel::Accel>(accel::build(scene_, bvh, *make_sequential_executor(), accuracy_, planes));
      built->any_hit = any_hit_;
    }
    return *built;
  }
  ScatterWorkload workload() const {
    return ScatterWorkload(bounds_, paths_, bounces_, 6 + run_seed(), away_, any_hit_ != nullptr);
  }
  std::unique_ptr<Workload> new_workload() const {
    return std::make_unique<ScatterWorkload>(bounds_, paths_, bounces_, 6 + run_seed(), away_, any_hit_ != nullptr);
  }
  float size() const {
    const Vec3 e = bounds_.extent();
    return std::sqrt(e.x * e.x + e.y * e.y + e.z * e.z);
  }
  const HitsDigest& digest() const { return digest_; }
  std::uint64_t rays() const { return rays_; }

 private:
  scene::Scene scene_;
  Aabb bounds_;
  std::uint32_t paths_;
  std::uint8_t bounces_;
  float away_;
  AccuracyConfig accuracy_;
  const AnyHit* any_hit_;  // with one, rays also have wishes
  /// Width, leaf size, elements, mixed nodes, and planes: count, nodes, fit, shared, order, levels.
  using Built =
      std::tuple<std::int64_t, std::int64_t, BvhConfig::Elements, std::int64_t, std::int64_t, CullPlanesConfig::Nodes,
                 CullPlanesConfig::Fit, bool, CullPlanesConfig::Order, CullPlanesConfig::Levels>;
  std::map<Built, std::unique_ptr<accel::Accel>> accels_;
  HitsDigest digest_;
  std::uint64_t rays_ = 0;
};

inline scene::Scene builtin_scene(BuiltinScene builtin, std::int64_t triangles, std::int64_t instances) {
  SceneConfig config;
  config.builtin = builtin;
  config.triangles = triangles;
  config.instances = instances;
  return scene::make_builtin(config);
}

inline RunOptions on_threads(std::size_t threads) {
  RunOptions options;
  options.threads = threads;
  return options;
}

/// What went wrong with a run, or nothing. `sum` gains what all resources did.
struct Outcome {
  std::string fault;
  RunResult result;
  ResourceStatistics sum;
  std::uint64_t spilled = 0, refusals = 0;
};

/// Sets storage to what the cell asks for, runs it, and checks digest, counts and conservation.
inline Outcome run_cell(TestScene& scene, Cell cell) {
  const accel::Accel& accel = scene.accel(cell.config.bvh, cell.config.cull_planes);
  Config& c = cell.config;
  if (c.collections.when_full == WhenFull::kSpill)
    c.collections.capacity = 4 * c.packets.rays;
  else
    c.collections.capacity = minimum_capacity(c, accel.width, accel.max_depth) * (cell.tight_storage ? 1 : 50);
  c.collections.capacity = std::max(c.collections.capacity, c.packets.rays);
  ScatterWorkload workload = scene.workload();
  RunOptions options;
  options.threads = cell.threads;
  options.trace = cell.trace;
  options.stop = cell.stop;
  Outcome out;
  try {
    accel::select_simd_target(c.engine.simd);
    const auto run = c.engine.kind == EngineKind::kCycle ? run_cycle : run_native;
    out.result = run(c, accel, scene.size(), workload, options);
  } catch (const std::exception& error) {
    out.fault = error.what();
  }
  accel::select_simd_target(SimdTarget::kAuto);
  if (!out.fault.empty()) return out;
  for (const ResourceStatistics& r : out.result.resources) out.sum += r;
  for (const auto& s : out.result.collections) out.spilled += s.spilled;
  for (const LinkResult& l : out.result.links) out.refusals += l.statistics.refusals;
  const auto expect = [&](std::string_view what, auto got, auto wanted) {
    if (got != wanted) out.fault += fmt::format("{}: {} instead of {}; ", what, got, wanted);
  };
  expect("digest", workload.digest().hex(), scene.digest().hex());
  expect("rays", workload.rays(), scene.rays());
  expect("rays shaded twice", workload.doubled(), 0u);
  expect("completed", out.result.rays_completed, out.result.rays_emitted);
  expect("complete", out.result.complete, true);
  std::uint64_t in_bundles = 0;  // beyond the one ID that was admitted for each
  for (const BundleCounts& at_depth : out.sum.bundles) in_bundles += at_depth.loaded_rays - at_depth.loaded;
  const std::uint64_t admitted = out.sum.rays_admitted + in_bundles, again = out.result.rays_restarted;
  // Those that begin again may have been on their way when all work was discarded, or admitted.
  if (again == 0) expect("admitted", admitted, scene.rays());
  if (admitted < scene.rays() || admitted > scene.rays() + again) out.fault += fmt::format("admitted: {}; ", admitted);
  if (out.result.paths_restarted > again) out.fault += "more paths than rays began again; ";
  expect("handed over", out.sum.rays_completed, scene.rays());
  expect("packets retired or discarded", out.sum.packets_retired + out.result.packets_discarded,
         out.sum.packets_issued);
  return out;
}

/// The SIMD targets of this build and machine.
inline std::vector<SimdTarget> simd_targets() {
  std::vector<SimdTarget> usable{SimdTarget::kAuto};
  for (const SimdTarget target :
       {SimdTarget::kScalar, SimdTarget::kSsse3, SimdTarget::kSse4, SimdTarget::kAvx2, SimdTarget::kAvx3}) {
    try {
      accel::select_simd_target(target);
      usable.push_back(target);
    } catch (const ConfigError&) {
    }
  }
  accel::select_simd_target(SimdTarget::kAuto);
  return usable;
}

/// How many random cells to run: `wanted`, times CAROUSEL_CELLS; fewer under ThreadSanitizer, which is slow.
inline int cell_count(int wanted) {
  wanted = scaled(wanted, "CAROUSEL_CELLS");
#ifdef __SANITIZE_THREAD__
  wanted /= 8;
#endif
  return std::max(1, wanted);
}

}  // namespace carousel::ringbus
