#include "core/config/load/memory_rules.h"

#include <numeric>
#include <string_view>

#include <fmt/format.h>

namespace carousel::config {

namespace {

class MemoryRules {
 public:
  MemoryRules(const Config& config, const RuleBreach& breach) : c(config), breach_(breach) {}

  void check() {
    if (c.workload.kind == WorkloadConfig::Kind::kMemoryTrace && !cycle())
      breach_("engine.kind", "workload: memory_trace runs in virtual time; expected cycle, found native");
    quantised_nodes_fit();
    leaves_fit();
    blocks_fit();
    builder_fits();
    quality_fits();
    shared_caches_fit();
    travelling_rays_fit();
    micromaps_fit();
    caches_have_whole_sets();
    master_copies_fit();
    pages_are_whole();
    if (c.memory.dram.preset == DramConfig::Preset::kPipe) return;
    constexpr std::int64_t kTransaction = 32;  // bytes
    const auto whole = [&](const char* key, std::int64_t bytes) {
      if (bytes % kTransaction != 0)
        breach_(key,
                fmt::format("DRAM with banks moves 32 bytes at a time; expected a multiple of 32, found {}", bytes));
    };
    whole("memory.line_bytes", c.memory.line_bytes);
    if (c.memory.l2_sector_bytes) whole("memory.l2_sector_bytes", *c.memory.l2_sector_bytes);
    whole("memory.dram.interleave_bytes", c.memory.dram.interleave_bytes);
  }

 private:
  void pages_are_whole() {
    const std::int64_t page = c.memory.translation.page_bytes;
    constexpr std::int64_t kLeast = 4096;  // no line is longer
    if (page != 0 && (page < kLeast || (page & (page - 1)) != 0))
      breach_("memory.translation.page_bytes",
              fmt::format("expected 0, or a power of two from {}, found {}", kLeast, page));
    else if (page != 0 && page % c.memory.line_bytes != 0)
      breach_("memory.translation.page_bytes",
              fmt::format("expected whole lines of {} bytes, found {}", c.memory.line_bytes, page));
  }

  // A quantised node holds boxes of its children and references, and is decoded as a whole.
  void quantised_nodes_fit() {
    if (!is_quantised(c.bvh.storage)) return;
    constexpr std::string_view without = ", or bvh.storage: full";
    if (c.bvh.elements != BvhConfig::Elements::kBoxes)
      breach_("bvh.elements", fmt::format("quantised nodes hold boxes; expected boxes{}; found {}", without,
                                          enum_name(c.bvh.elements)));
    if (c.bvh.mixed_triangles > 0)
      breach_("bvh.mixed_triangles",
              fmt::format("quantised nodes hold no triangles; expected 0{}; found {}", without, c.bvh.mixed_triangles));
    if (c.bvh.top_triangles > 0)
      breach_("bvh.top_triangles",
              fmt::format("quantised nodes hold no triangles; expected 0{}; found {}", without, c.bvh.top_triangles));
    if (c.packets.shapes == PacketShapes::kSingle)
      breach_("packets.shapes",
              fmt::format("a quantised node is decoded as a whole; expected strip{}; found single", without));
    if (c.accuracy.box != BoxLevel::kConservative)
      breach_("accuracy.box", fmt::format("larger boxes could add hits to those of {}; expected conservative{}",
                                          enum_name(c.accuracy.box), without));
  }

  // Micromaps stand behind their triangles, in leaves that are all here when they are made.
  void micromaps_fit() {
    if (c.bvh.micromaps.states == BvhConfig::Micromaps::States::kNone) return;
    constexpr std::string_view without = ", or bvh.micromaps.states: none";
    if (c.bvh.leaves != BvhConfig::Leaves::kTriangles)
      breach_("bvh.leaves", fmt::format("{0} of triangles have no room for micromaps; expected triangles{1}; found {0}",
                                        enum_name(c.bvh.leaves), without));
    if (c.bvh.treelets.bytes > 0)
      breach_("bvh.treelets.bytes",
              fmt::format("the tree is cut into treelets before there are micromaps; expected 0{}; found {}", without,
                          c.bvh.treelets.bytes));
    if (c.scene.placement != ScenePlacement::kReplicated)
      breach_("scene.placement",
              fmt::format("micromaps are not taken apart; expected replicated{}; found partitioned", without));
  }

