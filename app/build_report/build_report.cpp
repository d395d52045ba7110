#include "app/build_report/build_report.h"

#include <fmt/format.h>

#include "accel/traverse/kernels.h"
#include "app/build_report/cycle_sections.h"
#include "app/build_report/effects.h"
#include "app/build_report/energy_report.h"
#include "app/build_report/levels_section.h"
#include "app/build_report/ring_sections.h"
#include "app/build_report/series.h"
#include "app/build_report/structure_levels.h"
#include "app/charges/charges.h"
#include "app/host/machine_info.h"
#include "app/host/program_info.h"
#include "app/plugins/plugins.h"
#include "core/config/config.h"
#include "core/config/write.h"
#include "core/numeric/condition.h"
#include "core/numeric/digest.h"
#include "core/system/process_memory.h"
#include "core/types/enum_names.h"
#include "report/text/ratio.h"
#include "ringbus/results/run_features.h"

namespace carousel::app {

using report::ratio;

namespace {

report::SceneSummary summary(const Prepared& p) {
  const scene::Scene& s = p.scene;
  report::SceneSummary out;
  out.name = s.name;
  out.triangles = s.unique_triangle_count();
  out.instanced_triangles = s.instanced_triangle_count();
  out.meshes = s.meshes.size();
  out.instances = s.instances.size();
  out.instances_in_double = p.accel.promoted_instances;
  for (std::size_t i = 0; i < s.instances.size(); ++i)
    out.instances_not_held += !p.accel.instances[i].transform.identity &&
                              skeel_condition(DMat3(s.instances[i].world_from_model.linear)) > kConditionForDouble;
  out.materials = s.materials.size();
  out.textures = s.textures.size();
  out.lights = s.lights.size();
  out.cameras = s.cameras.size();
  if (const Aabb box = s.bounds(); !box.empty()) {
    for (int axis = 0; axis < 3; ++axis) {
      out.bounds.lo[static_cast<std::size_t>(axis)] = shortest(box.lo[axis]);
      out.bounds.hi[static_cast<std::size_t>(axis)] = shortest(box.hi[axis]);
    }
  }
  out.warnings = p.warnings;
  return out;
}

std::optional<report::Treelets> treelets(const Prepared& p) {
  if (!p.accel.pieces) return std::nullopt;
  const accel::TreePieces& cut = *p.accel.pieces;
  report::Treelets out;
  out.limit = static_cast<std::uint64_t>(p.config().bvh.treelets.bytes);
  out.count = cut.pieces.size();
  out.most_exits = cut.most_exits;
  out.depth = static_cast<std::uint64_t>(cut.depth);
  out.smallest = cut.pieces.front().bytes;
  for (const accel::TreePieces::Piece& piece : cut.pieces) {
    out.nodes += piece.nodes;
    out.leaves += piece.leaves;
    out.exits += piece.exits;
    out.bytes += piece.bytes;
    out.smallest = std::min<std::uint64_t>(out.smallest, piece.bytes);
    out.largest = std::max<std::uint64_t>(out.largest, piece.bytes);
  }
  return out;
}

report::Structure structure(const Prepared& p, const ringbus::RunResult& result) {
  const accel::StructureSize size = p.structure ? *p.structure : accel::structure_size(p.accel);
  report::Structure out;
  out.primitives = size.primitives;
  out.references = size.references;
  out.duplicates = size.references - size.primitives;
  out.inner_nodes = size.inner_nodes;
  out.leaves = size.leaves;
  out.merged_meshes = p.accel.merged.count();
  out.surface_cost = size.surface_cost;
  if (p.accel.partition) return out;
  const ringbus::cycle::ShapeMemory memory(p.accel, p.config().accuracy, p.config().bvh);
  out.bytes = memory.size_bytes();
  out.levels = structure_levels(p.accel, memory);
  out.depths = structure_depths(p.accel, memory, result.cycle ? &*result.cycle : nullptr);
  add_depths(*out.depths, *out.levels);
  out.treelets = treelets(p);
  return out;
}

report::Micromaps micromaps(const scene::OpacityMicromaps& maps, const IntersectionCounts& tests) {
  report::Micromaps out;
  out.bytes = maps.size_bytes();
  out.maps = maps.maps();
  out.map_bytes = maps.map_bytes();
  out.micro_triangles_each = maps.grid.count();
  out.triangles = {maps.opaque, maps.transparent, maps.unknown};
  out.micro_triangles = {maps.micro_opaque, maps.micro_transparent, maps.micro_unknown};
  out.lookups = tests.micromap_lookups;
  out.calls_saved = tests.micromap_known;
  out.calls = tests.any_hit_calls;
  out.saved_share = ratio(out.calls_saved, out.calls_saved + out.calls);
  return out;
}

report::Host host(const Prepared& p, const ringbus::RunResult& result) {
  report::Host out;
  out.threads = result.threads;
  out.wall_seconds = result.wall_seconds;
  out.rays_per_second = ratio(static_cast<double>(result.rays_completed), result.wall_seconds);
  out.scene_seconds = p.scene_seconds;
  out.build_seconds = p.build_seconds;
  if (p.config().cull_planes.count > 0) out.plane_seconds = p.plane_seconds;
  out.accel_bytes = p.accel.size_bytes();
  out.peak_memory_bytes = peak_memory_bytes();
  out.simd = accel::simd_targets().front();  // only the chosen one is left after a choice
  out.machine = machine_info();
  return out;
}

report::Verify verify(const accel::VerifyingWorkload& verifying) {
  report::Verify out{verifying.compared(), verifying.mismatches(), ""};
  if (const auto& example = verifying.example()) {
    const Hit &got = example->got.hit, &expected = example->expected.hit;
    out.example =
        fmt::format("path {} bounce {}: instance {} primitive {} t {}, expected instance {} primitive {} t {}",
                    example->got.tag.path, example->got.tag.bounce, got.instance, got.primitive, got.t,
                    expected.instance, expected.primitive, expected.t);
  }
  return out;
}

report::Engine engine(const Config& config, const ringbus::RunResult& result) {
  report::Engine out;
  const bool alone = result.threads == 1;
  out.kind = enum_name(config.engine.kind);
  out.deterministic = alone || result.cycle.has_value();
  out.reason = result.cycle ? "virtual time: nothing depends on the host's threads"
               : alone      ? "one thread steps everything in a fixed order"
                       : "threads run on the wall clock: counts of packets and tests depend on their timing; rays, "
                         "hits and picture do not";
  return out;
}

report::Stop stop(const Config& config, const ringbus::RunResult& result) {
  report::Stop out;
  out.resource = static_cast<std::uint64_t>(config.faults.resource.number);
  out.packets_discarded = result.packets_discarded;
  if (result.cycle && result.cycle->stop) {
    const ringbus::cycle::StopTimes& at = *result.cycle->stop;
    out.stopped_cycle = at.stopped;
    out.noticed_cycle = at.noticed;
    if (at.restarted > 0) out.restarted_cycle = at.restarted;
  }
  return out;
}

}  // namespace

report::Report build_report(const Prepared& prepared, const RenderJob& job, const ringbus::RunResult& result,
                            const accel::VerifyingWorkload* verifying) {
  const Config& config = prepared.config();
  report::Report r;
  r.incomplete = !result.complete;
  r.carousel = program_info();
  r.config = config_json(prepared.absolute_config());
  for (const IgnoredKey& ignored : prepared.ignored()) r.ignored_keys.push_back(ignored.key);
  r.plugins = plugins_section(prepared.located.plugins);
  r.scene = summary(prepared);
  r.structure = structure(prepared, result);
  if (!prepared.accel.groups.empty()) r.levels = levels_section(prepared.accel);
  r.host = host(prepared, result);
  r.host.raster_seconds = job.raster_seconds();
  r.raster = job.raster();
  if (result.rays_restarted > 0 && !result.cycle) r.host.recovery_seconds = result.recovery_seconds;
  r.engine = engine(config, result);
  const auto emitted = job.emitted();
  r.rays = {result.rays_emitted,   result.rays_completed,  result.rays_emitted - result.rays_completed,
            result.rays_restarted, result.paths_restarted, {emitted[0], emitted[1], emitted[2]}};
  if (!result.resources.empty()) {
    add_ring(r, result, config, prepared.accel);
    if (prepared.micromaps) r.micromaps = micromaps(*prepared.micromaps, r.tests->counts);
    add_links(r, result, config);
    r.drawing = drawing(config.topology, true);
  }
  add_nearest(r, result, config);
  add_ranks(r, result);
  add_ray_queues(r, result, config);
  r.shading.workers = static_cast<std::uint64_t>(shader_workers(config));
  r.shading.shaded = result.rays_completed;
  r.shading.saturated = job.saturated();
  add_effects(r.shading, prepared.scene, config);
  if (result.series) (result.cycle ? r.time_series : r.host.time_series) = series_section(*result.series);
  if (result.cycle) add_cycles(r, *result.cycle, config, prepared.accel);
  if (result.cycle) {
    r.charges.emplace();
    for (const Charge* charge : uncharged(prepared.located, ringbus::scene_facts(prepared.accel))) {
      report::Charge& row = r.charges->emplace_back(report::Charge{charge->name, charge->meaning});
      if (*charge->key == 0) continue;
      row.key = charge->key;
      row.set = fmt::format("{}={}", charge->key, charge->charged);
    }
  }
  add_energy(r, config, ringbus::scene_facts(prepared.accel));
  if (result.rays_restarted > 0 || (result.cycle && result.cycle->stop)) r.faults.emplace().stop = stop(config, result);
  if (verifying) r.verify = verify(*verifying);
  r.digest = {job.hits_digest(), job.image_digest()};
  return r;
}

report::Report report_without_rays(const Prepared& prepared, bool complete, std::uint64_t cycles, std::size_t threads,
                                   double wall_seconds) {
  report::Report r;
  r.incomplete = !complete;
  r.carousel = program_info();
  r.config = config_json(prepared.absolute_config());
  for (const IgnoredKey& ignored : prepared.ignored()) r.ignored_keys.push_back(ignored.key);
  r.plugins = plugins_section(prepared.located.plugins);
  r.scene.name = "none";
  r.engine.kind = enum_name(prepared.config().engine.kind);
  r.engine.cycles = cycles;
  r.engine.deterministic = true;
  r.engine.reason = "virtual time: nothing depends on the host's threads";
  r.digest.hits = HitsDigest().hex();
  r.host.threads = threads;
  r.host.wall_seconds = wall_seconds;
  r.host.peak_memory_bytes = peak_memory_bytes();
  r.host.simd = accel::simd_targets().front();
  r.host.machine = machine_info();
  return r;
}

}  // namespace carousel::app
