#include "report/run/terminal_words.h"

#include <string_view>

#include "core/config/parts.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/ray_stage_counts.h"
#include "core/statistics/stall_counts.h"
#include "core/types/unit_kind.h"
#include "report/sections/costs.h"

namespace carousel::report {

namespace {

/// Collects the items of one line after another.
class Words {
 public:
  explicit Words(bool traffic) : traffic_(traffic) {}

  Words& line(std::string_view name) {
    line_ = name;
    return *this;
  }
  Words& item(std::string_view text, std::string_view key, std::string_view meaning = "") {
    words_.push_back({traffic_, line_, std::string(text), std::string(key), std::string(meaning)});
    return *this;
  }
  std::vector<TerminalWord> take() { return std::move(words_); }

 private:
  bool traffic_;
  std::string line_;
  std::vector<TerminalWord> words_;
};

void machine_words(Words& w) {
  w.line("INCOMPLETE").item("the work was interrupted; this is the part that was done", "incomplete");
  w.line("scene")
      .item("*: N triangles, N instances", "scene", "the scene, its triangles (each counted once) and its instances")
      .item("N x N pixels, N samples", "config.image", "size of the picture, and paths from each pixel");
  w.line("structure")
      .item("*: N structures, N strips deep", "structure.levels[].structures",
            "a level of the acceleration structure: its structures, shared ones once, and the longest way down in them")
      .item("N inner nodes of N children", "structure.levels[].inner_nodes",
            "inner nodes of the level, and the children that one of them has")
      .item("N leaves", "structure.levels[].leaves")
      .item("N", "structure.levels[].bytes");
  w.line("engine")
      .item("native: N resources, * on N threads, N shader workers", "config.topology",
            "the machine: its compute resources, the shape of its network, the threads of the host that play them, and "
            "its shader workers")
      .item("cycle: N resources, *, N shader workers", "config.topology",
            "the machine: its compute resources, the shape of its network, and its shader workers");
}

void frame_words(Words& w) {
  w.line("frames")
      .item("N frames", "frames.count")
      .item("N rays in all", "frames.rays")
      .item("below is the last of them", "frames.rows", "all other lines are about the last frame");
  w.line("builder")
      .item("N of N cycles", "frames.builder_cycles", "time of the builder, and that of all frames with it")
      .item("N moved", "frames.builder_bytes")
      .item("it limits N frames", "frames.limited_by_builder")
      .item("a rebuild pays in N frames", "frames.worn");
}

void ray_words(Words& w) {
  w.line("rays")
      .item("N emitted", "rays.emitted")
      .item("N completed", "rays.completed")
      .item("N lost", "rays.lost")
      .item("N restarted of N paths, N cycles after a resource stopped", "rays.restarted")
      .item("N restarted of N paths, N after a resource stopped", "rays.restarted")
      .item("camera N", "rays.by_kind.camera")
      .item("bounce N", "rays.by_kind.bounce")
      .item("shadow N", "rays.by_kind.shadow");
  w.line("raster")
      .item("N triangles seen N times by tiles", "raster",
            "triangles before the camera, and tiles that each of them touches")
      .item("N hits", "raster.hits")
      .item("N left to rays", "raster.left_to_rays")
      .item("N", "host.raster_seconds")
      .item("in N cycles before the rays", "raster_unit.cycles")
      .item("in N cycles before the rays, longer than they take", "raster_unit.cycles")
      .item("in N cycles of the whole frame before the rays", "raster_unit.cycles", "with sampling.fraction")
      .item("in N cycles of the whole frame before the rays, longer than they take", "raster_unit.cycles");
  w.line("ranks")
      .item("N ranks", "ranks")
      .item("N messages", "rank_links[].messages")
      .item("N between them", "rank_links[].bytes")
      .item("N memory at most, N of it structure", "ranks[].peak_memory_bytes",
            "most memory of any rank, and the largest acceleration structure of any")
      .item("rank N: resources N to N", "ranks[].first_resource", "the arc of a rank; at most eight ranks have a line")
      .item("N threads", "ranks[].threads")
      .item("N rays shaded", "ranks[].rays_shaded")
      .item("waited N %", "ranks[].waiting")
      .item("rank N to N: N messages", "rank_links[].messages", "those ways between ranks that carried most bytes")
      .item("N", "rank_links[].bytes")
      .item("N packets a message", "rank_links[].packets_per_message")
      .item("held N %", "rank_links[].held")
      .item("full N times", "rank_links[].full")
      .item("N more ranks and N more ways between ranks in report.json", "ranks");
  w.line("faults").item("cost N cycles: N without them, *", "faults.cycles_lost");
  w.line("throughput")
      .item("N rays/s", "host.rays_per_second",
            "completed rays over the time of the run: the speed of the native engine")
      .item("N for the rays, N to build the tree", "host.wall_seconds",
            "time of the run, and time to build the acceleration structure before it")
      .item("N memory", "host.peak_memory_bytes");
}

void cycle_words(Words& w) {
  w.line("simulated")
      .item("N cycles", "engine.cycles")
      .item("N rays per kilocycle, N Mrays/s at the clock", "throughput.whole",
            "completed rays in 1,000 cycles, and in a second at engine.clock_mhz")
      .item("steady N", "throughput.steady",
            "rays per kilocycle in the steady part of the run, without its start and its end");
  w.line("busy");
  for (const UnitKindRow& row : kUnitKinds)
    w.item(std::string(row.name) + " N", std::string("resources[].units.") + row.name + ".busy",
           "part of the cycles of all resources in which these units worked");
  w.item("dispatch N", "resources[].units.dispatch_busy",
         "part of the cycles of all resources in which the dispatch stage looked through ray IDs")
      .item("shading N", "shading.utilisation")
      .item("DRAM N", "memory.dram_utilisation");
  w.line("testers wait")
      .item("memory N", "resources[].units.box.memory", "part of the cycles in which a packet waited for shape data")
      .item("link N", "resources[].units.box.link", "part of the cycles in which a packet waited to leave")
      .item("credits N", "resources[].units.box.credits",
            "part of the cycles in which no packet was free to issue with")
      .item("storage N", "resources[].units.box.storage",
            "part of the cycles in which too few blocks of collections were free")
      .item("nothing to test N", "resources[].units.box.idle",
            "part of the cycles in which no ray waited, or collections waited to fill")
      .item("shading N", "resources[].units.box.shading",
            "part of the cycles in which resources helped the shader workers");
  w.line("distributor")
      .item("N testers busy", "resources[].units.distributor.tester_busy",
            "testers that had a ray, in the mean of all cycles")
      .item("N held back", "resources[].units.distributor.held_back",
            "testers that waited for an older packet (testers.distributor.out_of_order), likewise")
      .item("N without a place for results", "resources[].units.distributor.results_full",
            "testers whose results waited for the decision point, likewise")
      .item("N of rays ahead", "resources[].units.distributor.ahead",
            "rays whose tests began while an older packet was in test")
      .item("waits N", "resources[].units.distributor.queue_full",
            "part of the cycles in which the distributor waited for a place in a tester's queue");
  w.line("ray time").item("N cycles a ray", "ray_time.latency");
  for (const Counter<RayStageCounts>& row : kCounters<RayStageCounts>)
    w.item(std::string(row.name) + " N", std::string("ray_time.") + row.name,
           std::string("part of the rays' cycles: ") + row.meaning);
  w.line("slow pixels")
      .item("*: N cycles of N rays", "heat.slowest[].cycles", "a pixel whose rays took most cycles, and these rays")
      .item("N a pixel", "heat.cycles_mean");
  w.line("warps")
      .item("N of lanes with a ray", "resources[].units.warps.fill",
            "part of the lanes whose ray had not ended, over the cycles of all warps")
      .item("N with a test", "resources[].units.warps.step_fill", "part of the lanes with a test, over all steps")
      .item("N of lines read", "resources[].units.warps.lines_read",
            "part of the lines that lanes wanted which were read; the others were read for several lanes together")
      .item("N bytes of stack spilled a ray", "resources[].units.warps.spilled_bytes",
            "entries of stacks that were written to memory");
  w.line("bottleneck")
      .item("*", "bottleneck.verdict", "the class of parts that limits the machine, and the gain if it were relaxed")
      .item(
          "by N of the frame's rays, which foretell its cycles to N", "bottleneck.rays",
          "rays of the pilot, which the search simulates, and by how much the cycles that it foretells miss the run's");
  w.line("phases").item(
      "N to N of the rays, N of the time: *", "bottleneck.phases",
      "a stretch of the pilot's completed rays, its part of the cycles, and the class that gains most in it; shown "
      "if the class changes");
  w.line("noise").item("N to N cycles with another seed of the picture, N more or less, by N seeds of N paths",
                       "cycle_noise.fraction",
                       "the interval of the run's cycles: those with another seed lie in it, by simulations of pilots "
                       "or of the whole frame with other seeds");
  w.line("not charged").item("*", "charges[].name", "what costs nothing in this run; run --charge-all charges it");
  w.line("bound").item(
      "N rays per kilocycle by *, reached N", "bound.rays_per_kilocycle",
      "the rate that the tightest class of parts would allow if it were busy all the time, and the part "
      "of it that the run reached");
}

void energy_words(Words& w) {
  w.line("energy")
      .item("N nJ a ray", "energy.nj_per_ray")
      .item("N mJ in all", "energy.joules")
      .item("N W at the clock", "energy.watts")
      .item("N Mrays a joule", "energy.rays_per_joule")
      .item("tests N", "energy.parts", "part of the energy that the test units take")
      .item("stores N", "energy.parts",
            "part of the ray stores, collections, shape buffers, stacks and caches, and of parts such as a prefetcher: "
            "their accesses")
      .item("wires N", "energy.parts", "part of the packets and other messages: their ports and wires")
      .item("DRAM N", "energy.parts", "part of the memory: bytes and activations")
      .item("shading N", "energy.parts", "part of the shader workers")
      .item("peak N W over N cycles from cycle N", "energy.peak",
            "the most power of any thousand cycles that begin at a multiple of energy.peak.resolution")
      .item("mostly *: N", "energy.peak.part_share");
  w.line("area").item("N mm2", "area.mm2").item("N Mrays/s on each", "area.mrays_per_second_per_mm2");
  for (const AreaPartRow& row : kAreaParts)
    w.item(std::string(row.name) + " N", std::string("area.parts.") + row.key,
           std::string("part of the area: ") + row.meaning);
  Parts::for_each([&]<class P>(std::size_t) {
    w.item(std::string(P::kName) + " N", std::string("area.parts.") + P::kSection,
           std::string("part of the area: ") + P::kAreaMeaning);
  });
  w.item("best of N splits: N resources, N testers each, L2 N KiB with N ports, N workers", "area.search.trials",
         "the split of area.budget_mm2 that the machine has")
      .item("N times the first", "area.search.trials[].cycles", "speed over that of the split tried first")
      .item("N times the rays a joule of the first", "area.search.trials[].nj_per_ray", "with area.aim: joules");
}

void test_words(Words& w) {
  using C = IntersectionCounts;
  w.line("tests")
      .item("per ray: box N", "tests.box.per_ray", "tests of a ray against a box, for each completed ray")
      .item("triangle N", "tests.triangle.per_ray", "tests of a ray against a triangle, likewise")
      .item("transform N", "tests.transforms.per_ray", "transformations of a ray to model space, likewise");
  for (const Counter<C>& row : kCounters<C>)
    if (row.member != &C::box && row.member != &C::triangle && row.member != &C::transforms)
      w.item(std::string(row.name) + " N", std::string("tests.") + row.name + ".per_ray",
             std::string(row.meaning) + ", likewise");
  w.line("bundles")
      .item("N of N rays", "tests.bundles.formed", "bundles formed, and the rays of a bundle when formed")
      .item("of their boxes N all hit, N all missed, N split", "tests.bundles.sum",
            "parts of the bundles' tests by their outcome: all rays hit the box, none does, or the bundle splits");
  w.line("micromaps")
      .item("N", "micromaps.bytes")
      .item("N maps of N micro-triangles", "micromaps.maps")
      .item("N of N any-hit calls saved", "micromaps.calls_saved");
  w.line("cull planes")
      .item("N planes, N bytes a node, found in N", "cull_planes.planes",
            "size of the cull planes, and time to find them")
      .item("N of N children culled", "cull_planes.levels[].culled",
            "children whose boxes were hit and that a plane culled")
      .item("spared: N nodes", "cull_planes.levels[].nodes_spared")
      .item("N leaves of N triangles", "cull_planes.levels[].leaves_spared")
      .item("N transforms", "cull_planes.levels[].transforms_spared")
      .item("N boxes", "cull_planes.levels[].box_tests_spared");
  w.line("nearest")
      .item("N hits a ray of N, in N rounds", "nearest.hits_per_ray",
            "hits of a ray that looks for several, as many as it looks for, and its rounds")
      .item("N nodes", "nearest.visits", "nodes and leaves that such a ray is tested against, in the mean")
      .item("N insertions into buffers of N", "nearest.inserted",
            "hits that such a ray puts into its buffer, in the mean, and the bytes of all buffers");
}

void packet_words(Words& w) {
  w.line("packets")
      .item("N issued", "packets.issued")
      .item("N retired", "packets.retired")
      .item("N per ray", "throughput.packets_per_ray")
      .item("N hops each", "packets.hops", "links that a packet crosses, on average")
      .item("N rays each", "packets.rays_mean")
      .item("N of the rays seen are local", "packets.local_fraction")
      .item("N of visits find none", "packets.bubble_fraction");
  w.line("collections")
      .item("N made", "collections.created")
      .item("N full", "collections.fullness_mean")
      .item("most in one resource: N, with N ray IDs", "collections.peak",
            "most collections that any resource had at one time, and most ray IDs")
      .item("N spilled", "collections.spilled")
      .item("N ray IDs in all resources at once, of every N cycles", "collections.ids_at_once");
  w.line("effects")
      .item("spared N of the cycles: all effects would cost N cycles (N to N)", "effects.spared",
            "forecast of what the same frame would take if every effect of light were computed at every surface")
      .item("measured N cycles, foretold to N", "effects.spared.measured",
            "cycles of a run with all effects, with verify: effects, and by how much the forecast misses them");
  w.line("all effects")
      .item("hits *", "shading.proof.same_hits")
      .item("image *", "shading.proof.same_image")
      .item("time x N (N to N in N pairs of N paths)", "shading.proof.time_ratio",
            "CPU time of a sample of the frame with all effects over that with auto: median, least and greatest of the "
            "pairs of repetitions")
      .item("more: N products a ray", "shading.proof.all.products_per_ray",
            "what the run with all effects takes more than the run with auto; in report.json stand both")
      .item("N bytes of path state", "shading.proof.all.path_state_bytes")
      .item("N texture bytes", "shading.proof.all.texture_bytes")
      .item("N cycles", "shading.proof.all.cycles");
}

void resource_words(Words& w) {
  w.line("resources")
      .item(
          "N of them least mean most max/mean", "resources[]",
          "the lines below give the least, the mean and the greatest of the resources, and the greatest over the mean: "
          "1.00 is a balanced machine")
      .item("rays N N N N", "resources[].rays_completed")
      .item("rays tested N N N N", "resources[].rays_tested")
      .item("box tests N N N N", "resources[].box_tests")
      .item("triangle tests N N N N", "resources[].triangle_tests")
      .item("packets issued N N N N", "resources[].packets_issued",
            "packets issued from a resource's collections; where packet processes serve resources, from theirs")
      .item("packets seen N N N N", "resources[].packets_seen");
  w.line("stalls");
  for (const Counter<StallCounts>& row : kCounters<StallCounts>)
    w.item(std::string(row.name) + " N", std::string("resources[].stalls.") + row.name,
           std::string("attempts of worker threads: ") + row.meaning);
  w.line("links")
      .item("N of depth N", "links[].depth", "number of links, and packets that each of them holds")
      .item("N packets", "links[].packets")
      .item("occupancy N mean, N most", "links[].occupancy_mean", "packets that wait in a link, on average and at most")
      .item("N refused", "links[].stalled", "sends that a full link refused")
      .item("N cycles stalled", "links[].stalled",
            "cycles in which a packet waited for a place in its link, all links together")
      .item("busiest from N to N: N", "links[].utilisation", "the link that moved packets in most cycles");
  Parts::for_each([&]<class P>(std::size_t) {
    w.line(P::kName);
    for (const Counter<typename P::Counts>& row : kCounters<typename P::Counts>)
      w.item(std::string(row.name) + " N", std::string(P::kSection) + "." + row.name);
  });
  w.line("queues")
      .item("completed rays through * of N", "host.ray_queues.completed.depth",
            "design of the queue from the resources to the shader workers, and batches that it holds")
      .item("N batches of N rays", "host.ray_queues.completed.sent")
      .item("N waiting, N most", "host.ray_queues.completed.waiting_mean")
      .item("N refused", "host.ray_queues.completed.refused")
      .item("new rays through * of N", "host.ray_queues.created.depth",
            "design of the queues from ray control to each resource, and groups that each of them holds")
      .item("N groups of N rays", "host.ray_queues.created.sent")
      .item("N waiting, N most", "host.ray_queues.created.waiting_mean")
      .item("N refused", "host.ray_queues.created.refused");
}

void last_words(Words& w) {
  w.line("bytes").item(
      "* N N a ray from * to *, N bytes a cycle", "bytes[]",
      "a kind of message: its bytes in all and for each completed ray, its ends, and the width of each of its wires");
  w.line("host")
      .item("N to simulate on N threads", "host.wall_seconds",
            "time of the simulation on this host, and its threads: it says nothing about the simulated machine")
      .item("N to build the tree", "host.build_seconds")
      .item("N memory", "host.peak_memory_bytes");
  w.line("verify").item("N rays traced again, N mismatches*", "verify");
  w.line("digest").item("hits *", "digest.hits").item("image *", "digest.image");
  w.line("files").item("*", "", "folder of report.json, of the picture and of the resolved configuration");
}

std::vector<TerminalWord> words_of_traffic() {
  Words w(true);
  w.line("INCOMPLETE").item("the work was interrupted; this is the part that was done", "incomplete");
  w.line("network").item("cycle: * traffic on N resources, *", "config.topology",
                         "pattern of the packets' destinations, size and shape of the network");
  w.line("packets")
      .item("N created", "traffic.packets")
      .item("N delivered", "traffic.delivered")
      .item("N flits each", "traffic.flits_per_packet")
      .item("N measured, created from cycle N to N", "traffic.measured");
  w.line("load")
      .item("N offered", "traffic.offered")
      .item("N accepted packets per resource and cycle", "traffic.accepted")
      .item("N of the links' time", "traffic.accepted_of_links")
      .item("N GB/s", "traffic.gigabytes_per_second");
  w.line("latency")
      .item("N mean", "traffic.latency.mean")
      .item("N least", "traffic.least_latency")
      .item("N p50", "traffic.latency.p50")
      .item("N p95", "traffic.latency.p95")
      .item("N p99", "traffic.latency.p99")
      .item("N max cycles", "traffic.latency.max")
      .item("N with nobody in the way, at N resources visited", "traffic.zero_load_latency");
  w.line("links")
      .item("N busy on average, N the busiest", "traffic.link_utilisation",
            "part of the window's cycles in which links moved flits")
      .item("N flit-hops", "traffic.flit_hops");
  w.line("stops")
      .item("N extra rounds", "traffic.stops.extra_rounds")
      .item("N cycles the longest ride", "traffic.stops.longest_ride")
      .item("N cycles the longest wait", "traffic.stops.longest_wait")
      .item("N reservations", "traffic.stops.reservations");
  w.line("simulated").item("N cycles", "engine.cycles");
  w.line("host")
      .item("N to simulate on N threads", "host.wall_seconds")
      .item("N flit-hops/s", "", "speed of the simulator");
  w.line("files").item("*", "", "folder of report.json and of the resolved configuration");
  return w.take();
}

}  // namespace

std::vector<TerminalWord> terminal_words() {
  Words w(false);
  machine_words(w);
  frame_words(w);
  ray_words(w);
  cycle_words(w);
  energy_words(w);
  test_words(w);
  packet_words(w);
  resource_words(w);
  last_words(w);
  std::vector<TerminalWord> words = w.take();
  for (TerminalWord& word : words_of_traffic()) words.push_back(std::move(word));
  return words;
}

}  // namespace carousel::report
