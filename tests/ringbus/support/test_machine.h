#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <string>

#include <fmt/format.h>

#include "accel/builders/build.h"
#include "accel/structure/accel.h"
#include "accel/traverse/kernels.h"
#include "accel/traverse/reference_tracer.h"
#include "core/config/config.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "core/types/enum_names.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/shapes/shape_room.h"
#include "ringbus/native/native_engine.h"
#include "ringbus/protocol/deadlock.h"
#include "scene/builtin/builtin.h"
#include "tests/ringbus/queues/queue_kinds.h"
#include "tests/ringbus/support/cell.h"
#include "tests/ringbus/support/test_scene.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus {

inline RunOptions on_threads(std::size_t threads) {
  RunOptions options;
  options.threads = threads;
  return options;
}

/// A run and what was wrong with it.
struct Outcome {
  std::string fault;  ///< empty if nothing was
  RunResult result;
  ResourceStatistics sum;  ///< sum over all resources
  std::uint64_t spilled = 0, refusals = 0;
};

/// Gives a cell its storage, and room for the largest strip in its shape buffers.
inline void give_room(Cell& cell, const accel::Accel& accel) {
  Config& c = cell.config;
  if (c.collections.when_full == WhenFull::kSpill)
    c.collections.capacity = 4 * c.packets.rays;
  else
    c.collections.capacity = minimum_capacity(c, accel.most_ways(), accel.levels()) * (cell.tight_storage ? 1 : 50);
  c.collections.capacity = std::max(c.collections.capacity, c.packets.rays);
  c.memory.shape_buffer_kib =
      std::max(c.memory.shape_buffer_kib, cycle::least_shape_buffer_kib(accel, c.accuracy, {}, {}, c.collections));
}

/// Writes into a complete run's fault where digest, counts and conservation differ from the reference tracer's run.
/// `workload` has shaded the rays.
template <class Scattering>
void check_outcome(Outcome& out, const Config& c, const TestScene::Reference& reference, const Scattering& workload) {
  for (const ResourceStatistics& r : out.result.resources) out.sum += r;
  for (const auto& s : out.result.collections) out.spilled += s.spilled;
  for (const LinkResult& l : out.result.links) out.refusals += l.statistics.refusals;
  const auto expect = [&](std::string_view what, auto got, auto wanted) {
    if (got != wanted) out.fault += fmt::format("{}: {} instead of {}; ", what, got, wanted);
  };
  expect("digest", workload.digest().hex(), reference.digest.hex());
  expect("rays", workload.rays(), reference.rays);
  expect("rays shaded twice", workload.doubled(), 0u);
  expect("completed", out.result.rays_completed, out.result.rays_emitted);
  expect("complete", out.result.complete, true);
  std::uint64_t in_bundles = 0;  // beyond the one ID that was admitted for each
  for (const BundleCounts& at_depth : out.sum.bundles) in_bundles += at_depth.loaded_rays - at_depth.loaded;
  const std::uint64_t admitted = out.sum.rays_admitted + in_bundles, again = out.result.rays_restarted;
  // A ray that begins again may have been on its way when all work was discarded, or admitted.
  if (again == 0) expect("admitted", admitted, reference.rays);
  if (admitted < reference.rays || admitted > reference.rays + again)
    out.fault += fmt::format("admitted: {}; ", admitted);
  if (out.result.paths_restarted > again) out.fault += "more paths than rays began again; ";
  expect("handed over", out.sum.rays_completed, reference.rays);
  expect("packets retired or discarded", out.sum.packets_retired + out.result.packets_discarded,
         out.sum.packets_issued);
  if (c.bundles.size > 0) return;  // counts by depth are of rays by themselves
  const CullLevel culled = out.sum.culls.sum();
  expect("boxes culled at all depths", culled.culled(), out.sum.tests.culled);
  expect("plane tests at all depths", culled.plane_tests, out.sum.tests.plane);
}

/// Runs the cell in its room, and compares it with the reference tracer's run at the cell's level of accuracy.
inline Outcome run_cell(TestScene& scene, Cell cell) {
  const accel::Accel& accel = scene.accel(cell.config.bvh, cell.config.cull_planes, cell.config.accuracy);
  const TestScene::Reference& reference = scene.reference(cell.config.accuracy);
  Config& c = cell.config;
  give_room(cell, accel);
  ScatterWorkload workload = scene.workload();
  RunOptions options;
  options.threads = cell.threads;
  options.trace = cell.trace;
  options.samples = cell.samples;
  options.timeline = cell.timeline;
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
  if (out.fault.empty()) check_outcome(out, c, reference, workload);
  return out;
}

/// How many random machines to run: `wanted`, times CAROUSEL_EFFORT; fewer under ThreadSanitizer, which is slow.
inline int cell_count(int wanted) {
  wanted = scaled(wanted);
#ifdef __SANITIZE_THREAD__
  wanted /= 8;
#endif
  return std::max(1, wanted);
}

}  // namespace carousel::ringbus
