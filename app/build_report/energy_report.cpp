#include "app/build_report/energy_report.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "app/area/machine_area.h"
#include "core/config/costs.h"
#include "core/config/own_sections.h"
#include "core/config/write.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/topology/wire_length.h"

namespace carousel::app {

using report::EnergyPart;
using report::ratio;

namespace {

class Account {
  static constexpr double kWord = 8;  ///< bytes of an access
  static constexpr double kRecordBytes = 64, kPlaceBytes = 64, kIdBytes = 4;

 public:
  /// `memory_times`: the memory moves so many times the bytes of the run, and activates so many times its rows.
  Account(const report::Report& r, const Config& config, double link_mm, double memory_times = 1)
      : r_(r),
        c_(config),
        link_mm_(link_mm),
        costs_(costs_of(config)),
        memory_times_(memory_times),
        rays_kib_(mean([](const OwnSections& one) { return one.rays.slots_per_resource; }) *
                  (kRecordBytes + static_cast<double>(config.rays.query.buffered()) * kBufferedHitBytes) / 1024 /
                  static_cast<double>(own_testers(config))) {}

  report::EnergyParts take() {
    tests();
    stores();
    packets();
    for (const ByteRow& row : *r_.bytes) message(row);
    shading();
    for (const auto [kind, part] : parts_.units) part.rays = static_cast<double>(r_.rays.completed);
    for (report::EnergyOf& part : parts_.others) part.rays = static_cast<double>(r_.rays.completed);
    for (std::optional<report::EnergyOf>& part : parts_.declared)
      if (part) part->rays = static_cast<double>(r_.rays.completed);
    return parts_;
  }

 private:
  double pj(Cost of) const { return costs_.of(of); }
  void access(EnergyPart part, double bytes, double kib) {
    parts_[part].add(bytes / kWord, costs_.sram_access_pj(kib));
  }

  void tests() {
    if (!r_.tests) return;
    for (const UnitKindRow& row : kUnitKinds)
      parts_.units[row.kind].add(static_cast<double>(r_.tests->counts.*row.tests), pj(energy_of(row.kind)));
    std::uint64_t reads = r_.tests->ray_reads;
    for (const report::Resource& resource : *r_.resources)
      reads += resource.units ? resource.units->second_reads.value_or(0) : 0;
    access(EnergyPart::kRayStore, kRecordBytes * static_cast<double>(reads), rays_kib_);
    if (!r_.nearest) return;
    const NearestCounts& hits = r_.nearest->counts;
    access(EnergyPart::kRayStore, static_cast<double>(hits.read_bytes + hits.written_bytes + hits.waiting_bytes),
           rays_kib_);
  }

  void stores() {
    if (r_.packets)
      access(EnergyPart::kCollections, 2 * kIdBytes * static_cast<double>(r_.packets->counts.packet_rays),
             kIdBytes * mean([](const OwnSections& one) { return one.collections.capacity; }) / 1024);
    const ShapeBufferCounts& buffers = r_.memory->shape_buffers.counts;
    access(EnergyPart::kShapeBuffers, kPlaceBytes * static_cast<double>(buffers.hits + buffers.merged + buffers.misses),
           buffer_kib());
    for (const report::Resource& resource : *r_.resources)
      if (resource.stack)
        access(EnergyPart::kStacks, static_cast<double>(resource.stack->pushed_bytes + resource.stack->popped_bytes),
               resource.units && resource.units->warps ? register_kib(c_, static_cast<std::int64_t>(resource.resource))
                                                       : rays_kib_);
    for (const report::Resource& resource : *r_.resources)
      if (resource.units && resource.units->warps)  // out of one lane and into another
        access(EnergyPart::kStacks, 2 * static_cast<double>(resource.units->warps->counts.packed_bytes),
               register_kib(c_, static_cast<std::int64_t>(resource.resource)));
    for (const report::Cache& cache : r_.memory->caches)
      access(EnergyPart::kL2,
             line_bytes() * static_cast<double>(cache.counts.lines) +
                 kWord * static_cast<double>(cache.ahead ? cache.ahead->asked : 0),
             l2_kib());
    if (r_.memory->own_caches)
      access(EnergyPart::kL1, line_bytes() * static_cast<double>(r_.memory->own_caches->counts.lines), l1_kib());
    Parts::for_each([&]<class P>(std::size_t i) {
      if (!r_.parts.of<P>()) return;
      const PartEnergy energy = P::energy(*r_.parts.of<P>(), c_.parts.of<P>(), costs_);
      parts_.declared[i].emplace().add(energy.events, energy.pj_each);
    });
  }

