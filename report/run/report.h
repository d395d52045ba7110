#pragma once

#include <nlohmann/json.hpp>

#include "core/config/parts.h"
#include "core/statistics/raster_counts.h"
#include "report/schema/checksum.h"
#include "report/schema/document_version.h"
#include "report/sections/bottleneck.h"
#include "report/sections/bytes.h"
#include "report/sections/costs.h"
#include "report/sections/engine.h"
#include "report/sections/faults.h"
#include "report/sections/host.h"
#include "report/sections/link.h"
#include "report/sections/memory/memory.h"
#include "report/sections/memory/memory_trace.h"
#include "report/sections/packets.h"
#include "report/sections/program.h"
#include "report/sections/ranks.h"
#include "report/sections/rays.h"
#include "report/sections/rays/heat.h"
#include "report/sections/rays/nearest.h"
#include "report/sections/rays/raster_unit.h"
#include "report/sections/rays/ray_time.h"
#include "report/sections/resource.h"
#include "report/sections/sampled.h"
#include "report/sections/scene_summary.h"
#include "report/sections/shading.h"
#include "report/sections/structure/cull_planes.h"
#include "report/sections/structure/frames.h"
#include "report/sections/structure/levels.h"
#include "report/sections/structure/micromaps.h"
#include "report/sections/structure/nodes.h"
#include "report/sections/structure/structure.h"
#include "report/sections/tests.h"
#include "report/sections/throughput.h"
#include "report/sections/time_series.h"
#include "report/sections/traffic.h"
#include "report/sections/verify.h"

