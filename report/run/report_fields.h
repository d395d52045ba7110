#pragma once

#include "report/run/cull_plane_fields.h"
#include "report/run/link_fields.h"
#include "report/run/report.h"
#include "report/run/resource_fields.h"
#include "report/run/shading_fields.h"
#include "report/run/traffic_fields.h"

namespace carousel::report {

// The one description of the report: key, unit and meaning of every field. The JSON writer and the schema are
// visitors of it. A visitor V offers
//   field(key, value, unit, meaning)      numbers, switches, texts, lists of texts, triples
//   section(key, value, meaning)          structs; lists of structs; either of them optional
//   any(key, value, meaning)              JSON that has a schema of its own
// Counts that depend on scheduling differ from run to run in the native engine with several threads.

template <class V>
void describe(V& v, Program& r) {
  v.field("version", r.version, "", "version of the program");
  v.field("commit", r.commit, "", "commit it was built from");
  v.field("compiler", r.compiler, "", "compiler and its version");
  v.field("build_type", r.build_type, "", "CMake's build type");
  v.field("checked", r.checked, "", "whether every invariant was checked while running");
}

template <class V>
void describe(V& v, Bounds& r) {
  v.field("lo", r.lo, "scene units", "least corner");
  v.field("hi", r.hi, "scene units", "greatest corner");
}

template <class V>
void describe(V& v, SceneSummary& r) {
  v.field("name", r.name, "", "file or built-in scene");
  v.field("triangles", r.triangles, "triangles", "of all meshes");
  v.field("instanced_triangles", r.instanced_triangles, "triangles", "of all instances");
  v.field("meshes", r.meshes, "meshes", "meshes");
  v.field("instances", r.instances, "instances", "placements of meshes");
  v.field("materials", r.materials, "materials", "materials");
  v.field("textures", r.textures, "textures", "textures");
  v.field("lights", r.lights, "lights", "point, spot and directional lights");
  v.field("cameras", r.cameras, "cameras", "cameras");
  v.section("bounds", r.bounds, "world-space box around all instances");
  v.field("warnings", r.warnings, "", "what was passed over on import");
}

template <class V>
void describe(V& v, Epochs& r) {
  v.field("cycles_each", r.cycles_each, "cycles", "length of an epoch");
  v.field("digests", r.digests, "", "64 bits an epoch over all that happened in it");
}

template <class V>
void describe(V& v, Engine& r) {
  v.field("kind", r.kind, "", "native or cycle");
  v.field("cycles", r.cycles, "cycles", "simulated, until everything had come to rest");
  v.section("epochs", r.epochs, "where two runs that differ begin to, see carousel compare");
  v.field("deterministic", r.deterministic, "", "whether everything outside of host is the same in every run");
  v.field("reason", r.reason, "", "why");
}

template <class V>
void describe(V& v, RaysByKind& r) {
  v.field("camera", r.camera, "rays", "from the camera");
  v.field("bounce", r.bounce, "rays", "from a surface, closest hit");
  v.field("shadow", r.shadow, "rays", "from a surface, any hit");
}

template <class V>
void describe(V& v, Rays& r) {
  v.field("emitted", r.emitted, "rays", "that shading produced");
  v.field("completed", r.completed, "rays", "that shading got back");
  v.field("lost", r.lost, "rays", "emitted and never completed; 0 in a complete run");
  v.field("restarted", r.restarted, "rays", "under way when a resource stopped, and traced again from the root");
  v.field("paths_restarted", r.paths_restarted, "(pixel, sample)s",
          "unfinished, that these rays belong to; what they had gathered before was kept");
  v.section("by_kind", r.by_kind, "emitted rays by kind");
}

template <class V>
void describe(V& v, Rate& r) {
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles", "completed rays");
  v.field("mrays_per_second_at_clock", r.mrays_per_second_at_clock, "Mrays/s", "at engine.clock_mhz");
}

template <class V>
void describe(V& v, Throughput& r) {
  v.field("packets_per_ray", r.packets_per_ray, "packets/ray", "packets issued for each completed ray");
  v.field("hops_per_ray", r.hops_per_ray, "hops/ray", "links crossed by packets for each completed ray");
  v.field("tests_per_ray", r.tests_per_ray, "tests/ray",
          "box, plane, triangle, procedural and bundle tests for each ray");
  v.section("whole", r.whole, "simulated speed from the first cycle to the last");
  v.section("steady", r.steady, "without fill and drain: between a quarter and three quarters of the rays");
}

template <class V>
void describe(V& v, TestKind& r) {
  v.field("count", r.count, "tests", "in all");
  v.field("per_ray", r.per_ray, "tests/ray", "for each completed ray");
}

template <class V>
void describe(V& v, BundleTests& r) {
  v.field("depth", r.depth, "strips", "below the root; of the sum, the deepest");
  v.field("all_hit", r.all_hit, "boxes", "every ray of a bundle went on to");
  v.field("all_miss", r.all_miss, "boxes", "no ray of a bundle went on to");
  v.field("split", r.split, "boxes", "left to the single rays");
  v.field("box_tests_spared", r.box_tests_spared, "tests", "ray against box");
  v.field("ray_reads_spared", r.ray_reads_spared, "records",
          "less than without bundles, splitting and dissolving counted");
}

template <class V>
void describe(V& v, Bundles& r) {
  v.field("formed", r.formed, "bundles", "of new rays, and of the rays of split bundles");
  v.field("rays_mean", r.rays_mean, "rays/bundle", "when formed");
  v.section("sum", r.sum, "over all depths");
  v.field("ray_bytes_spared", r.ray_bytes_spared, "bytes", "of the records spared");
  v.section("by_depth", r.by_depth, "from the root down");
}

template <class V>
void describe(V& v, Tests& r) {
  v.section("box", r.box, "ray against box");
  v.section("plane", r.plane, "ray against cull plane");
  v.section("triangle", r.triangle, "ray against triangle");
  v.section("bundle", r.bundle, "bundle of rays against box");
  v.section("transforms", r.transforms, "rays brought from world to model space");
  v.section("inversions", r.inversions, "instances' matrices inverted at a visit, with accuracy.invert: visit");
  v.section("culled", r.culled, "children whose box was hit, which a cull plane showed to be missed");
  v.section("procedural", r.procedural, "ray against procedural primitive, where the scene has any");
  v.section("any_hit", r.any_hit, "whether a primitive lets a ray through, where some may");
  v.section("ray_reads", r.ray_reads, "records of rays or bundles read by testers");
  v.section("bundles", r.bundles, "what they were good for, with bundles.size");
}

template <class V>
void describe(V& v, Packets& r) {
  v.field("issued", r.issued, "packets", "that left their owner's collections");
  v.field("retired", r.retired, "packets", "that came back; equal to issued in a complete run");
  v.field("hops", r.hops, "hops", "links crossed");
  v.field("rays_mean", r.rays_mean, "rays", "members of an issued packet");
  v.field("local_fraction", r.local_fraction, "", "of a packet's members, those that live where it is looked at");
  v.field("bubble_fraction", r.bubble_fraction, "", "of the visits of packets, those without a local ray");
  v.section("latency", r.latency, "from the issue queue until they are home");
}

template <class V>
void describe(V& v, Collections& r) {
  v.field("created", r.created, "collections", "in all");
  v.field("peak", r.peak, "collections", "at once, the resources' peaks added up");
  v.field("fullness_mean", r.fullness_mean, "", "rays of issued packets as a part of packets.rays");
  v.field("memberships_peak", r.memberships_peak, "ray IDs", "at once, the resources' peaks added up");
  v.field("spilled", r.spilled, "ray IDs", "stored beyond the capacity");
}

template <class V>
void describe(V& v, Cache& r) {
  v.field("requests", r.requests, "strips", "asked for");
  v.field("lines", r.lines, "lines", "looked up");
  v.field("hits", r.hits, "lines", "found");
  v.field("merged", r.merged, "lines", "on their way already");
  v.field("misses", r.misses, "lines", "fetched from memory");
  v.field("hit_fraction", r.hit_fraction, "fraction", "hits over lines");
}

template <class V>
void describe(V& v, Memory& r) {
  v.section("caches", r.caches, "each L2");
  v.field("dram_lines", r.dram_lines, "lines", "read");
  v.field("dram_bytes", r.dram_bytes, "bytes", "read");
  v.field("dram_busy_cycles", r.dram_busy_cycles, "cycles", "moving lines");
  v.field("dram_utilisation", r.dram_utilisation, "fraction", "busy cycles over all");
}

template <class V>
void describe(V& v, BoundClass& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "if it were busy all the time, at this work a ray");
}

