#include "app/energy/energy_account.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "app/area/machine_area.h"
#include "core/config/costs.h"
#include "core/config/own_sections.h"
#include "core/config/shader_programs.h"
#include "core/program/program.h"
#include "ringbus/topology/wire_length.h"

namespace carousel::app {

using report::EnergyPart;

namespace {

constexpr double kWord = 8;  // bytes of an access
constexpr double kRayRecordBytes = 64, kPlaceBytes = 64, kRayIdBytes = 4;
/// The reciprocals of a ray's direction stand in its record, as AMD's instructions take them with the ray (RDNA 2
/// instruction set, 2020, IMAGE_BVH_INTERSECT_RAY): in place of tmax, which is the hit's distance while the ray is in
/// flight, and of what the tag says beside its flags, which shading knows by the ray's ID. So a visit divides nothing.
constexpr double kDirectionParts = 3;

/// The mean of all resources that have any, as their accesses are counted together.
template <class Of>
double mean(const Config& c, const Of& of) {
  const std::int64_t those = sum_of_resources(c, [&](const OwnSections& one) { return of(one) > 0 ? 1 : 0; });
  return static_cast<double>(sum_of_resources(c, of)) / static_cast<double>(std::max<std::int64_t>(1, those));
}

/// In the order of the report's links.
std::vector<double> lengths(const Config& c, const ringbus::ParcelPlan& drawn, double link_mm) {
  const ringbus::Topology topology(c.topology);
  std::vector<double> out;
  for (const ringbus::Topology::Wire& wire : topology.wires()) out.push_back(wire_length(topology, wire, link_mm));
  for (const config::Graph::Link& link : drawn.without_packets()) out.push_back(drawn.length(link, link_mm));
  for (const ringbus::StopRingWire& wire : ringbus::stop_ring_wires(c.topology, link_mm)) out.push_back(wire.mm);
  return out;
}

}  // namespace

EnergyAccount::EnergyAccount(const Config& config, double link_mm, std::vector<ByteRow> rows)
    : c_(config),
      drawn_(ringbus::plan_parcels(config.topology, config.memory.line_bytes)),
      link_mm_(link_mm),
      costs_(costs_of(config)),
      work_(work_prices(config)),
      rows_(std::move(rows)),
      wire_mm_(lengths(config, drawn_, link_mm)),
      rays_kib_(mean(config, [](const OwnSections& one) { return one.rays.slots_per_resource; }) *
                (kRayRecordBytes + static_cast<double>(config.rays.query.buffered()) * kBufferedHitBytes) / 1024 /
                static_cast<double>(own_testers(config))),
      collections_kib_(kRayIdBytes * mean(config, [](const OwnSections& one) { return one.collections.capacity; }) /
                       1024),
      buffer_kib_(mean(config, [](const OwnSections& one) { return one.memory.shape_buffer_kib; })),
      l1_kib_(mean(config, [](const OwnSections& one) { return one.memory.l1_kib; })),
      l2_kib_(static_cast<double>(config.memory.l2_kib) / static_cast<double>(config.memory.l2_banks)),
      programs_kib_(
          config.shading.program.any()
              ? static_cast<double>(shade_programs(config.shading, config.programs, config.testers).store_bytes) / 1024
              : 0) {}

EnergyAccount::WorkPrices EnergyAccount::work_prices(const Config& config) {
  const auto of = [&](UnitKind kind, Method method, bool wide) { return work_pj(config, kind, method, wide); };
  const bool wide = config.accuracy.transform == TransformLevel::kTwoStepDouble;
  return {of(UnitKind::kTriangle, Method::kWatertight, true),     of(UnitKind::kTriangle, Method::kExactVolume, true),
          of(UnitKind::kTransform, Method::kTwoStep, true),       of(UnitKind::kTransform, Method::kInversion, wide),
          of(UnitKind::kTransform, Method::kFullInversion, wide), of(UnitKind::kTransform, Method::kInversion, true)};
}

/// Adds up the energy of some events.
class EnergyAccount::Sum {
 public:
  Sum(const EnergyAccount& account, const ringbus::EnergyEvents& events, double memory_times)
      : a_(account), e_(events), memory_times_(memory_times) {}