  // A strip of triangles is decoded as a whole.
  void leaves_fit() {
    if (c.bvh.leaves != BvhConfig::Leaves::kStrips) return;
    if (c.packets.shapes == PacketShapes::kSingle)
      breach_("packets.shapes",
              "a strip of triangles is decoded as a whole; expected strip, or bvh.leaves: triangles; found single");
  }

  // A block is decoded as a whole, ahead of the units that test its triangles.
  void blocks_fit() {
    if (c.bvh.leaves != BvhConfig::Leaves::kBlocks) return;
    constexpr std::string_view without = ", or bvh.leaves: triangles";
    const auto refuse = [&](bool wrong, const char* key, const std::string& message) {
      if (wrong) breach_(key, message);
    };
    refuse(c.scene.quantise == 0, "scene.quantise",
           fmt::format("vertices that are on no grid are not compressed; expected 1 to 24{}; found 0", without));
    refuse(c.packets.shapes == PacketShapes::kSingle, "packets.shapes",
           fmt::format("a block of triangles is decoded as a whole; expected strip{}; found single", without));
    refuse(c.bvh.mixed_triangles > 0, "bvh.mixed_triangles",
           fmt::format("nodes hold no compressed triangles; expected 0{}; found {}", without, c.bvh.mixed_triangles));
    refuse(c.bvh.top_triangles > 0, "bvh.top_triangles",
           fmt::format("nodes hold no compressed triangles; expected 0{}; found {}", without, c.bvh.top_triangles));
    refuse(c.memory.strip_end == MemoryConfig::StripEnd::kFlag, "memory.strip_end",
           fmt::format("the length of a block is known; expected length{}; found flag", without));
    refuse(c.topology.form == CentralForm::kDistributor && is_central(c.topology), "topology.form",
           fmt::format("testers behind a distributor have no decoder; expected another form{}; found distributor",
                       without));
    refuse(c.scene.placement == ScenePlacement::kPartitioned, "scene.placement",
           fmt::format("blocks are not partitioned yet; expected replicated{}; found partitioned", without));
  }

  // Elements other than boxes, and cull planes, are fitted to whole primitives, and their margins to hits in the
  // primitives' own boxes.
  void builder_fits() {
    if (c.bvh.builder == BvhConfig::Builder::kSah) return;
    const std::string_view name = enum_name(c.bvh.builder);
    if (c.bvh.elements != BvhConfig::Elements::kBoxes)
      breach_("bvh.elements", fmt::format("bvh.builder: {} cuts boxes; expected boxes, or bvh.builder: sah; found {}",
                                          name, enum_name(c.bvh.elements)));
    if (c.cull_planes.count > 0)
      breach_("cull_planes.count", fmt::format("cull planes are fitted to whole triangles, and bvh.builder: {} cuts "
                                               "their boxes; expected 0, or bvh.builder: sah; found {}",
                                               name, c.cull_planes.count));
  }

  void quality_fits() {
    using enum BvhConfig::Builder;
    if (c.bvh.quality == BvhConfig::Quality::kHigh && (c.bvh.builder == kOctree || c.bvh.builder == kKd))
      breach_(
          "bvh.quality",
          fmt::format("the nodes of bvh.builder: {} stay where space is divided; expected fast, or bvh.builder: sah "
                      "or spatial; found high",
                      enum_name(c.bvh.builder)));
  }

  void master_copies_fit() {
    if (!cycle() || c.memory.ray_records != MemoryConfig::RayRecords::kMaster) return;
    if (c.faults.resource.kind == FaultsConfig::Resource::Kind::kStop)
      breach_(
          "memory.ray_records",
          "rays are not placed anew from master copies when a resource has stopped; expected resource, found master");
    if (c.rays.placement == Placement::kFirstTaker || c.rays.placement == Placement::kAddressed)
      breach_("memory.ray_records",
              fmt::format("a packet brings the records of rays that travel; expected resource, or "
                          "another rays.placement than {}; found master",
                          enum_name(c.rays.placement)));
  }