  void packets() {
    const ringbus::Topology topology(c_.topology);
    const std::vector<config::Graph::Link> others = drawn_.without_packets();  // behind those of packets
    const std::vector<double> of_ring = ringbus::stop_ring_lengths(c_.topology, link_mm_);
    for (std::size_t i = 0; i < r_.links->size(); ++i) {
      const auto bytes = static_cast<double>((*r_.links)[i].bytes.value_or(0));
      const std::size_t wires = topology.wires().size();
      const double mm = i < wires          ? wire_length(topology, topology.wires()[i], link_mm_)
                        : !of_ring.empty() ? of_ring.at(i - wires)
                                           : drawn_.length(others.at(i - wires), link_mm_);
      parts_[EnergyPart::kPorts].add(bytes, pj(Cost::kHop));
      parts_[EnergyPart::kWires].add(bytes * mm, pj(Cost::kWire));
    }
  }

  /// Shared parts stand in the middle of the square of the resources that share them: the way is half of its side.
  void message(const ByteRow& row) {
    const auto bytes = static_cast<double>(row.bytes);
    if (row.over == "links") return;
    if (row.from == "DRAM" || row.to == "DRAM") {
      if (row.from == "L2" && row.over == "address wires") return;  // contained in the bytes of the lines
      if (row.to == "L2") access(EnergyPart::kL2, memory_times_ * bytes, l2_kib());
      const bool hbm = c_.memory.dram.preset == DramConfig::Preset::kHbm2;
      parts_[EnergyPart::kDram].add(memory_times_ * bytes, pj(hbm ? Cost::kHbm : Cost::kDram));
      return;
    }
    if (!travels_over_links(row)) {
      parts_[EnergyPart::kMessages].add(bytes, pj(Cost::kHop));
      parts_[EnergyPart::kMessageWires].add(bytes * link_mm_ * std::sqrt(static_cast<double>(sharing(row))) / 2,
                                            pj(Cost::kWire));
    }
    if (row.what == "new rays" || row.what == "completed rays") access(EnergyPart::kRayStore, bytes, rays_kib_);
    if (row.from == "L2" && row.to == "L1") access(EnergyPart::kL1, bytes, l1_kib());
    if (row.what == "shape data") access(EnergyPart::kShapeBuffers, bytes, buffer_kib());
  }

  /// The resources that share the parts between which the messages go. Parts that declare themselves are beside the
  /// L2s.
  std::int64_t sharing(const ByteRow& row) const {
    const auto is = [&](std::string_view name) { return row.from == name || row.to == name; };
    bool at_l2 = is("L2");
    Parts::for_each([&]<class P>(std::size_t) { at_l2 |= is(P::kName); });
    if (at_l2) return std::min(c_.memory.shared_by, c_.topology.resources);
    return is("L1") ? 1 : c_.topology.resources;
  }

  /// The rows of links count what is drawn.
  bool travels_over_links(const ByteRow& row) const {
    if (row.what == "new rays") return drawn_.parts.new_rays;
    if (row.what == "completed rays") return drawn_.parts.completed_rays;
    return !drawn_.parts.caches.empty() && (row.from == "L2" || row.to == "L2");
  }

  void shading() {
    parts_[EnergyPart::kShades].add(static_cast<double>(r_.shading.shaded), pj(Cost::kShade));
    parts_[EnergyPart::kProducts].add(static_cast<double>(r_.shading.products.value_or(0)), pj(Cost::kProduct));
    parts_[EnergyPart::kLookups].add(static_cast<double>(r_.shading.lookups.value_or(0)), pj(Cost::kLookup));
    if (!r_.memory->dram) return;
    const bool hbm = c_.memory.dram.preset == DramConfig::Preset::kHbm2;
    for (const report::DramChannel& channel : r_.memory->dram->channels)
      parts_[EnergyPart::kActivations].add(
          memory_times_ * static_cast<double>(channel.counts.row_misses + channel.counts.row_conflicts),
          pj(hbm ? Cost::kHbmActivation : Cost::kDramActivation));
  }