template <class V>
void describe(V& v, Bound& r) {
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles", "the least of the classes'");
  v.field("reached", r.reached, "fraction", "the whole run's rate over the bound");
  v.section("classes", r.classes, "tightest first");
}

template <class V>
void describe(V& v, BottleneckGain& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("action", r.action, "", "how it was lifted");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "of the machine with it lifted, steady state");
  v.field("gain", r.gain, "fraction", "over the machine as it is");
}

template <class V>
void describe(V& v, Bottleneck& r) {
  v.field("limits", r.limits, "", "class whose lift gains most; empty when none gains 5 %");
  v.field("verdict", r.verdict, "", "the same in words");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "of the machine as it is, over the same rays, steady state");
  v.field("noise", r.noise, "fraction", "by how much the two halves of that steady state differ");
  v.field("paths", r.paths, "paths", "simulated for each lift");
  v.section("gains", r.gains, "greatest first");
}

template <class V>
void describe(V& v, Verify& r) {
  v.field("compared", r.compared, "rays", "traced again, depth first");
  v.field("mismatches", r.mismatches, "rays", "whose hit differs in a bit");
  v.field("example", r.example, "", "one of them, or nothing");
}

template <class V>
void describe(V& v, Digest& r) {
  v.field("hits", r.hits, "", "128 bits over all rays and their hits, in any order");
  v.field("image", r.image, "", "hash of the linear picture; absent when no picture was made");
}