  void travelling_rays_fit() {
    if (!cycle() || (c.rays.placement != Placement::kFirstTaker && c.rays.placement != Placement::kAddressed)) return;
    if (!properties_of(c.topology).has_packets)
      breach_("rays.placement",
              fmt::format("independent resources have no packets in which rays could travel; expected "
                          "balanced or round_robin, found {}",
                          enum_name(c.rays.placement)));
    if (c.faults.resource.kind == FaultsConfig::Resource::Kind::kStop)
      breach_("rays.placement", fmt::format("the cycle engine does not place travelling rays anew when a resource has "
                                            "stopped; expected balanced or round_robin, found {}",
                                            enum_name(c.rays.placement)));
  }

  void shared_caches_fit() {
    if (c.memory.l2_ray_ways >= c.memory.ways)
      breach_("memory.l2_ray_ways", fmt::format("shapes need a way too; expected less than memory.ways = {}, found {}",
                                                c.memory.ways, c.memory.l2_ray_ways));
    if (c.memory.fetch != MemoryConfig::Fetch::kMulticast) return;
    if (c.packets.carry == PacketCarry::kData && cycle())
      breach_("memory.fetch",
              "a packet that carries its shapes' data gets them from its issuer; expected packet, found multicast");
    if (!properties_of(c.topology).has_packets)
      breach_("memory.fetch",
              "independent resources have no packets whose shapes others want; expected resource, found multicast");
    if (c.memory.l1_kib > 0)
      breach_("memory.l1_kib",
              fmt::format("a shared cache multicasts to shape buffers; expected 0, or memory.fetch: resource; found {}",
                          c.memory.l1_kib));
    if (c.memory.shared_by > 64)
      breach_("memory.shared_by",
              fmt::format("a request names up to 64 resources to multicast to; expected at most 64, or memory.fetch: "
                          "resource; found {}",
                          c.memory.shared_by));
  }

  void caches_have_whole_sets() {
    cache_has_whole_sets("l2_kib", c.memory.l2_kib, "ways", c.memory.ways, c.memory.l2_banks);
    if (c.memory.l1_kib > 0) cache_has_whole_sets("l1_kib", c.memory.l1_kib, "l1_ways", c.memory.l1_ways, 1);
    if (c.memory.l2_sector_bytes && c.memory.line_bytes % *c.memory.l2_sector_bytes != 0)
      breach_("memory.l2_sector_bytes", fmt::format("a line has whole sectors; expected a divisor of {}, found {}",
                                                    c.memory.line_bytes, *c.memory.l2_sector_bytes));
  }

  void cache_has_whole_sets(const char* size, std::int64_t kib, const char* set, std::int64_t ways,
                            std::int64_t banks) {
    const std::int64_t lines = kib * 1024 / c.memory.line_bytes;
    if (ways > lines) {
      breach_(fmt::format("memory.{}", set),
              fmt::format("a cache of {} KiB has {} lines of {} bytes, and a set is no larger than the cache; "
                          "expected at most {}, found {}",
                          kib, lines, c.memory.line_bytes, lines, ways));
      return;
    }
    // Sets that a cache does not have would be left out of it.
    const std::int64_t bytes = ways * c.memory.line_bytes * banks;
    const std::int64_t step = bytes / std::gcd(bytes, std::int64_t{1024});
    if (kib % step != 0)
      breach_(
          fmt::format("memory.{}", size),
          fmt::format("a cache has whole sets, of {} lines of {} bytes, as many in each bank; expected a multiple of "
                      "{}, found {}",
                      ways, c.memory.line_bytes, step, kib));
  }

  bool cycle() const { return c.engine.kind == EngineKind::kCycle; }

  const Config& c;
  const RuleBreach& breach_;
};

}  // namespace

void check_memory(const Config& config, const RuleBreach& breach) {
  MemoryRules(config, breach).check();
}

}  // namespace carousel::config