  double l2_kib() const { return static_cast<double>(c_.memory.l2_kib) / static_cast<double>(c_.memory.l2_banks); }
  double l1_kib() const {
    return mean([](const OwnSections& one) { return one.memory.l1_kib; });
  }
  double line_bytes() const { return static_cast<double>(c_.memory.line_bytes); }
  double buffer_kib() const {
    return mean([](const OwnSections& one) { return one.memory.shape_buffer_kib; });
  }
  /// The mean of all resources, as the report counts their accesses together.
  template <class Of>
  double mean(const Of& of) const {
    return static_cast<double>(sum_of_resources(c_, of)) / static_cast<double>(c_.topology.resources);
  }

  const report::Report& r_;
  const Config& c_;
  ringbus::ParcelPlan drawn_ = ringbus::plan_parcels(c_.topology, c_.memory.line_bytes);
  double link_mm_;
  Costs costs_;
  double memory_times_, rays_kib_;
  report::EnergyParts parts_;
};

std::vector<report::CostConstant> constants(const Config& config) {
  static constexpr std::string_view kBases[] = {"published", "derived", "assumed"};
  std::vector<report::CostConstant> out;
  for (const CostRow& row : kCostTable) {
    const CostValue value = cost_value(config, row.cost);
    const bool given = value.source == "the configuration";
    out.push_back({std::string(row.section) + "." + std::string(row.key), row.unit,
                   std::string(given ? "given" : kBases[static_cast<std::size_t>(value.basis)]),
                   std::string(value.source), shortest(value.value)});
  }
  return out;
}

double joules_of(const report::EnergyParts& parts) {
  double joules = 0;
  for (const auto [kind, part] : parts.units) joules += part.joules;
  for (const report::EnergyOf& part : parts.others) joules += part.joules;
  for (const std::optional<report::EnergyOf>& part : parts.declared) joules += part ? part->joules : 0;
  return joules;
}

}  // namespace

void add_sampled_energy(report::Report& r, const Config& config) {
  if (!r.sampled || !r.energy) return;
  report::Sampled& s = *r.sampled;
  double moved = 0;
  for (const ByteRow& row : *r.bytes)
    if (row.what == "lines" || row.what == "written lines") moved += static_cast<double>(row.bytes);
  const double rays = static_cast<double>(r.rays.completed), link_mm = r.area->link_mm;
  const auto with = [&](double bytes_per_ray) {
    const double times = moved > 0 ? bytes_per_ray * rays / moved : 1;
    return ratio(joules_of(Account(r, config, link_mm, times).take()), rays) * 1e9;
  };
  const auto unsure = [](const report::SampledValue& v) { return ratio(v.high - v.low, 2 * v.estimate); };
  const double error =
      with(0) * std::max({unsure(s.box_tests_per_ray), unsure(s.triangle_tests_per_ray), unsure(s.link_bytes_per_ray)});
  const report::SampledValue& bytes = s.memory_bytes_per_ray;
  report::SampledEnergy& energy = s.nj_per_ray.emplace();
  energy.estimate = with(bytes.estimate);
  energy.low = std::max(0.0, with(bytes.low) - error);
  energy.high = with(bytes.high) + error;
}

void add_energy(report::Report& r, const Config& config, const SceneFacts& scene) {
  if (config.energy.profile == CostProfile::kNone || !r.engine.cycles || !r.bytes || !r.memory || !r.resources) return;
  report::Area area = machine_area(config, scene);
  report::Energy& energy = r.energy.emplace();
  energy.profile = enum_name(config.energy.profile);
  energy.parts = Account(r, config, area.link_mm).take();
  energy.joules = joules_of(energy.parts);
  const double rays = static_cast<double>(r.rays.completed);
  const double seconds = static_cast<double>(*r.engine.cycles) / (static_cast<double>(config.engine.clock_mhz) * 1e6);
  energy.nj_per_ray = ratio(energy.joules, rays) * 1e9;
  energy.watts = ratio(energy.joules, seconds);
  energy.rays_per_joule = ratio(rays, energy.joules);
  area.mrays_per_second_per_mm2 = ratio(ratio(rays, seconds) * 1e-6, area.mm2);
  r.area = std::move(area);
  r.costs = constants(config);
}

}  // namespace carousel::app
