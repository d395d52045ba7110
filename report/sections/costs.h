#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/parts.h"
#include "core/types/unit_kind.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// The parts of a run's energy besides the test units, which have a part for each kind.
enum class EnergyPart : std::uint8_t {
  kRayStore,
  kCollections,
  kShapeBuffers,
  kStacks,
  kL1,
  kL2,
  kPorts,
  kWires,
  kMessages,
  kMessageWires,
  kDram,
  kActivations,
  kShades,
  kProducts,
  kLookups
};

struct EnergyPartRow {
  const char *key, *meaning;
};

inline constexpr auto kEnergyParts = std::to_array<EnergyPartRow>({
    {"ray_store",
     "accesses of 64 bits to the ray store: 8 for a record read, and the bytes of new and completed rays and of their "
     "buffers of hits"},
    {"collections", "accesses of 64 bits to the collections: each of 4 bytes an ID is written and read once"},
    {"shape_buffers",
     "accesses of 64 bits to the shape buffers: the shape data that comes, and 64 bytes whenever a "
     "strip or transform is needed"},
    {"stacks", "accesses of 64 bits to the stacks of rays"},
    {"l1",
     "accesses of 64 bits to the resources' own caches: lines looked up, and lines that come from the L2; absent "
     "without them"},
    {"l2",
     "accesses of 64 bits to the L2: lines looked up, lines that come from memory, and one for each line that a part "
     "asks "
     "for ahead"},
    {"ports", "bytes of packets through the ports of links"},
    {"wires", "bytes of packets times the millimetres of their links"},
    {"messages", "bytes between resources, L2, ray control and shading, through ports"},
    {"message_wires", "bytes of these messages times the millimetres of their way"},
    {"dram", "bytes from and to memory"},
    {"dram_activations", "activations of rows, with memory.dram.preset"},
    {"shades", "rays shaded"},
    {"products", "products of the surfaces' effects"},
    {"lookups", "filtered texture lookups"},
});

struct EnergyOf {
  double events = 0, joules = 0, rays = 0;
  void add(double more, double pj_each) {
    events += more;
    add_work(more, pj_each);
  }
  /// Joules of work within events that are counted already.
  void add_work(double times, double pj_each) { joules += times * pj_each * 1e-12; }
};

template <class V>
void describe(V& v, const EnergyOf& r) {
  v.field("events", r.events, "events", "events that cost energy");
  v.field("pj_each", ratio(r.joules, r.events) * 1e12, "pJ", "energy of an event, in the mean");
  v.field("joules", r.joules, "J", "energy of the run");
  v.field("nj_per_ray", ratio(r.joules, r.rays) * 1e9, "nJ/ray", "energy for each completed ray");
}

struct EnergyParts {
  PerUnit<EnergyOf> units{};
  std::array<EnergyOf, kEnergyParts.size()> others{};
  PerPart<Parts, EnergyOf> declared{};  ///< of parts that declare themselves
  EnergyOf& operator[](EnergyPart part) { return others[static_cast<std::size_t>(part)]; }
  /// Calls `body(key, energy)` with each part, in the order of the report.
  template <class Body>
  void for_each(const Body& body) const {
    for (const UnitKindRow& row : kUnitKinds) body(row.work, units[row.kind]);
    for (std::size_t i = 0; i < kEnergyParts.size(); ++i) body(kEnergyParts[i].key, others[i]);
    Parts::for_each([&]<class P>(std::size_t i) { body(P::kSection, declared[i].value_or(EnergyOf{})); });
  }
  static constexpr std::size_t kParts = kUnitKinds.size() + kEnergyParts.size() + Parts::kSize;
  /// So many rays are completed.
  void share_among(double completed) {
    for (const auto [kind, part] : units) part.rays = completed;
    for (EnergyOf& part : others) part.rays = completed;
    for (std::optional<EnergyOf>& part : declared)
      if (part) part->rays = completed;
  }
};

template <class V>
void describe(V& v, const EnergyParts& r) {
  for (const UnitKindRow& row : kUnitKinds)
    if (row.kind == UnitKind::kMicromap)  // older reports have none
      v.section_if(r.units[row.kind].events > 0, row.work, r.units[row.kind], row.meaning);
    else if (row.kind == UnitKind::kReciprocal)  // likewise; and rays divide where there are no such units
      v.section_if(r.units[row.kind].events > 0, row.work, r.units[row.kind],
                   "divisions for bundles (tests.reciprocals), and three for the direction of each ray that is made or "
                   "brought to model space");
    else
      v.section(row.work, r.units[row.kind], row.meaning);
  constexpr auto kOwnCaches = static_cast<std::size_t>(EnergyPart::kL1);
  for (std::size_t i = 0; i < kEnergyParts.size(); ++i)
    if (i == kOwnCaches)
      v.section_if(r.others[i].events > 0, kEnergyParts[i].key, r.others[i], kEnergyParts[i].meaning);
    else
      v.section(kEnergyParts[i].key, r.others[i], kEnergyParts[i].meaning);
  Parts::for_each([&]<class P>(std::size_t i) { v.section(P::kSection, r.declared[i], P::kEnergyMeaning); });
}

