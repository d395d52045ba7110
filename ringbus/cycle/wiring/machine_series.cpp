#include "ringbus/cycle/wiring/machine_series.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ringbus/cycle/tile/resource_samples.h"
#include "ringbus/topology/graph_facts.h"

namespace carousel::ringbus::cycle {

namespace {

using Kind = SeriesRow::Kind;

/// Turns readings into rows.
class SeriesWriter {
 public:
  explicit SeriesWriter(const SimulatedMachine& machine) : machine_(machine) {
    Cycle end = 1;
    const auto look = [&](const CounterSamples& samples) {
      interval_ = std::max(interval_, samples.interval());
      end = std::max(end, samples.end());
    };
    for (const auto& pool : machine.shading().pools()) look(pool->samples());
    for (const auto& memory : machine.memory().memories()) look(memory->samples());
    for (const auto& resource : machine.resources()) look(resource->samples());
    for (const auto& hub : machine.network().hubs()) look(hub->samples());
    for (std::size_t i = 0; machine.parcels() != nullptr && i < machine.parcels()->plan().links.size(); ++i)
      look(machine.parcels()->time_of(i).samples());
    out_.unit = "cycles";
    out_.interval = static_cast<double>(interval_);
    out_.samples = ceil_div(end, interval_);
  }

  TimeSeries write() {
    read_links();
    machine_rows();
    for (std::size_t p = 0; machine_.shading().pools().size() > 1 && p < machine_.shading().pools().size(); ++p)
      pool_rows(p);
    for (std::size_t r = 0; r < machine_.resources().size(); ++r) resource_rows(r);
    for (std::size_t link = 0; link < links_.size(); ++link) {
      const std::string part = fmt::format("link {}", link);
      row({part, "busy", "share", Kind::kMean}, links_[link].busy);
      row({part, "bytes", "bytes", Kind::kSum}, links_[link].bytes);
    }
    return std::move(out_);
  }

 private:
  using Sums = std::vector<std::uint64_t>;
  struct LinkSums {
    Sums busy, bytes;
  };

  void machine_rows() {
    const std::size_t resources = machine_.resources().size();
    std::size_t testing = resources;  // without packet processes that serve resources, which have no units
    for (std::uint32_t r = 0; const std::uint32_t manager : machine_.shared().topology.manager_of())
      testing -= manager == r++;
    const auto shading = [&](ShadingCounter counter) { return of_shading(counter_index(counter)); };
    const auto all = [&](std::size_t counter) {
      Sums sums = zeros();
      for (const auto& resource : machine_.resources()) resource->samples().add_to(sums, interval_, counter);
      return sums;
    };
    row({"machine", "rays completed", "rays", Kind::kSum}, shading(ShadingCounter::kCompleted));
    Sums held = zeros();
    for (std::size_t r = 0; r < resources; ++r)
      for (const auto& pool : machine_.shading().pools())
        pool->samples().add_to(held, interval_, kFirstHeldCounter + r);
    for (const auto& resource : machine_.resources())
      resource->samples().add_to(held, interval_, counter_index(ResourceCounter::kHeld));
    row({"machine", "rays held", "rays", Kind::kMean}, held);
    row({"machine", "ray IDs in collections", "entries", Kind::kMean}, all(counter_index(ResourceCounter::kIds)));
    row({"machine", "open collections", "entries", Kind::kMean}, all(counter_index(ResourceCounter::kCollections)));
    row({"machine", "packets under way", "packets", Kind::kMean}, all(counter_index(ResourceCounter::kPackets)));
    row({"machine", "rays waiting to be shaded", "rays", Kind::kMean}, shading(ShadingCounter::kWaiting));
    row({"machine", "shader workers busy", "workers", Kind::kMean}, shading(ShadingCounter::kWorkers));
    for (const UnitKindRow& unit : kUnitKinds)
      row({"machine", fmt::format("{} busy", unit.name), "share", Kind::kMean}, all(unit_index(unit.kind)), testing);
    row({"machine", "dispatch busy", "share", Kind::kMean}, all(counter_index(ResourceCounter::kDispatch)), resources);
    Sums busy = zeros(), bytes = zeros();
    for (const LinkSums& link : links_)
      for (std::size_t i = 0; i < busy.size(); ++i) {
        busy[i] += link.busy[i];
        bytes[i] += link.bytes[i];
      }
    row({"machine", "links busy", "share", Kind::kMean}, busy, std::max<std::size_t>(1, links_.size()));
    row({"machine", "bytes on links", "bytes", Kind::kSum}, bytes);
    Sums dram = zeros();
    for (const auto& memory : machine_.memory().memories()) memory->samples().add_to(dram, interval_, 0);
    row({"machine", "bytes of DRAM", "bytes", Kind::kSum}, dram);
    const double width = machine_.memory().peak_bytes_per_cycle();
    row({"machine", "DRAM busy", "share", Kind::kMean}, dram, width);
  }

  void pool_rows(std::size_t p) {
    const std::string part = fmt::format("pool {}", p);
    const auto own = [&](ShadingCounter counter) {
      Sums sums = zeros();
      machine_.shading().pools()[p]->samples().add_to(sums, interval_, counter_index(counter));
      return sums;
    };
    row({part, "rays completed", "rays", Kind::kSum}, own(ShadingCounter::kCompleted));
    row({part, "rays waiting to be shaded", "rays", Kind::kMean}, own(ShadingCounter::kWaiting));
    row({part, "shader workers busy", "workers", Kind::kMean}, own(ShadingCounter::kWorkers));
  }