namespace carousel::report {

/// The report of one run (docs/how-it-works/design.md, The report, a contract): plain structs, filled by app/. Each
/// section's fields, units and meanings stand in its file. Counts that depend on scheduling differ from run to run in
/// the native engine with several threads.
struct Report {
  std::int64_t schema_version = kDocumentVersion;
  bool incomplete = false;
  Program carousel;
  nlohmann::ordered_json config = nlohmann::ordered_json::object();
  std::vector<std::string> ignored_keys;
  std::optional<std::vector<Plugin>> plugins;
  SceneSummary scene;
  Engine engine;
  std::optional<std::vector<ClockUse>> clocks;
  Rays rays;
  std::optional<RayTime> ray_time;
  std::optional<Heat> heat;
  std::optional<RasterCounts> raster;
  std::optional<RasterUnit> raster_unit;
  std::optional<Sampled> sampled;
  std::optional<Throughput> throughput;
  std::optional<Tests> tests;
  std::optional<Frames> frames;
  std::optional<Nodes> nodes;
  std::optional<Structure> structure;
  std::optional<Levels> levels;
  std::optional<Micromaps> micromaps;
  std::optional<CullPlanes> cull_planes;
  std::optional<Nearest> nearest;
  std::optional<Packets> packets;
  std::optional<Collections> collections;
  std::optional<std::vector<Resource>> resources;
  std::optional<std::vector<DrawnNode>> drawing;
  std::optional<std::vector<Link>> links;
  std::optional<RingStopsUse> stops;
  std::optional<std::vector<Rank>> ranks;
  std::optional<std::vector<RankLink>> rank_links;
  std::optional<Memory> memory;
  PartCounts<Parts> parts;
  std::optional<std::vector<ByteRow>> bytes;
  std::optional<TimeSeries> time_series;
  std::optional<Traffic> traffic;
  std::optional<MemoryTrace> memory_trace;
  Shading shading;
  std::optional<Effects> effects;
  std::optional<Energy> energy;
  std::optional<Area> area;
  std::optional<std::vector<CostConstant>> costs;
  std::optional<std::vector<Charge>> charges;
  std::optional<Bound> bound;
  std::optional<Bottleneck> bottleneck;
  std::optional<CycleNoise> cycle_noise;
  std::optional<Faults> faults;
  std::optional<Verify> verify;
  Digest digest;
  Host host;
  std::optional<std::string> checksum;  ///< set where the text is written (report/read/document.h)
};

template <class V>
void describe(V& v, const Report& r) {
  v.field("schema_version", r.schema_version, "", "version of these keys");
  v.field("incomplete", r.incomplete, "",
          "true if the run was interrupted, with counts that are then partial, or a search, comparison or verification "
          "after it");
  v.section("carousel", r.carousel, "program that wrote the report");
  v.any("config", r.config, "resolved configuration; see carousel schema config");
  v.field("ignored_keys", r.ignored_keys, "",
          "keys that the configuration sets and that this machine, with its scene and workload, cannot feel");
  v.section("plugins", r.plugins, "each of engine.plugins; code of others, of which the results depend");
  v.section("scene", r.scene, "scene that was rendered");
  v.section("engine", r.engine, "engine that simulated the machine");
  v.section("clocks", r.clocks, "each clock, where parts of the machine go by several");
  v.section("rays", r.rays, "rays; emitted = completed + lost");
  v.section("ray_time", r.ray_time,
            "where the cycles of all rays go (cycle); absent of an incomplete run, with bundles, warps, and with "
            "faults.resource.kind: stop");
  v.section("heat", r.heat, "cost of the picture's pixels, of a run with --heat (cycle)");
  v.section("raster", r.raster, "raster pass that replaces camera rays; absent with primary: rays");
  v.section("raster_unit", r.raster_unit, "time and bytes of that pass, with raster.time: cycles (cycle)");
  v.section(
      "sampled", r.sampled,
      "estimates for the whole frame, when sampling.fraction is less than 1; all other sections are about the part "
      "that was simulated");
  v.section("throughput", r.throughput, "work for each ray; rates by the wall clock stand in host");
  v.section("tests", r.tests, "tests and other work of testing rays");
  v.section("frames", r.frames, "each picture of a series, of which all other sections show the last");
  v.section("nodes", r.nodes, "nodes of the structure by depth; absent where single rays go down without packets");
  v.section("structure", r.structure, "structures over meshes, when there are rays");
  v.section("levels", r.levels, "instances of instances, when the structure has more than two levels");
  v.section("micromaps", r.micromaps, "opacity micromaps and the any-hit calls that they save, with bvh.micromaps");
  v.section("cull_planes", r.cull_planes, "size of the cull planes and work that they spare, when there are any");
  v.section("nearest", r.nearest, "rays that look for several hits and what these cost, with rays.query.nearest");
  v.section("packets", r.packets, "packets of all resources");
  v.section("collections", r.collections, "collections: rays waiting for a node");
  v.section("resources", r.resources, "each resource");
  v.section("drawing", r.drawing, "each node of a graph, by the numbers that links[].from and to have");
  v.section("links", r.links, "each link");
  v.section("stops", r.stops, "stops of a ring without queues, when packets of rays travel on it");
  v.section("ranks", r.ranks, "each process of a run with engine.transport: mpi");
  v.section("rank_links", r.rank_links, "messages from each of them to each other");
  v.section("memory", r.memory, "caches and memory of the simulated machine");
  Parts::for_each([&]<class P>(std::size_t) { v.section(P::kSection, r.parts.template of<P>(), P::kCountsMeaning); });
  v.section("bytes", r.bytes,
            "every byte that a part of the simulated machine hands to another, by kind of message (cycle)");
  v.section("time_series", r.time_series, "quantities of the machine's parts over the run (cycle)");
  v.section("traffic", r.traffic, "the network alone, when workload is traffic");
  v.section("memory_trace", r.memory_trace, "the memory alone, when workload is memory_trace");
  v.section("shading", r.shading, "shader workers and effects of light");
  v.section("effects", r.effects, "what the choice of effects of light was worth (cycle)");
  v.section("energy", r.energy, "energy of the simulated machine, with energy.profile");
  v.section("area", r.area, "area of the simulated machine, with energy.profile");
  v.section("costs", r.costs, "every number of energy and area, with its source");
  v.section("charges", r.charges, "what costs nothing in this run, and the keys that charge it (cycle)");
  v.section("bound", r.bound, "rate that each class of parts alone would allow");
  v.section("bottleneck", r.bottleneck, "class of parts that limits the machine, found by relaxing each in turn");
  v.section("cycle_noise", r.cycle_noise,
            "interval of engine.cycles in which those with another seed of the picture lie, by simulations with other "
            "seeds; found with the bottleneck, and not where a resource stops");
  v.section("faults", r.faults, "faults that were asked for and their cost");
  v.section("verify", r.verify, "comparison with the reference tracer, if asked for");
  v.section("digest", r.digest, "digests of the result: equal digests mean equal hits and an equal picture");
  v.section("host", r.host, "everything that depends on the host and on time");
  v.field("checksum", r.checksum, "", kChecksumMeaning);
}

}  // namespace carousel::report