/// The thousand cycles with the most energy.
struct PowerPeak {
  std::uint64_t first_cycle = 0, cycles = 0, resolution = 0;
  double watts = 0, watts_at_most = 0;
  std::string part;
  double part_share = 0;
};

template <class V>
void describe(V& v, const PowerPeak& r) {
  v.field("first_cycle", r.first_cycle, "cycles", "cycle in which they begin");
  v.field("cycles", r.cycles, "cycles", "their number");
  v.field("resolution", r.resolution, "cycles", "they begin at a multiple of this; no other beginning was tried");
  v.field("watts", r.watts, "W", "mean power in these cycles at engine.clock_mhz");
  v.field("watts_at_most", r.watts_at_most, "W",
          "bound for so many cycles that begin anywhere: the most energy of these and one resolution more");
  v.field("part", r.part, "", "part with most of their energy, as in parts");
  v.field("part_share", r.part_share, "fraction", "its share of their energy");
}

struct Energy {
  std::string profile;
  double joules = 0, nj_per_ray = 0, watts = 0, rays_per_joule = 0;
  std::optional<PowerPeak> peak{};
  EnergyParts parts{};
};

template <class V>
void describe(V& v, const Energy& r) {
  v.field("profile", r.profile, "", "process, whose numbers stand in costs");
  v.field("joules", r.joules, "J", "energy of the events of the run: the sum of the parts, without leakage and clocks");
  v.field("nj_per_ray", r.nj_per_ray, "nJ/ray", "energy for each completed ray");
  v.field("watts", r.watts, "W", "mean power at engine.clock_mhz");
  v.field("rays_per_joule", r.rays_per_joule, "rays/J", "completed rays over energy: throughput per watt");
  v.section("peak", r.peak,
            "the thousand cycles with the most energy; absent if the run has fewer. An event is in the cycle in which "
            "its part decides on it: a packet's tests when the first begins, a message when it is sent");
  v.section("parts", r.parts, "each part's energy; they add up to the whole");
}

enum class AreaPart : std::uint8_t {
  kUnits,
  kRayStores,
  kCollections,
  kStacks,
  kShapeBuffers,
  kL1,
  kL2,
  kLinkQueues,
  kWires,
  kShaders,
  kBuilder,
  kRaster,
  kMemoryPorts
};

struct AreaPartRow {
  const char *key, *name, *meaning;
};

inline constexpr auto kAreaParts = std::to_array<AreaPartRow>({
    {"test_units", "test units", "test units of all resources (units)"},
    {"ray_stores", "ray stores", "ray stores, of 64 bytes a slot and their buffers of hits (KiB)"},
    {"collections", "collections", "collections, of 4 bytes a ray ID (KiB)"},
    {"stacks", "stacks", "stacks of rays, of 64 bytes a slot, with topology.shape: independent (KiB)"},
    {"shape_buffers", "shape buffers", "shape buffers (KiB)"},
    {"l1", "L1", "caches of the resources (KiB)"},
    {"l2", "L2", "shared caches (KiB)"},
    {"link_queues", "link queues",
     "queues of links, of packets.rays IDs a packet, for a box each with packets.results: per_shape, and with message "
     "a "
     "message for each ray and box (KiB)"},
    {"wires", "wires", "wires of links, a bit wide, side by side (mm)"},
    {"shaders", "shaders", "shader workers (products/cycle)"},
    {"builder", "builder",
     "the unit that brings the structure to each frame: its box pipeline, its store and its lines on their way (KiB)"},
    {"raster_unit", "raster unit",
     "the unit that rasterises first hits: a triangle test for each triangle of a cycle, a box test for each sample, "
     "and its lines on their way (KiB)"},
    {"memory_ports", "memory ports",
     "ports of shared caches: wires for the lines that they answer in a cycle, over half of the side of the square of "
     "the resources that share one (mm)"},
});

struct AreaOf {
  double size = 0, mm2 = 0;
};

template <class V>
void describe(V& v, const AreaOf& r) {
  v.field("size", r.size, "units of the part", "units, bits, KiB or millimetres, as the part is counted");
  v.field("mm2", r.mm2, "mm2", "area");
}

struct AreaParts {
  std::array<AreaOf, kAreaParts.size()> of{};
  PerPart<Parts, AreaOf> declared{};  ///< of parts that declare themselves
  AreaOf& operator[](AreaPart part) { return of[static_cast<std::size_t>(part)]; }
  double mm2() const {
    double sum = 0;
    for (const AreaOf& part : of) sum += part.mm2;
    for (const std::optional<AreaOf>& part : declared) sum += part ? part->mm2 : 0;
    return sum;
  }
};