  report::EnergyParts take() {
    for (std::size_t r = 0; r < e_.resources.size(); ++r) resource(e_.resources[r], static_cast<std::int64_t>(r));
    caches();
    for (std::size_t i = 0; i < e_.link_bytes.size(); ++i) {
      const auto bytes = static_cast<double>(e_.link_bytes[i]);
      parts_[EnergyPart::kPorts].add(bytes, pj(Cost::kHop));
      parts_[EnergyPart::kWires].add(bytes * a_.wire_mm_.at(i), pj(Cost::kWire));
    }
    for (std::size_t i = 0; i < e_.row_bytes.size(); ++i) message(a_.rows_[i], static_cast<double>(e_.row_bytes[i]));
    if (a_.c_.shading.program.any())
      shader_instructions(e_.programs, e_.shade_data);
    else
      parts_[EnergyPart::kShades].add(static_cast<double>(e_.shaded), pj(Cost::kShade));
    divisions(static_cast<double>(e_.shaded));  // each ray that is shaded has been made once
    parts_[EnergyPart::kProducts].add(static_cast<double>(e_.products), pj(Cost::kProduct));
    parts_[EnergyPart::kLookups].add(static_cast<double>(e_.lookups), pj(Cost::kLookup));
    parts_[EnergyPart::kActivations].add(memory_times_ * static_cast<double>(e_.activations),
                                         pj(hbm() ? Cost::kHbmActivation : Cost::kDramActivation));
    return parts_;
  }

 private:
  double pj(Cost of) const { return a_.costs_.of(of); }
  bool hbm() const { return a_.c_.memory.dram.preset == DramConfig::Preset::kHbm2; }
  void access(EnergyPart part, double bytes, double kib) {
    parts_[part].add(bytes / kWord, a_.costs_.sram_access_pj(kib));
  }

  void resource(const ringbus::EnergyEvents::OfResource& of, std::int64_t number) {
    for (const UnitKindRow& row : kUnitKinds) {
      // The energy of a test by a program is that of its instructions.
      std::uint64_t by_program = row.kind == UnitKind::kProcedural ? of.tests.programs : 0;
      if (row.kind == UnitKind::kAnyHit && runs_any_hit_programs(a_.c_.shading, a_.c_.testers))
        by_program = of.tests.any_hit_calls;
      const std::uint64_t by_silhouette = row.kind == UnitKind::kBundle ? of.tests.silhouettes : 0;
      parts_.units[row.kind].add(static_cast<double>(of.tests.*row.tests - by_program - by_silhouette),
                                 pj(energy_of(row.kind)));
      parts_.units[row.kind].events += static_cast<double>(by_program);
    }
    parts_.units[UnitKind::kBundle].add(static_cast<double>(of.tests.silhouettes), pj(Cost::kSilhouetteTest));
    parts_.units[UnitKind::kBundle].add_work(static_cast<double>(of.tests.edges), pj(Cost::kEdgeTest));
    constexpr double kChannels = 3;
    if (of.color_terms > 0)
      parts_.units[UnitKind::kHitBuffer].add_work(kChannels * static_cast<double>(of.color_terms),
                                                  pj(Cost::kProductInstruction));
    divisions(static_cast<double>(of.tests.transforms));
    beside_tests(of.tests);
    if (of.tests.programs > 0) instructions(of.tests);
    access(EnergyPart::kRayStore, kRayRecordBytes * static_cast<double>(of.record_reads), a_.rays_kib_);
    access(EnergyPart::kRayStore, static_cast<double>(of.buffer_bytes), a_.rays_kib_);
    access(EnergyPart::kCollections, 2 * kRayIdBytes * static_cast<double>(of.packet_rays), a_.collections_kib_);
    access(EnergyPart::kShapeBuffers, kPlaceBytes * static_cast<double>(of.shape_reads), a_.buffer_kib_);
    if (of.prefetch_votes > 0)
      parts_[EnergyPart::kShapeBuffers].add_work(static_cast<double>(of.prefetch_votes), pj(Cost::kPrefetchVote));
    if (of.stack_bytes > 0)
      access(EnergyPart::kStacks, static_cast<double>(of.stack_bytes),
             of.warps ? register_kib(a_.c_, number) : a_.rays_kib_);
  }

  /// Triangles that are tested again in 64 bits, exact volumes, transforms in 64 bits instead of 32, and inversions.
  void beside_tests(const IntersectionCounts& tests) {
    const auto add = [&](UnitKind kind, std::uint64_t times, double each) {
      parts_.units[kind].add_work(static_cast<double>(times), each);
    };
    add(UnitKind::kTriangle, tests.refined, a_.work_.refined);
    add(UnitKind::kTriangle, tests.exact_volumes, a_.work_.exact_volume);
    add(UnitKind::kTransform, tests.transforms_in_double, a_.work_.transform_in_double - pj(Cost::kTransform));
    add(UnitKind::kTransform, tests.inversions - tests.full_inversions - tests.inversions_in_double,
        a_.work_.inversion);
    add(UnitKind::kTransform, tests.full_inversions, a_.work_.full_inversion);
    add(UnitKind::kTransform, tests.inversions_in_double, a_.work_.inversion_in_double);
  }