  void resource_rows(std::size_t r) {
    const CounterSamples& samples = machine_.resources()[r]->samples();
    const std::string part = fmt::format("resource {}", r);
    const auto own = [&](std::size_t counter) {
      Sums sums = zeros();
      samples.add_to(sums, interval_, counter);
      return sums;
    };
    row({part, "rays completed", "rays", Kind::kSum}, own(counter_index(ResourceCounter::kCompleted)));
    row({part, "rays tested", "rays", Kind::kSum}, own(counter_index(ResourceCounter::kTested)));
    // Ray control counts them where it gives out the slots, and otherwise the resource does.
    Sums held = of_shading(kFirstHeldCounter + r);
    samples.add_to(held, interval_, counter_index(ResourceCounter::kHeld));
    row({part, "rays held", "rays", Kind::kMean}, held);
    row({part, "ray IDs in collections", "entries", Kind::kMean}, own(counter_index(ResourceCounter::kIds)));
    row({part, "open collections", "entries", Kind::kMean}, own(counter_index(ResourceCounter::kCollections)));
    row({part, "packets under way", "packets", Kind::kMean}, own(counter_index(ResourceCounter::kPackets)));
    for (const UnitKindRow& unit : kUnitKinds)
      row({part, fmt::format("{} busy", unit.name), "share", Kind::kMean}, own(unit_index(unit.kind)));
    row({part, "ray reads busy", "share", Kind::kMean}, own(counter_index(ResourceCounter::kRayReads)));
    row({part, "primitive ray reads busy", "share", Kind::kMean}, own(counter_index(ResourceCounter::kPrimitiveReads)));
    row({part, "dispatch busy", "share", Kind::kMean}, own(counter_index(ResourceCounter::kDispatch)));
  }

  Sums zeros() const { return Sums(out_.samples); }
  Sums of_shading(std::size_t counter) const {
    Sums sums = zeros();
    for (const auto& pool : machine_.shading().pools()) pool->samples().add_to(sums, interval_, counter);
    return sums;
  }
  void add_port(Sums& sums, const Topology::Wire& wire, std::size_t port, PortCounter counter) const {
    const std::size_t resources = machine_.resources().size();
    if (wire.from.value < resources)
      machine_.resources()[wire.from.value]->samples().add_to(sums, interval_,
                                                              counter_index(counter, port, kFirstPortCounter));
    else
      machine_.network().hubs()[wire.from.value - resources]->samples().add_to(sums, interval_,
                                                                               counter_index(counter, port, 0));
  }
  /// The links in the order of the report: those of packets, which others may share, and then those of others alone.
  void read_links() {
    machine_.for_each_link([&](const Topology::Wire& wire, std::size_t port) {
      LinkSums& link = links_.emplace_back(LinkSums{zeros(), zeros()});
      add_port(link.busy, wire, port, PortCounter::kBusy);
      add_port(link.bytes, wire, port, PortCounter::kBytes);
    });
    if (machine_.parcels() == nullptr) return;
    const ParcelPlan& plan = machine_.parcels()->plan();
    for (std::size_t i = 0; i < plan.links.size(); ++i) {
      const bool alone = plan.links[i].wire == ParcelPlan::kNone;
      LinkSums& link = alone ? links_.emplace_back(LinkSums{zeros(), zeros()}) : links_[plan.links[i].wire];
      link.busy = zeros();  // of a link that is shared, its time has all
      const CounterSamples& samples = machine_.parcels()->time_of(i).samples();
      samples.add_to(link.busy, interval_, static_cast<std::size_t>(LinkTime::Counter::kBusy));
      samples.add_to(link.bytes, interval_, static_cast<std::size_t>(LinkTime::Counter::kBytes));
    }
  }
  /// `parts`: equal parts side by side, whose mean is taken.
  void row(SeriesRow&& row, const Sums& sums, double parts = 1) {
    const double by = row.kind == Kind::kMean ? parts * out_.interval : 1;
    for (const std::uint64_t sum : sums) row.values.push_back(static_cast<double>(sum) / by);
    out_.add(std::move(row));
  }
  void row(SeriesRow&& one, const Sums& sums, std::size_t parts) {
    row(std::move(one), sums, static_cast<double>(parts));
  }

  const SimulatedMachine& machine_;
  Cycle interval_ = 1;
  std::vector<LinkSums> links_;
  TimeSeries out_;
};

}  // namespace

std::size_t series_counters(const TopologyConfig& config) {
  const Topology topology(config);
  const std::size_t links = config.shape == TopologyShape::kGraph ? draw_whole(config).links.size() : 0;
  return topology.resources() * (kFirstPortCounter + 1) +
         std::max(topology.wires().size(), links) * static_cast<std::size_t>(PortCounter::kEnd) + 64;
}

TimeSeries machine_series(const SimulatedMachine& machine) {
  return SeriesWriter(machine).write();
}

}  // namespace carousel::ringbus::cycle