template <class V>
void describe(V& v, const AreaParts& r) {
  constexpr auto kNewer = static_cast<std::size_t>(AreaPart::kRaster);  // older reports have none of these
  for (std::size_t i = 0; i < kAreaParts.size(); ++i)
    v.section_if(i < kNewer || r.of[i].mm2 > 0, kAreaParts[i].key, r.of[i], kAreaParts[i].meaning);
  Parts::for_each([&]<class P>(std::size_t i) { v.section(P::kSection, r.declared[i], P::kAreaMeaning); });
}

/// A split of the budget that was simulated.
struct AreaTrial {
  std::uint64_t resources = 0, testers = 0, l2_kib = 0, l2_lines_per_cycle = 0, shader_workers = 0;
  double mm2 = 0, cycles = 0, nj_per_ray = 0;
  std::optional<double> frame_cycles{}, frame_nj_per_ray{};
  bool chosen = false;
};

template <class V>
void describe(V& v, const AreaTrial& r) {
  v.field("resources", r.resources, "resources", "resources: as many as the rest of the budget holds");
  v.field("testers", r.testers, "units", "test units of a resource that the scene puts to use");
  v.field("l2_kib", r.l2_kib, "KiB", "size of a shared cache");
  v.field("l2_lines_per_cycle", r.l2_lines_per_cycle, "lines/cycle", "ports of a bank of a shared cache");
  v.field("shader_workers", r.shader_workers, "workers", "shader workers");
  v.field("mm2", r.mm2, "mm2", "area of the machine");
  v.field("cycles", r.cycles, "cycles", "foretold cycles of the frame: of a whole frame exact, else estimated");
  v.field("nj_per_ray", r.nj_per_ray, "nJ/ray", "foretold energy for each completed ray, likewise");
  v.field("frame_cycles", r.frame_cycles, "cycles",
          "of sampled trials the two best ones: cycles of the frame as the run has it");
  v.field("frame_nj_per_ray", r.frame_nj_per_ray, "nJ/ray", "likewise energy for each completed ray");
  v.field("chosen", r.chosen, "", "true for the split that the machine has: the one with the least of the aim");
}

/// The search for the best split of a budget, with area.fit: best.
struct AreaSearch {
  double budget_mm2 = 0, fraction = 1;
  std::string aim, ended;
  std::vector<AreaTrial> trials{};

  const AreaTrial* chosen() const {
    for (const AreaTrial& trial : trials)
      if (trial.chosen) return &trial;
    return nullptr;
  }
  bool for_joules() const { return aim == "joules"; }
  double cost(const AreaTrial& trial) const { return for_joules() ? trial.nj_per_ray : trial.cycles; }
  /// The first split's cost over that of the chosen one.
  double gain() const { return ratio(cost(trials.front()), cost(*chosen())); }
};

template <class V>
void describe(V& v, const AreaSearch& r) {
  v.field("budget_mm2", r.budget_mm2, "mm2", "area that was split");
  v.field("aim", r.aim, "", "what the best split has least of: area.aim");
  v.field("fraction", r.fraction, "fraction", "part of the frame that each trial simulated");
  v.field("ended", r.ended, "", "reason for the end of the search");
  v.section("trials", r.trials, "every split that was simulated, in order");
}

struct Area {
  double mm2 = 0, link_mm = 0;
  std::optional<double> mrays_per_second_per_mm2{};
  AreaParts parts{};
  std::optional<AreaSearch> search{};
};

template <class V>
void describe(V& v, const Area& r) {
  v.field("mm2", r.mm2, "mm2", "area of the machine: the sum of the parts, without the memory and its pins");
  v.field("link_mm", r.link_mm, "mm", "length of a link between neighbours");
  v.field("mrays_per_second_per_mm2", r.mrays_per_second_per_mm2, "Mrays/s/mm2",
          "throughput at engine.clock_mhz over the area");
  v.section("parts", r.parts, "each part's area; they add up to the whole");
  v.section("search", r.search, "the search for the best split of area.budget_mm2, with area.fit: best");
}

/// A number of the table of costs, as the run had it.
struct CostConstant {
  std::string key, unit, basis, source;
  double value = 0;
};

template <class V>
void describe(V& v, const CostConstant& r) {
  v.field("key", r.key, "", "key of the configuration that sets it");
  v.field("value", r.value, "unit of the row", "value");
  v.field("unit", r.unit, "", "unit of the value");
  v.field("basis", r.basis, "", "published, derived from published numbers, assumed, or given");
  v.field("source", r.source, "", "source of the value, and the rule that derives it");
}

}  // namespace carousel::report
