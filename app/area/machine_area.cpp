#include "app/area/machine_area.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "app/area/area_split.h"
#include "core/config/costs.h"
#include "core/config/load/validate.h"
#include "core/config/own_sections.h"
#include "core/config/shader_programs.h"
#include "core/program/program.h"
#include "core/system/error.h"
#include "core/types/nearest_counts.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/topology/wire_length.h"

namespace carousel::app {

namespace {

using report::AreaPart;

constexpr double kRecordBytes = 64, kIdBytes = 4, kStackBytes = 64, kHeaderBytes = 16, kKiB = 1024, kEntryBytes = 12,
                 kNodeBytes = 128, kWaitingBytes = 256, kVoteBytes = 8;

/// The area of a unit. A bundle unit may be a pair of blocks. A box unit that tests bundles as well is as large as a
/// unit that tests their silhouettes, or larger.
double unit_mm2(const Config& c, const TestersConfig& testers, UnitKind kind) {
  using Blocks = TestersConfig::BundleBlocks;
  const double own = cost(c, area_of(kind));
  if (kind == UnitKind::kBundle && testers.bundle_blocks == Blocks::kPairs) return 2 * own;
  if (kind == UnitKind::kBox && testers.bundle_blocks == Blocks::kShared && c.bundles.size > 0 &&
      c.bundles.form == BundlesConfig::Form::kSilhouette)
    return std::max(own, static_cast<double>(silhouette_unit_mm2(c)));
  return own;
}

void add_units(report::AreaOf& out, const Config& c, const SceneFacts& scene, const TestersConfig& testers) {
  for (const auto [kind, units] : testers.units) {
    if (!has_units(c, scene, kind)) continue;
    const auto lanes = static_cast<double>(units.units * testers.simd.lanes * own_testers(c));
    out.size += lanes;
    out.mm2 += lanes * unit_mm2(c, testers, kind);
  }
}

/// Instructions of all programs, and registers, of each unit that runs programs (KiB).
double program_kib(const Config& c) {
  if (c.scene.objects.empty()) return 0;
  std::size_t instructions = 0;
  for (const auto& [name, primitive] : c.primitives.named) instructions += primitive.program.size();
  constexpr double kRegisterBytes = 4;
  const double unit = static_cast<double>(kInstructionBytes * instructions) + kRegisterBytes * kMostRegisters;
  return unit * static_cast<double>(ray_owners(c.topology) * own_testers(c)) / kKiB;
}

/// The registers, the caches and the TLBs of all shader workers, and the store of their programs (KiB). Without a
/// cache each worker has a store of its own.
double shader_program_kib(const Config& c) {
  constexpr double kRegisterBytes = 4;
  const auto workers = static_cast<double>(shader_workers(c));
  const auto store = static_cast<double>(shade_programs(c.shading, c.programs, c.testers).store_bytes);
  const auto cache = static_cast<double>(c.shading.instruction_cache.bytes);
  const std::int64_t pages = c.shading.translation.page_bytes > 0 ? c.shading.translation.entries : 0;
  const double each = kRegisterBytes * static_cast<double>(c.shading.registers) + (cache > 0 ? cache : store) +
                      static_cast<double>(c.shading.data_cache.bytes + kTlbEntryBytes * pages);
  return (workers * each + (cache > 0 ? store : 0)) / kKiB;
}

/// A place of a link's queue: a packet, and what travels in its place.
double place_bytes(const Config& c) {
  const auto rays = static_cast<double>(c.packets.rays), boxes = static_cast<double>(c.bvh.width);
  const double packet = kHeaderBytes + kIdBytes * rays;
  switch (c.packets.results) {
    case PacketResults::kPerShape:
      return boxes * packet;
    case PacketResults::kMessage:
      return packet + boxes * rays * (kHeaderBytes + kIdBytes);
    default:
      return packet;
  }
}

/// Gives the parts that all resources share the size for those of `c`, by the factor over those of `from`. False if a
/// part would be out of its range.
bool scale_shared_parts(Config& c, const Config& from) {
  const std::int64_t n = c.topology.resources, was = from.topology.resources;
  const auto scaled = [&](std::int64_t size) { return std::max<std::int64_t>(1, (2 * size * n + was) / (2 * was)); };
  if (from.shading.workers) c.shading.workers = scaled(*from.shading.workers);
  if (from.memory.shared_by >= was) {  // one L2
    c.memory.shared_by = n;
    c.memory.l2_kib = scaled(from.memory.l2_kib);
    c.memory.l2_banks = scaled(from.memory.l2_banks);
  }
  return c.shading.workers.value_or(1) <= 256 && c.memory.l2_banks <= 64 && c.memory.l2_kib <= 1 << 20;
}

/// Rays of a resource with warps that have a next step: those in warps, and those that wait to be packed anew.
std::int64_t stepping_rays(const OwnSections& own) {
  const SimtConfig& simt = own.testers.simt;
  const std::int64_t slots = own.rays.slots_per_resource;
  return simt.compaction == SimtConfig::Compaction::kRepack ? slots : std::min(simt.warp * simt.warps, slots);
}

/// The stacks of a resource that traces its own rays; with warps also the data of the node that each lane tests, and
/// the table of a prefetcher, with a treelet and its votes for each ray that has a next step.
double stack_kib(const Config& c, std::int64_t resource) {
  const OwnSections own = own_sections(c, resource);
  const SimtConfig& simt = own.testers.simt;
  if (simt.warp == 0) {
    const std::int64_t entries = own.testers.stack_entries;
    return static_cast<double>(own.rays.slots_per_resource) *
           (entries > 0 ? static_cast<double>(entries) * kEntryBytes : kStackBytes) / kKiB;
  }
  const double votes =
      simt.prefetch == SimtConfig::Prefetch::kTreelet ? static_cast<double>(stepping_rays(own)) * kVoteBytes : 0;
  return register_kib(c, resource) + (static_cast<double>(simt.warp * simt.warps) * kNodeBytes + votes) / kKiB;
}

/// Bytes beside a record for its buffer of hits, for what waits for a later round, and for light from Gaussians.
double hit_buffer_bytes(const Config& c, const SceneFacts& scene) {
  const QueryConfig& query = c.rays.query;
  const bool resumes = query.in_rounds() && query.rounds == QueryConfig::Rounds::kResume;
  return static_cast<double>(query.buffered()) * static_cast<double>(kBufferedHitBytes) +
         (resumes ? kWaitingBytes : 0) + (scene.gaussians ? static_cast<double>(kBlendedLightBytes) : 0);
}

}  // namespace

/// Rays that are packed anew keep their stacks while they wait for a warp.
double register_kib(const Config& c, std::int64_t resource) {
  const OwnSections own = own_sections(c, resource);
  return static_cast<double>(stepping_rays(own) * own.testers.simt.stack_entries) * kEntryBytes / kKiB;
}

double raster_kib(const Config& c) {
  return static_cast<double>(c.raster.requests * c.memory.line_bytes) / kKiB;
}

double builder_kib(const Config& c) {
  return static_cast<double>(c.frames->builder.local_primitives * BuilderConfig::kRecordBytes +
                             c.frames->builder.requests * c.memory.line_bytes) /
         kKiB;
}

report::Area machine_area(const Config& c, const SceneFacts& scene) {
  report::Area out;
  report::AreaParts& parts = out.parts;
  const ringbus::Topology topology(c.topology);
  const auto n = static_cast<double>(c.topology.resources);
  const auto store = [&](AreaPart part, double kib) {
    parts[part].size += kib;
    parts[part].mm2 += kib * cost(c, Cost::kSramArea);
  };
  for (std::int64_t r = 0; r < c.topology.resources; ++r)
    add_units(parts[AreaPart::kUnits], c, scene, built_sections(c, r).testers);
  const auto all = [&](const auto& of) { return static_cast<double>(sum_of_resources(c, of)); };
  const auto slots = static_cast<double>(all_slots(c));
  parts[AreaPart::kUnits].mm2 += program_kib(c) * cost(c, Cost::kSramArea);
  store(AreaPart::kRayStores, slots * (kRecordBytes + hit_buffer_bytes(c, scene)) / kKiB);
  if (c.rays.banks > 0)  // each bank has two ports
    parts[AreaPart::kRayStores].mm2 += parts[AreaPart::kRayStores].size * cost(c, Cost::kPortArea);
  if (topology.has_packets())
    store(AreaPart::kCollections,
          all([](const OwnSections& one) { return one.collections.capacity; }) * kIdBytes / kKiB);
  double stacks = 0;
  for (std::int64_t r = 0; r < c.topology.resources && !topology.has_packets(); ++r) stacks += stack_kib(c, r);
  store(AreaPart::kStacks, stacks);
  store(AreaPart::kShapeBuffers, all([](const OwnSections& one) { return one.memory.shape_buffer_kib; }));
  store(AreaPart::kL1, all([](const OwnSections& one) { return one.memory.l1_kib; }));
  out.link_mm = c.area.link_mm ? static_cast<double>(*c.area.link_mm) : std::sqrt(parts.mm2() / n);
  const ringbus::ParcelPlan drawn = ringbus::plan_parcels(c.topology, c.memory.line_bytes);
  const std::int64_t caches = drawn.parts.caches.empty()
                                  ? (c.topology.resources + c.memory.shared_by - 1) / c.memory.shared_by
                                  : static_cast<std::int64_t>(drawn.parts.cache_nodes());
  const std::int64_t pages = c.memory.translation.page_bytes > 0 ? c.memory.translation.entries : 0;
  store(AreaPart::kL2, static_cast<double>(caches) *
                           (static_cast<double>(c.memory.l2_kib) + static_cast<double>(kTlbEntryBytes * pages) / kKiB));
  if (drawn.parts.caches.empty()) {  // else links bring the lines
    const MemoryConfig& memory = c.memory;
    const std::int64_t width = memory.l2_answer_bytes_per_cycle > 0
                                   ? memory.l2_answer_bytes_per_cycle
                                   : memory.l2_banks * memory.l2_lines_per_cycle * memory.line_bytes;
    const double way_mm =
        out.link_mm * std::sqrt(static_cast<double>(std::min(memory.shared_by, c.topology.resources))) / 2;
    report::AreaOf& ports = parts[AreaPart::kMemoryPorts];
    ports.size = 8 * static_cast<double>(caches * width) * way_mm;
    ports.mm2 = ports.size * cost(c, Cost::kWirePitch) / 1000;
  }
  double places = 0;
  for (const ringbus::Topology::Wire& wire : topology.wires()) {
    places += static_cast<double>(wire.depth + wire.places);
    if (wire.from.value >= topology.resources()) places += topology.hub_places(wire.from.value - topology.resources());
  }
  store(AreaPart::kLinkQueues, places * place_bytes(c) / kKiB);
  const TestersConfig::Distributor& distributor = c.testers.distributor;
  if (has_distributor(c))
    store(AreaPart::kLinkQueues, static_cast<double>(distributor.testers) *
                                     (kIdBytes * static_cast<double>(distributor.queue) +
                                      kHeaderBytes * static_cast<double>(distributor.results)) /
                                     kKiB);
  Parts::for_each([&]<class P>(std::size_t i) {
    const auto& keys = c.parts.of<P>();
    if (!P::is_built(keys)) return;
    const PartArea each = P::area(keys, costs_of(c));
    parts.declared[i] = {static_cast<double>(caches) * each.size, static_cast<double>(caches) * each.mm2};
  });
  double ring_mm = 0;  // as wide as topology.link
  for (const ringbus::StopRingWire& wire : ringbus::stop_ring_wires(c.topology, out.link_mm))
    ring_mm +=
        wire.mm * static_cast<double>(wire.bytes_per_cycle) / static_cast<double>(c.topology.link.bytes_per_cycle);
  report::AreaOf& wires = parts[AreaPart::kWires];
  const std::int64_t width = c.topology.link.bytes_per_cycle;
  wires.size =
      8 * static_cast<double>(width) *
      (wire_lengths(topology, width, out.link_mm) + ring_mm + drawn.lengths_without_packets(width, out.link_mm) +
       (has_distributor(c) ? out.link_mm : 0));  // the bus to the testers
  wires.mm2 = wires.size * cost(c, Cost::kWirePitch) / 1000;
  const bool programs = c.shading.program.any();
  report::AreaOf& shaders = parts[AreaPart::kShaders];
  shaders.size = static_cast<double>(shader_workers(c) * c.shading.lanes *
                                     (programs ? 1 : std::max<std::int64_t>(1, c.shading.products_per_cycle)));
  shaders.mm2 = shaders.size * cost(c, Cost::kShaderArea);
  if (programs) shaders.mm2 += shader_program_kib(c) * cost(c, Cost::kSramArea);
  if (c.frames && c.frames->count > 1 && c.frames->update != FrameUpdate::kNone) {
    store(AreaPart::kBuilder, builder_kib(c));
    parts[AreaPart::kBuilder].mm2 += static_cast<double>(c.frames->builder.boxes_per_cycle) * cost(c, Cost::kBoxUnit);
  }
  if (c.primary == Primary::kRaster && c.raster.time == RasterConfig::Time::kCycles) {
    store(AreaPart::kRaster, raster_kib(c));
    parts[AreaPart::kRaster].mm2 +=
        static_cast<double>(c.raster.triangles_per_cycle) * cost(c, area_of(UnitKind::kTriangle)) +
        static_cast<double>(c.raster.samples_per_cycle) * cost(c, area_of(UnitKind::kBox));
  }
  out.mm2 = parts.mm2();
  return out;
}

std::optional<Config> largest_machine(const LocatedConfig& machine, const SceneFacts& scene, bool all) {
  Config c = machine.config;
  const auto budget = static_cast<double>(*c.area.budget_mm2);
  for (std::int64_t n = config::kMaxResources; n > 0; --n) {
    c.topology.resources = n;
    if (all && !scale_shared_parts(c, machine.config)) continue;
    if (validate_config(c, machine.positions, {.force = true}).empty() && machine_area(c, scene).mm2 <= budget)
      return c;
  }
  return std::nullopt;
}

void fit_area(LocatedConfig& located, const SceneFacts& scene) {
  Config& c = located.config;
  if (!c.area.budget_mm2) return;
  const auto budget = static_cast<double>(*c.area.budget_mm2);
  const auto refuse = [&](const std::string& why) {
    throw ConfigError({{located.positions.find("area.budget_mm2"), "area.budget_mm2", why}});
  };
  if (c.energy.profile == CostProfile::kNone)
    refuse("an area needs a process; expected energy.profile: n45 or n7, found none");
  if (c.area.fit == AreaConfig::Fit::kRefuse) {
    const double area = machine_area(c, scene).mm2;
    if (area > budget)
      refuse(fmt::format("expected a machine of at most {} mm2, found one of {:.4g}", *c.area.budget_mm2, area));
    return;
  }
  using Fit = AreaConfig::Fit;
  std::optional<Config> fitted = c.area.fit == Fit::kBest ? machine_of(located, scene, {})
                                                          : largest_machine(located, scene, c.area.fit == Fit::kAll);
  if (!fitted)
    refuse(fmt::format("no number of resources makes a machine of at most {} mm2; with {} it has {:.4g}",
                       *c.area.budget_mm2, c.topology.resources, machine_area(c, scene).mm2));
  if (c.area.fit != Fit::kBest) c = std::move(*fitted);
}

void require_no_search(const LocatedConfig& located) {
  if (is_searched(located.config.area))
    throw ConfigError({{located.positions.find("area.fit"), "area.fit",
                        "only carousel run, sweep and versus search for a split; expected resources, all or refuse, "
                        "found best"}});
}

}  // namespace carousel::app