template <class V>
void describe(V& v, Machine& r) {
  v.field("cpu", r.cpu, "", "processor");
  v.field("system", r.system, "", "operating system");
  v.field("cores", r.cores, "cores", "hardware threads");
  v.field("memory_bytes", r.memory_bytes, "bytes", "of the machine");
}

template <class V>
void describe(V& v, Stop& r) {
  v.field("resource", r.resource, "", "which");
  v.field("packets_discarded", r.packets_discarded, "packets",
          "of all resources, that had been issued and not come home");
  v.field("stopped_cycle", r.stopped_cycle, "cycles", "when it took its last step");
  v.field("noticed_cycle", r.noticed_cycle, "cycles", "when ray control gave it up");
  v.field("restarted_cycle", r.restarted_cycle, "cycles",
          "when nothing was under way any more and rays began again; absent when all had come back");
}

template <class V>
void describe(V& v, Faults& r) {
  v.section("stop", r.stop, "a resource that stopped for good");
  v.field("cycles_without", r.cycles_without, "cycles", "that the same takes without faults (faults.compare)");
  v.field("cycles_lost", r.cycles_lost, "cycles", "what the faults cost: engine.cycles less these");
  v.field("same_hits", r.same_hits, "", "whether hits and picture are those of the run without");
}

template <class V>
void describe(V& v, Host& r) {
  v.field("threads", r.threads, "threads", "worker threads");
  v.field("wall_seconds", r.wall_seconds, "s", "of the simulation, verification included, loading and building not");
  v.field("rays_per_second", r.rays_per_second, "rays/s", "completed rays over wall_seconds");
  v.field("scene_seconds", r.scene_seconds, "s", "to load or generate the scene");
  v.field("build_seconds", r.build_seconds, "s", "to build the acceleration structure, without cull planes");
  v.field("plane_seconds", r.plane_seconds, "s", "to find its cull planes");
  v.field("raster_seconds", r.raster_seconds, "s", "to rasterise what the camera sees first");
  v.field("all_effects_seconds", r.all_effects_seconds, "s",
          "that the run took with all effects; wall_seconds is without");
  v.field("recovery_seconds", r.recovery_seconds, "s",
          "from the last sign of life of a resource that stopped until its rays began again");
  v.field("accel_bytes", r.accel_bytes, "bytes", "of the acceleration structure");
  v.field("peak_memory_bytes", r.peak_memory_bytes, "bytes", "resident in the process at most");
  v.field("simd", r.simd, "", "instruction set of the test kernels");
  v.section("machine", r.machine, "what it ran on");
}

template <class V>
void describe(V& v, Raster& r) {
  v.field("triangles", r.triangles, "triangles", "of all instances");
  v.field("binned", r.binned, "triangles", "sorted into tiles, once for each tile");
  v.field("tested", r.tested, "tests", "edge functions of a triangle at a sample");
  v.field("asked", r.any_hit_calls, "samples", "at which a cut-out or veil was asked");
  v.field("hits", r.hits, "samples", "that meet a triangle");
  v.field("misses", r.misses, "samples", "that meet nothing");
  v.field("left_to_rays", r.left_to_rays, "samples", "for which camera rays were sent: near procedural primitives");
}

template <class V>
void describe(V& v, Report& r) {
  v.field("schema_version", r.schema_version, "", "version of these keys");
  v.field("incomplete", r.incomplete, "", "whether the run was interrupted; counts are then partial");
  v.section("carousel", r.carousel, "the program");
  v.any("config", r.config, "resolved configuration; see carousel schema config");
  v.section("scene", r.scene, "what was rendered");
  v.section("engine", r.engine, "how it was simulated");
  v.section("rays", r.rays, "rays; emitted = completed + lost");
  v.section("raster", r.raster, "what found the camera's first hits instead of its rays; absent with primary: rays");
  v.section("throughput", r.throughput, "work for each ray; rates by the wall clock stand in host");
  v.section("tests", r.tests, "tests done");
  v.section("cull_planes", r.cull_planes, "what cull planes take and what they spare, when there are any");
  v.section("packets", r.packets, "packets");
  v.section("collections", r.collections, "rays waiting for a node");
  v.section("resources", r.resources, "each resource");
  v.section("links", r.links, "each link");
  v.section("memory", r.memory, "caches and memory of the simulated machine");
  v.section("traffic", r.traffic, "the network alone, when workload is traffic");
  v.section("shading", r.shading, "shader workers");
  v.section("bound", r.bound, "what each class of parts alone would allow");
  v.section("bottleneck", r.bottleneck, "what limits the machine, found by lifting each class in turn");
  v.section("faults", r.faults, "what went wrong on request and what it cost");
  v.section("verify", r.verify, "comparison with the reference tracer, if asked for");
  v.section("digest", r.digest, "equal digests mean equal hits and an equal picture");
  v.section("host", r.host, "all that depends on the host and on time");
}

}  // namespace carousel::report