  /// Reciprocals of the directions of so many rays: a box test multiplies by them.
  void divisions(double rays) {
    parts_.units[UnitKind::kReciprocal].add(kDirectionParts * rays, pj(Cost::kReciprocal));
  }

  void instructions(const IntersectionCounts& counts) {
    const auto add = [&](std::uint64_t executed, Cost each) {
      parts_.units[UnitKind::kProcedural].add_work(static_cast<double>(executed), pj(each));
    };
    add(counts.simple_instructions, Cost::kSimpleInstruction);
    add(counts.product_instructions, Cost::kProductInstruction);
    add(counts.divide_instructions, Cost::kDivideInstruction);
    add(counts.branch_instructions, Cost::kBranchInstruction);
  }

  /// In place of a constant for a ray that is shaded. To read is to issue: the caches are charged for the lines,
  /// and the store of programs for those that an instruction cache did not have.
  void shader_instructions(const ShadeProgramCounts& counts, const ShadeDataCounts& data) {
    const auto add = [&](EnergyPart part, std::uint64_t executed, Cost each) {
      parts_[part].add(static_cast<double>(executed), pj(each));
    };
    add(EnergyPart::kShades, counts.simple + counts.read + counts.trace, Cost::kSimpleInstruction);
    add(EnergyPart::kShades, counts.product, Cost::kProductInstruction);
    add(EnergyPart::kShades, counts.divide, Cost::kDivideInstruction);
    add(EnergyPart::kShades, counts.branch, Cost::kBranchInstruction);
    add(EnergyPart::kLookups, counts.texture, Cost::kLookup);
    access(EnergyPart::kShades, static_cast<double>(counts.instruction_bytes), a_.programs_kib_);
    const DataCacheConfig& cache = a_.c_.shading.data_cache;
    const auto line = static_cast<double>(cache.line_bytes.value_or(a_.c_.memory.line_bytes));
    // A line is read when it is there and written when it comes, and its lookup reads a tag; a page is one word.
    if (data.lines > 0)
      access(EnergyPart::kShades, line * static_cast<double>(data.lines) + kWord * static_cast<double>(data.lines),
             static_cast<double>(cache.bytes) / 1024);
    if (data.pages > 0)
      access(EnergyPart::kShades, kWord * static_cast<double>(data.pages + data.walks),
             static_cast<double>(a_.c_.shading.translation.entries * kTlbEntryBytes) / 1024);
  }

  void caches() {
    const auto line = static_cast<double>(a_.c_.memory.line_bytes);
    access(EnergyPart::kL2, line * static_cast<double>(e_.l2_lines) + kWord * static_cast<double>(e_.asked_ahead),
           a_.l2_kib_);
    if (e_.l2_pages > 0)
      access(EnergyPart::kL2, kWord * static_cast<double>(e_.l2_pages),
             static_cast<double>(a_.c_.memory.translation.entries * kTlbEntryBytes) / 1024);
    if (a_.l1_kib_ > 0) access(EnergyPart::kL1, line * static_cast<double>(e_.l1_lines), a_.l1_kib_);
    Parts::for_each([&]<class P>(std::size_t i) {
      if (!e_.parts.of<P>()) return;
      const PartEnergy energy = P::energy(*e_.parts.of<P>(), a_.c_.parts.of<P>(), a_.costs_);
      parts_.declared[i].emplace().add(energy.events, energy.pj_each);
    });
  }

  /// Shared parts stand in the middle of the square of the resources that share them: the way is half of its side.
  void message(const ByteRow& row, double bytes) {
    if (row.over == "links") return;
    if (row.from == "DRAM" || row.to == "DRAM") {
      if (row.from == "L2" && row.over == "address wires") return;  // contained in the bytes of the lines
      if (row.to == "L2") access(EnergyPart::kL2, memory_times_ * bytes, a_.l2_kib_);
      parts_[EnergyPart::kDram].add(memory_times_ * bytes, pj(hbm() ? Cost::kHbm : Cost::kDram));
      return;
    }
    if (!travels_over_links(row)) {
      parts_[EnergyPart::kMessages].add(bytes, pj(Cost::kHop));
      parts_[EnergyPart::kMessageWires].add(bytes * a_.link_mm_ * std::sqrt(static_cast<double>(sharing(row))) / 2,
                                            pj(Cost::kWire));
    }
    if (row.what == "new rays" || row.what == "completed rays") access(EnergyPart::kRayStore, bytes, a_.rays_kib_);
    if (row.from == "L2" && row.to == "L1") access(EnergyPart::kL1, bytes, a_.l1_kib_);
    if (row.what == "shape data") access(EnergyPart::kShapeBuffers, bytes, a_.buffer_kib_);
  }

