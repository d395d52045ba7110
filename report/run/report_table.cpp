#include "report/run/report_table.h"

#include <algorithm>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "report/rays/ray_time_table.h"
#include "report/run/part_table.h"
#include "report/run/report_json.h"
#include "report/run/sampled_table.h"
#include "report/run/verdict_table.h"
#include "report/text/number_text.h"
#include "report/text/ratio.h"
#include "report/text/table_lines.h"

namespace carousel::report {
namespace {

// A table is read at a glance: more lines than these are left to the files.
constexpr std::size_t kRankLines = 8, kRankLinkLines = 12;

void rank_lines(Table& table, const std::vector<Rank>& ranks, std::vector<RankLink> links) {
  RankCounts all;
  for (const RankLink& link : links) all += link.sent;
  std::uint64_t peak = 0, structure = 0;
  for (const Rank& rank : ranks) {
    peak = std::max(peak, rank.memory.peak_memory_bytes);
    structure = std::max(structure, rank.memory.structure_bytes);
  }
  table.line("ranks", "{} ranks   {} messages   {} between them   {} memory at most, {} of it structure", ranks.size(),
             grouped(all.messages), bytes_text(all.bytes), bytes_text(peak), bytes_text(structure));
  for (std::size_t r = 0; r < std::min(kRankLines, ranks.size()); ++r)
    table.line("", "rank {}: resources {} to {}   {} threads   {} rays shaded   waited {:.1f} %", ranks[r].rank,
               ranks[r].first_resource, ranks[r].first_resource + ranks[r].resources - 1, ranks[r].threads,
               grouped(ranks[r].rays_shaded), 100 * ranks[r].waiting);
  // The links that carried most bytes are printed.
  std::stable_sort(links.begin(), links.end(),
                   [](const RankLink& a, const RankLink& b) { return a.sent.bytes > b.sent.bytes; });
  for (std::size_t i = 0; i < std::min(kRankLinkLines, links.size()); ++i)
    table.line("", "rank {} to {}: {} messages   {}   {:.1f} packets a message   held {:.1f} %   full {} times",
               links[i].from, links[i].to, grouped(links[i].sent.messages), bytes_text(links[i].sent.bytes),
               links[i].packets_per_message, 100 * links[i].held, grouped(links[i].full));
  if (ranks.size() > kRankLines || links.size() > kRankLinkLines)
    table.line("", "{} more ranks and {} more ways between ranks in report.json",
               ranks.size() - std::min(kRankLines, ranks.size()),
               links.size() - std::min(kRankLinkLines, links.size()));
}

/// Packet processes that serve resources have no rays and no units, but issue all packets.
void resource_lines(Table& table, const std::vector<Resource>& resources, const nlohmann::ordered_json& config) {
  const std::span all(resources);
  const std::span testing = all.first(resources_with_units(config, all.size()));
  const std::span issuing = testing.size() < all.size() ? all.subspan(testing.size()) : all;
  table.line("resources", "{:<18} {:>14} {:>14} {:>14}   max/mean", fmt::format("{} of them", testing.size()), "least",
             "mean", "most");
  spread_line(table, "rays", testing, [](const Resource& r) { return r.counts.rays_completed; });
  spread_line(table, "rays tested", testing, [](const Resource& r) { return r.counts.local_rays; });
  spread_line(table, "box tests", testing, [](const Resource& r) { return r.tests.box; });
  spread_line(table, "triangle tests", testing, [](const Resource& r) { return r.tests.triangle; });
  if (std::any_of(issuing.begin(), issuing.end(), [](const Resource& r) { return r.counts.packets_issued > 0; })) {
    spread_line(table, "packets issued", issuing, [](const Resource& r) { return r.counts.packets_issued; });
    spread_line(table, "packets seen", testing, [](const Resource& r) { return r.counts.visits; });
  }
  if (!resources.front().stalls) return;
  StallCounts stalls;
  for (const Resource& r : resources) stalls += *r.stalls;
  Items items;
  for (const Counter<StallCounts>& row : kCounters<StallCounts>) items.add(row.name, grouped(row.value(stalls)));
  items.lines(table, "stalls");
}

void link_line(Table& table, const std::vector<Link>& links) {
  std::uint64_t packets = 0, stalled = 0, occupancy = 0, depth = 0;
  double mean = 0;
  const Link* busiest = nullptr;
  for (const Link& link : links) {
    packets += link.packets;
    stalled += link.stalled;
    occupancy = std::max(occupancy, link.occupancy_max);
    depth = std::max(depth, link.depth);
    mean += link.occupancy_mean * static_cast<double>(link.packets);
    if (link.utilisation && (busiest == nullptr || *link.utilisation > *busiest->utilisation)) busiest = &link;
  }
  table.line("links", "{} of depth {}   {} packets   occupancy {:.1f} mean, {} most   {} {}", links.size(), depth,
             grouped(packets), ratio(mean, double(packets)), occupancy, grouped(stalled),
             links.front().cycles ? "cycles stalled" : "refused");
  if (busiest) table.line("", "busiest from {} to {}: {}", busiest->from, busiest->to, percent(*busiest->utilisation));
}

void ray_queue_lines(Table& table, const RayQueues& queues) {
  const auto line = [&](const char* name, const char* of, const char* pieces, const RayQueue& queue) {
    table.line(name, "{} through {} of {}   {} {} of {:.1f} rays   {:.1f} waiting, {} most   {} refused", of,
               queue.kind, queue.depth, grouped(queue.sent), pieces, queue.rays_at_once, queue.waiting_mean,
               queue.waiting_max, grouped(queue.refused));
  };
  line("queues", "completed rays", "batches", queues.completed);
  line("", "new rays", "groups", queues.created);
}

/// A line for each kind of message: its bytes, sender, receiver and width. Kinds that were not sent are left out.
void byte_lines(Table& table, const std::vector<ByteRow>& rows, std::uint64_t rays) {
  std::string_view name = "bytes";
  for (const ByteRow& row : rows) {
    if (row.bytes == 0) continue;
    table.line(name, "{:<24} {:>10} {:>10} a ray   from {} to {}, {} bytes a cycle", row.what, bytes_text(row.bytes),
               fmt::format("{:.1f}", ratio(row.bytes, rays)), row.from, row.to, row.width);
    name = "";
  }
}

/// Tests of boxes and triangles and transforms always, other counts of the tests where there are any.
void test_line(Table& table, const Tests& t) {
  using C = IntersectionCounts;
  const auto per_ray = [&](std::uint64_t count) { return fmt::format("{:.2f}", ratio(count, t.rays)); };
  Items items;
  items.add("per ray: box", per_ray(t.counts.box));
  items.add("triangle", per_ray(t.counts.triangle));
  items.add("transform", per_ray(t.counts.transforms));
  for (const Counter<C>& row : kCounters<C>) {
    if (row.member == &C::box || row.member == &C::triangle || row.member == &C::transforms) continue;
    if (row.shown == Shown::kAlways ? row.value(t.counts) > 0 : t.features.show(row.shown))
      items.add(row.name, per_ray(row.value(t.counts)));
  }
  items.lines(table, "tests");
  if (!t.bundles) return;
  const BundleCounts b = t.bundles->sum().counts;
  const auto part = [&](std::uint64_t lanes) { return percent(ratio(lanes, b.all + b.none + b.split)); };
  table.line("bundles", "{} of {:.1f} rays   of their boxes {} all hit, {} all missed, {} split", grouped(b.formed),
             ratio(b.formed_rays, b.formed), part(b.all), part(b.none), part(b.split));
}

void nearest_line(Table& table, const Nearest& n) {
  table.line("nearest",
             "{:.2f} hits a ray of {}, in {:.2f} rounds   {:.2f} nodes   {:.2f} insertions into buffers of {}",
             ratio(n.counts.hits, n.counts.rays), n.nearest, ratio(n.counts.rounds, n.counts.rays),
             ratio(n.visits, n.counts.rays), ratio(n.counts.inserted, n.counts.rays), bytes_text(n.buffer_bytes));
}

/// The sum over all depths; report.json has each depth.
void cull_plane_lines(Table& table, const Report& report) {
  const CullPlanes& planes = *report.cull_planes;
  const CullLevel sum = planes.counts.sum();
  table.line("cull planes", "{} planes, {:.1f} bytes a node, found in {}   {} of {} children culled",
             grouped(planes.planes), planes.bytes_per_node, seconds_text(report.host.plane_seconds.value_or(0)),
             grouped(sum.culled()), grouped(sum.children));
  table.line("", "spared: {} nodes   {} leaves of {} triangles   {} transforms   {} boxes", grouped(sum.nodes),
             grouped(sum.leaves), grouped(sum.triangles), grouped(sum.transforms), grouped(sum.boxes));
}

/// The difference of two counts, with its sign if it is negative.
std::string more(std::uint64_t all, std::uint64_t least) {
  return all >= least ? grouped(all - least) : "-" + grouped(least - all);
}

void proof_line(Table& table, const EffectsProof& proof) {
  const PairedRatio& r = proof.time_ratio;
  table.line("all effects", "hits {}   image {}   time x {:.2f} ({:.2f} to {:.2f} in {} pairs of {} paths)",
             proof.same_hits ? "the same" : "DIFFER", proof.same_image ? "the same" : "DIFFERS", r.median, r.least,
             r.most, proof.repetitions, grouped(proof.paths));
  std::string cycles;
  if (proof.all.cycles && proof.by_demand.cycles)
    cycles = fmt::format("   {} cycles", more(*proof.all.cycles, *proof.by_demand.cycles));
  table.line("", "more: {:.1f} products a ray   {} bytes of path state   {} texture bytes{}",
             proof.all.products_per_ray - proof.by_demand.products_per_ray,
             more(proof.all.path_state_bytes, proof.by_demand.path_state_bytes),
             more(proof.all.texture_bytes, proof.by_demand.texture_bytes), cycles);
}

void packet_lines(Table& table, const Report& report) {
  if (const auto& p = report.packets; p && p->counts.packets_issued > 0) {
    const ResourceCounts& c = p->counts;
    table.line("packets", "{} issued   {} retired   {:.2f} per ray   {:.1f} hops each", grouped(c.packets_issued),
               grouped(c.packets_retired), ratio(c.packets_issued, report.rays.completed),
               ratio(c.hops, c.packets_issued));
    table.line("", "{:.1f} rays each   {} of the rays seen are local   {} of visits find none", p->rays_mean(),
               percent(p->local_fraction()), percent(p->bubble_fraction()));
  }
  if (const auto& c = report.collections; c && c->counts.created > 0) {
    table.line("collections", "{} made   {} full   most in one resource: {}, with {} ray IDs   {} spilled",
               grouped(c->counts.created), percent(c->fullness_mean), grouped(c->counts.peak),
               grouped(c->counts.memberships_peak), grouped(c->counts.spilled));
    if (c->ids_at_once)
      table.line("", "{} ray IDs in all resources at once, of every {} cycles", grouped(*c->ids_at_once),
                 grouped(*c->ids_interval));
  }
}

/// The use of the simulated machine's time.
void cycle_lines(Table& table, const Report& report) {
  const std::uint64_t cycles = *report.engine.cycles;
  const Throughput& t = *report.throughput;
  std::string text = fmt::format("{} cycles", grouped(cycles));
  if (t.whole)
    text += fmt::format("   {:.2f} rays per kilocycle, {:.1f} Mrays/s at the clock", t.whole->rays_per_kilocycle,
                        t.whole->mrays_per_second_at_clock);
  if (t.steady) text += fmt::format("   steady {:.2f}", t.steady->rays_per_kilocycle);
  table.line("simulated", "{}", text);
  if (!report.resources || report.resources->empty()) return;
  PerUnit<UnitCycles> sums;
  std::uint64_t dispatch = 0;
  const std::size_t testing = resources_with_units(report.config, report.resources->size());
  for (std::size_t i = 0; i < report.resources->size(); ++i) {
    const Resource& r = (*report.resources)[i];
    if (!r.units) return;
    for (const auto [kind, sum] : sums)
      if (i < testing) sum += r.units->kinds[kind];
    dispatch += r.units->dispatch_busy;
  }
  const auto part = [&](std::uint64_t x) { return percent(ratio(x, cycles * testing)); };
  Items busy;
  for (const UnitKindRow& row : kUnitKinds)
    if (report.resources->front().units->features.show(row.shown)) busy.add(row.name, part(sums[row.kind].busy));
  busy.add("dispatch", percent(ratio(dispatch, cycles * report.resources->size())));
  busy.add("shading", percent(report.shading.utilisation.value_or(0)));
  busy.add("DRAM", percent(report.memory ? report.memory->dram_utilisation : 0));
  busy.lines(table, "busy");
  const UnitCycles& sum = sums[UnitKind::kBox];  // all kinds wait together
  table.line("testers wait", "memory {}   link {}   credits {}   storage {}   nothing to test {}{}", part(sum.memory),
             part(sum.link), part(sum.credits), part(sum.storage), part(sum.idle),
             sum.shading > 0 ? "   shading " + part(sum.shading) : "");
  if (const std::optional<DistributorCounts>& d = report.resources->front().units->distributor) {
    const auto at_once = [&](std::uint64_t tester_cycles) {
      return fmt::format("{:.2f}", ratio(tester_cycles, cycles));
    };
    table.line("distributor",
               "{} testers busy   {} held back   {} without a place for results   {} of rays ahead   waits {}",
               at_once(d->tester_busy), at_once(d->held_back), at_once(d->results_full),
               percent(ratio(d->ahead, d->ids)), part(d->queue_full));
  }
  table.text(warp_table(*report.resources));
}

void energy_lines(Table& table, const Report& report) {
  const Energy& e = *report.energy;
  table.line("energy", "{:.4g} nJ a ray   {:.4g} mJ in all   {:.4g} W at the clock   {:.4g} Mrays a joule",
             e.nj_per_ray, 1e3 * e.joules, e.watts, 1e-6 * e.rays_per_joule);
  double tests = 0, links = 0, stores = 0, dram = 0, shading = 0;
  for (const auto [kind, part] : e.parts.units) tests += part.joules;
  const auto sum = [&](double& to, std::initializer_list<EnergyPart> parts) {
    for (const EnergyPart part : parts) to += e.parts.others[static_cast<std::size_t>(part)].joules;
  };
  using enum EnergyPart;
  sum(stores, {kRayStore, kCollections, kShapeBuffers, kStacks, kL1, kL2});
  for (const std::optional<EnergyOf>& part : e.parts.declared) stores += part ? part->joules : 0;
  sum(links, {kPorts, kWires, kMessages, kMessageWires});
  sum(dram, {kDram, kActivations});
  sum(shading, {kShades, kProducts, kLookups});
  const auto part = [&](double joules) { return percent(ratio(joules, e.joules)); };
  table.line("", "tests {}   stores {}   wires {}   DRAM {}   shading {}", part(tests), part(stores), part(links),
             part(dram), part(shading));
  if (const auto& peak = e.peak)
    table.line("", "peak {:.4g} W over {} cycles from cycle {}   mostly {}: {}", peak->watts, grouped(peak->cycles),
               grouped(peak->first_cycle), peak->part, percent(peak->part_share));
  const Area& a = *report.area;
  Items items;
  for (std::size_t i = 0; i < kAreaParts.size(); ++i)
    if (a.parts.of[i].mm2 > 0) items.add(kAreaParts[i].name, percent(ratio(a.parts.of[i].mm2, a.mm2)));
  Parts::for_each([&]<class P>(std::size_t i) {
    if (a.parts.declared[i]) items.add(P::kName, percent(ratio(a.parts.declared[i]->mm2, a.mm2)));
  });
  table.line("area", "{:.4g} mm2   {:.4g} Mrays/s on each", a.mm2, a.mrays_per_second_per_mm2.value_or(0));
  items.lines(table, "");
  if (const AreaTrial* best = a.search ? a.search->chosen() : nullptr)
    table.line("",
               "best of {} splits: {} resources, {} testers each, L2 {} KiB with {} ports, {} workers   {:.3g} times "
               "{}",
               a.search->trials.size(), best->resources, best->testers, best->l2_kib, best->l2_lines_per_cycle,
               best->shader_workers, a.search->gain(),
               a.search->for_joules() ? "the rays a joule of the first" : "the first");
}

std::string image_text(const nlohmann::ordered_json& config) {
  const auto image = config.find("image");
  if (image == config.end()) return "";
  return fmt::format("   {} x {} pixels, {} samples", image->value("width", 0), image->value("height", 0),
                     image->value("samples", 0));
}

std::string ring_text(const nlohmann::ordered_json& config) {
  const auto topology = config.find("topology");
  if (topology == config.end()) return "";
  return fmt::format(": {} resources, {}", topology->value("resources", 0), topology->value("shape", ""));
}

void frame_lines(Table& table, const Frames& frames) {
  table.line("frames", "{} frames   {} rays in all   below is the last of them", grouped(frames.count),
             grouped(frames.rays));
  if (!frames.cycles) return;
  table.line("builder", "{} of {} cycles   {} moved   it limits {} frames   a rebuild pays in {} frames",
             grouped(*frames.builder_cycles), grouped(*frames.cycles), bytes_text(*frames.builder_bytes),
             grouped(*frames.limited_by_builder), grouped(*frames.worn));
}

void level_lines(Table& table, const std::vector<StructureLevel>& levels) {
  std::string_view name = "structure";
  for (const StructureLevel& level : levels) {
    table.line(name, "{}: {} structures, {} strips deep   {} inner nodes of {:.1f} children   {} leaves   {}",
               level.level, grouped(level.structures), level.depth, grouped(level.inner_nodes),
               ratio(static_cast<double>(level.children), static_cast<double>(level.inner_nodes)),
               grouped(level.leaves), bytes_text(level.bytes()));
    name = "";
  }
}

}  // namespace

std::string report_table(const Report& report) {
  Table table;
  if (report.incomplete) table.line("INCOMPLETE", "the work was interrupted; this is the part that was done");
  table.line("scene", "{}: {} triangles, {} instances{}", report.scene.name, grouped(report.scene.triangles),
             grouped(report.scene.instances), image_text(report.config));
  if (report.levels)
    table.line("levels", "{}: {} groups in {} placements; {} of nodes, {} if groups were not shared",
               report.levels->levels, grouped(report.levels->groups), grouped(report.levels->placements),
               bytes_text(report.levels->node_bytes), bytes_text(report.levels->node_bytes_unshared));
  if (report.structure && report.structure->duplicates > 0)
    table.line("structure", "{} references to {} triangles in {} leaves and {} inner nodes",
               grouped(report.structure->references), grouped(report.structure->primitives),
               grouped(report.structure->leaves), grouped(report.structure->inner_nodes));
  if (report.structure && report.structure->merged_meshes > 0)
    table.line("structure", "{} meshes of the world in one", grouped(report.structure->merged_meshes));
  if (report.structure && report.structure->levels) level_lines(table, *report.structure->levels);
  const bool simulated = report.engine.cycles.has_value();
  table.line("engine", "{}{}{}, {} shader workers", report.engine.kind, ring_text(report.config),
             simulated ? "" : fmt::format(" on {} threads", report.host.threads), report.shading.workers);
  if (report.sampled) table.text(sampled_table(*report.sampled));
  if (report.frames) frame_lines(table, *report.frames);
  table.gap();
  const Rays& rays = report.rays;
  const std::optional<Stop> stop = report.faults ? report.faults->stop : std::nullopt;
  table.line("rays", "{} emitted   {} completed   {} lost{}", grouped(rays.emitted), grouped(rays.completed),
             grouped(rays.lost),
             rays.restarted == 0 ? ""
                                 : fmt::format("   {} restarted of {} paths, {} after a resource stopped",
                                               grouped(rays.restarted), grouped(rays.paths_restarted),
                                               stop && stop->restarted_cycle
                                                   ? grouped(*stop->restarted_cycle - *stop->stopped_cycle) + " cycles"
                                                   : seconds_text(report.host.recovery_seconds.value_or(0))));
  table.line("", "camera {}   bounce {}   shadow {}", grouped(rays.by_kind.camera), grouped(rays.by_kind.bounce),
             grouped(rays.by_kind.shadow));
  if (report.raster) {
    const RasterCounts& raster = *report.raster;
    table.line("raster", "{} triangles seen {} times by tiles   {} hits   {} left to rays   {}",
               grouped(raster.triangles), grouped(raster.binned), grouped(raster.hits), grouped(raster.left_to_rays),
               seconds_text(report.host.raster_seconds.value_or(0)));
    if (report.raster_unit)
      table.line("", "in {} cycles{} before the rays{}", grouped(report.raster_unit->cycles),
                 report.sampled ? " of the whole frame" : "",
                 report.raster_unit->limits ? ", longer than they take" : "");
  }
  if (report.ranks) rank_lines(table, *report.ranks, *report.rank_links);
  if (report.faults && report.faults->cycles_without)
    table.line(
        "faults", "cost {} cycles: {} without them{}", *report.faults->cycles_lost,
        grouped(*report.faults->cycles_without),
        report.faults->same_hits.value_or(true) ? ", the same hits and picture" : ", OTHER HITS OR ANOTHER PICTURE");
  if (!simulated)
    table.line("throughput", "{}rays/s   {} for the rays, {} to build the tree   {} memory",
               scaled(report.host.rays_per_second), seconds_text(report.host.wall_seconds),
               seconds_text(report.host.build_seconds), bytes_text(report.host.peak_memory_bytes));
  if (report.engine.cycles && report.throughput) cycle_lines(table, report);
  if (report.ray_time) table.text(ray_time_table(*report.ray_time));
  if (report.heat) table.text(heat_table(*report.heat));
  if (report.bottleneck) table.text(verdict_table(*report.bottleneck));
  if (report.cycle_noise) table.text(noise_table(*report.cycle_noise));
  if (report.charges) table.text(charges_table(*report.charges));
  if (report.bound && !report.bound->classes.empty())
    table.line("bound", "{:.2f} rays per kilocycle by {}, reached {}", report.bound->rays_per_kilocycle,
               report.bound->classes.front().name, percent(report.bound->reached));
  if (report.energy && report.area) energy_lines(table, report);
  if (report.tests) test_line(table, *report.tests);
  if (const auto& maps = report.micromaps)
    table.line("micromaps", "{}   {} maps of {} micro-triangles   {} of {} any-hit calls saved",
               bytes_text(maps->bytes), grouped(maps->maps), grouped(maps->micro_triangles_each),
               grouped(maps->calls_saved), grouped(maps->calls_saved + maps->calls));
  if (report.cull_planes) cull_plane_lines(table, report);
  if (report.nearest) nearest_line(table, *report.nearest);
  packet_lines(table, report);
  if (report.effects && report.effects->spared) table.text(spared_table(*report.effects->spared));
  if (report.shading.proof) proof_line(table, *report.shading.proof);
  if (report.resources && !report.resources->empty()) resource_lines(table, *report.resources, report.config);
  if (report.links && !report.links->empty()) link_line(table, *report.links);
  table.text(part_table(report.parts));
  if (report.host.ray_queues) ray_queue_lines(table, *report.host.ray_queues);
  if (report.bytes) byte_lines(table, *report.bytes, report.rays.completed);
  table.gap();
  if (simulated)
    table.line("host", "{} to simulate on {} threads   {} to build the tree   {} memory",
               seconds_text(report.host.wall_seconds), report.host.threads, seconds_text(report.host.build_seconds),
               bytes_text(report.host.peak_memory_bytes));
  if (report.verify)
    table.line("verify", "{} rays traced again, {} mismatches{}", grouped(report.verify->compared),
               grouped(report.verify->mismatches), report.verify->example.empty() ? "" : "; " + report.verify->example);
  table.line("digest", "hits {}{}", report.digest.hits, report.digest.image ? "   image " + *report.digest.image : "");
  return table.take();
}

}  // namespace carousel::report