  /// The resources that share the parts between which the messages go. Parts that declare themselves are beside the
  /// L2s.
  std::int64_t sharing(const ByteRow& row) const {
    const auto is = [&](std::string_view name) { return row.from == name || row.to == name; };
    bool at_l2 = is("L2");
    Parts::for_each([&]<class P>(std::size_t) { at_l2 |= is(P::kName); });
    if (at_l2) return std::min(a_.c_.memory.shared_by, a_.c_.topology.resources);
    return is("L1") ? 1 : a_.c_.topology.resources;
  }

  /// The rows of links count what is drawn.
  bool travels_over_links(const ByteRow& row) const {
    if (row.what == "new rays") return a_.drawn_.parts.new_rays;
    if (row.what == "completed rays") return a_.drawn_.parts.completed_rays;
    return !a_.drawn_.parts.caches.empty() && (row.from == "L2" || row.to == "L2");
  }

  const EnergyAccount& a_;
  const ringbus::EnergyEvents& e_;
  double memory_times_;
  report::EnergyParts parts_;
};

report::EnergyParts EnergyAccount::parts(const ringbus::EnergyEvents& events, double memory_times) const {
  return Sum(*this, events, memory_times).take();
}

ringbus::EnergyEvents energy_events(const report::Report& r) {
  ringbus::EnergyEvents out;
  for (const report::Resource& resource : *r.resources) {
    ringbus::EnergyEvents::OfResource& of = out.resources.emplace_back();
    of.tests = resource.tests;
    of.record_reads = resource.counts.reads + (resource.units ? resource.units->second_reads.value_or(0) : 0);
    of.packet_rays = resource.counts.packet_rays;
    if (resource.stack) of.stack_bytes = resource.stack->pushed_bytes + resource.stack->popped_bytes;
    of.warps = resource.units && resource.units->warps;
    if (of.warps) of.stack_bytes += 2 * resource.units->warps->counts.packed_bytes;
    if (of.warps) of.prefetch_votes = resource.units->warps->counts.votes;
  }
  // The report has these of all resources together.
  if (!out.resources.empty() && r.nearest) {
    out.resources.front().buffer_bytes = r.nearest->counts.moved_bytes();
    out.resources.front().color_terms = r.nearest->counts.color_terms;
  }
  const ShapeBufferCounts& buffers = r.memory->shape_buffers.counts;
  if (!out.resources.empty()) out.resources.front().shape_reads = buffers.hits + buffers.merged + buffers.misses;
  for (const report::Link& link : *r.links) out.link_bytes.push_back(link.bytes.value_or(0));
  for (const ByteRow& row : *r.bytes) out.row_bytes.push_back(row.bytes);
  for (const report::Cache& cache : r.memory->caches) {
    out.l2_lines += cache.counts.lines;
    out.asked_ahead += cache.ahead ? cache.ahead->asked : 0;
    out.l2_pages += cache.counts.pages + cache.counts.walks;
  }
  if (r.memory->own_caches) out.l1_lines = r.memory->own_caches->counts.lines;
  out.parts = r.parts;
  out.shaded = r.shading.shaded;
  out.products = r.shading.products.value_or(0);
  out.lookups = r.shading.lookups.value_or(0);
  if (r.shading.programs) {
    out.programs = r.shading.programs->counts;
    if (r.shading.programs->data) out.shade_data = *r.shading.programs->data;
  }
  if (r.memory->dram)
    for (const report::DramChannel& channel : r.memory->dram->channels)
      out.activations += channel.counts.row_misses + channel.counts.row_conflicts;
  return out;
}

double joules_of(const report::EnergyParts& parts) {
  double joules = 0;
  for (const auto [kind, part] : parts.units) joules += part.joules;
  for (const report::EnergyOf& part : parts.others) joules += part.joules;
  for (const std::optional<report::EnergyOf>& part : parts.declared) joules += part ? part->joules : 0;
  return joules;
}

}  // namespace carousel::app
