#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "core/config/enum_names.h"

namespace carousel::config {

// The one description of the configuration: key, range, unit and meaning of every field; defaults stand in
// core/config/config.h. Reader, writer, schema and documentation are visitors of it. A visitor V offers
//   field(key, value, [range,] unit, meaning)   integers, reals, colours; texts and switches without a range
//   field_or_auto(key, optional integer, range, unit, meaning)
//   choice(key, enum or optional enum, meaning)
//   section(key, struct or optional struct, meaning)
//   section_or_number(key, struct, meaning)     a bare number stands for {units: number}
//   list(key, vector of struct, meaning)
//   effects, workload, vary(key, value, meaning)   the three with a syntax of their own

struct IntRange {
  std::int64_t min, max;
};

/// A closed range, or without its lower end.
struct RealRange {
  double min, max;
  bool above_min = false;
};

inline constexpr std::int64_t kMaxResources = 256;
inline constexpr std::int64_t kMaxSlots = 1 << 22;
// A ray ID is 32 bits: the resource's number and the slot's have to fit.
static_assert(std::bit_width(std::uint64_t(kMaxResources - 1)) + std::bit_width(std::uint64_t(kMaxSlots - 1)) <= 32);

inline constexpr IntRange kSeed{0, std::numeric_limits<std::int64_t>::max()};
inline constexpr IntRange kCycles{1, 1'000'000};

template <class V>
void describe(V& v, SkyConfig& c) {
  v.field("color", c.color, RealRange{0, 1e6}, "linear RGB", "colour of the sky");
  v.field("strength", c.strength, RealRange{0, 1e6}, "", "multiplies the colour; 0 is no sky");
}

template <class V>
void describe(V& v, SceneConfig& c) {
  v.field("file", c.file, "", "glTF file, relative to the config's folder, then to the working one");
  v.choice("builtin", c.builtin, "generated scene, instead of a file");
  v.field("procedural", c.procedural, "",
          "built-in spheres: procedural primitives, as many as there would be of triangles");
  v.field("triangles", c.triangles, IntRange{1, 100'000'000}, "triangles",
          "built-in spheres, terrain, sliver: about this many in all");
  v.field("instances", c.instances, IntRange{1, 10'000'000}, "instances", "built-in scene of instances: how many");
  v.field("seed", c.seed, kSeed, "", "varies a built-in scene");
  v.field("camera", c.camera, IntRange{0, 65535}, "", "index among the scene's cameras");
  v.section("sky", c.sky, "constant sky; absent: the built-in scene's own, or for a file the default");
}

template <class V>
void describe(V& v, CameraConfig& c) {
  v.field("aperture", c.aperture, RealRange{0, 1e6}, "scene units", "diameter of the lens; 0 is a pinhole");
  v.field("focus_distance", c.focus_distance, RealRange{0, 1e9, true}, "scene units", "distance of the plane in focus");
}

template <class V>
void describe(V& v, ImageConfig& c) {
  v.field("width", c.width, IntRange{1, 16384}, "pixels", "width of the picture");
  v.field("height", c.height, IntRange{1, 16384}, "pixels", "height of the picture");
  v.field("samples", c.samples, IntRange{1, 65536}, "paths per pixel", "samples of each pixel");
  v.field("max_depth", c.max_depth, IntRange{1, 64}, "surfaces", "surfaces a path may visit; 1 is direct light only");
  v.field("seed", c.seed, kSeed, "", "seed of all random numbers of the picture");
}

template <class V>
void describe(V& v, EngineConfig& c) {
  v.choice("kind", c.kind, "native: worker threads and real queues; cycle: virtual time");
  v.field_or_auto("threads", c.threads, IntRange{1, 1024}, "threads",
                  "worker threads; auto is as many as the machine has cores");
  v.field("clock_mhz", c.clock_mhz, IntRange{1, 100'000}, "MHz", "clock of the simulated machine");
  v.choice("simd", c.simd, "instruction set of the test kernels; auto is the best this machine has");
  v.field("what_if", c.what_if, "",
          "cycle: find the bottleneck by simulating the first rays again with each class of parts lifted");
}

template <class V>
void describe(V& v, LinkConfig& c) {
  v.choice("queue", c.queue, "queue that carries a link in the native engine");
  v.field("depth", c.depth, IntRange{1, 65536}, "packets", "packets a link holds");
  v.field("latency_cycles", c.latency_cycles, kCycles, "cycles", "time a packet takes over a link");
  v.field("bytes_per_cycle", c.bytes_per_cycle, IntRange{1, 65536}, "bytes/cycle", "width of a link");
}

template <class V>
void describe(V& v, TesterUnits& c) {
  v.field("units", c.units, IntRange{1, 1024}, "units", "testers of this kind in a resource");
  v.field("interval_cycles", c.interval_cycles, kCycles, "cycles", "a unit starts a test this often");
  v.field("latency_cycles", c.latency_cycles, kCycles, "cycles", "from the start of a test to its result");
}

template <class V>
void describe(V& v, TestersConfig::Simd& c) {
  v.field("lanes", c.lanes, IntRange{1, 64}, "lanes", "tests a unit does side by side");
  v.choice("map", c.map, "what the lanes hold: rays against one shape, or shapes against one ray");
}

template <class V>
void describe(V& v, TestersConfig& c) {
  v.section_or_number("box", c.box, "ray against box");
  v.section_or_number("triangle", c.triangle, "ray against triangle");
  v.section_or_number("plane", c.plane, "ray against cull plane");
  v.section_or_number("bundle", c.bundle, "bundle of rays against box");
  v.section_or_number("transform", c.transform, "ray from world to model space");
  v.section_or_number("procedural", c.procedural, "ray against procedural primitive");
  v.section_or_number("any_hit_unit", c.any_hit_unit, "whether a primitive lets a ray through, with any_hit: inline");
  v.section("simd", c.simd, "lanes of the testers");
  v.field("contexts", c.contexts, IntRange{1, 64}, "packets", "packets a resource has in test at once");
  v.choice("any_hit", c.any_hit, "cycle: where opacity is looked up: at the tester, or by a shader worker");
}

template <class V>
void describe(V& v, ResourceOverride& c) {
  v.field("resource", c.resource, IntRange{0, kMaxResources - 1}, "", "number of the resource");
  v.section("testers", c.testers, "its testers, where they differ from the rest");
}

template <class V>
void describe(V& v, TopologyConfig& c) {
  v.field("resources", c.resources, IntRange{1, kMaxResources}, "resources", "compute resources");
  v.choice("shape", c.shape, "how the resources are linked");
  v.field("rings", c.rings, IntRange{1, 64}, "rings", "for multi_ring");
  v.field("groups", c.groups, IntRange{1, kMaxResources}, "groups", "for hierarchical");
  v.choice("form", c.form, "for central");
  v.choice("visit", c.visit, "whether a packet is handled by all resources or by the owners of its rays only");
  v.choice("flow", c.flow, "what keeps the ring from filling up; none needs --force");
  v.section("link", c.link, "every link");
  v.list("overrides", c.overrides, "resources that differ from the rest");
}

template <class V>
void describe(V& v, RaysConfig& c) {
  v.field("slots_per_resource", c.slots_per_resource, IntRange{1, kMaxSlots}, "rays",
          "rays a resource stores at a time");
  v.choice("placement", c.placement, "which resource takes a new ray");
  v.field("reads_per_cycle", c.reads_per_cycle, IntRange{0, 1024}, "records/cycle",
          "cycle: rays or bundles whose data a resource's testers get from its store; 0: as many as they want");
}

template <class V>
void describe(V& v, PacketsConfig& c) {
  v.field("rays", c.rays, IntRange{1, 1024}, "rays", "ray IDs a packet carries at most");
  v.choice("shapes", c.shapes, "a packet carries all shapes below one node, or a single one");
  v.choice("carry", c.carry, "a packet carries a reference to its shapes, or their data");
  v.choice("results", c.results, "how hits travel back to the packet's owner");
  v.field("ids_per_cycle", c.ids_per_cycle, IntRange{1, 1024}, "ray IDs/cycle",
          "of a packet that a resource looks at, to find its own or to gather hits");
}

template <class V>
void describe(V& v, CollectionsConfig& c) {
  v.field("ready", c.ready, IntRange{1, 65536}, "rays",
          "rays that make a collection ready; more than packets.rays go out in several packets");
  v.choice("traversal", c.traversal, "how a ray goes down the tree");
  v.choice("policy", c.policy, "which collection is tested next");
  v.choice("select", c.select, "full collections first, or the policy alone");
  v.choice("home", c.home, "where the collections of a packet's hits live");
  v.field("capacity", c.capacity, IntRange{1, 1 << 30}, "ray IDs per resource", "room for collections");
  v.choice("when_full", c.when_full, "keep a reserve and hold new rays back, or spill to memory");
}

template <class V>
void describe(V& v, BvhConfig& c) {
  v.field("width", c.width, IntRange{2, 8}, "children", "children of an inner node at most");
  v.field("leaf_triangles", c.leaf_triangles, IntRange{1, 16}, "triangles", "triangles of a leaf at most");
  v.field("treelet_triangles", c.treelet_triangles, IntRange{1, 1 << 24}, "triangles",
          "size of the subtrees that traversal: treelet crosses in one visit");
  v.choice("elements", c.elements, "what bounds the children of a node");
  v.field(
      "mixed_triangles", c.mixed_triangles, IntRange{0, 16}, "triangles",
      "leaves of so many at most are tested with their parent's other children, without a box of their own; 0 is none");
}

template <class V>
void describe(V& v, AccuracyConfig& c) {
  v.choice("triangle", c.triangle,
           "ray against triangle: fast leaks at shared edges, watertight does not, double is that in 64 bits, exact "
           "decides without rounding");
  v.choice(
      "box", c.box,
      "ray against box: plain drops some boxes that rays graze, conservative widens them to drop none, double does "
      "so in 64 bits");
  v.choice("transform", c.transform,
           "ray from world to model space: one inverse matrix; the translation first; that in fp64, rounded once; "
           "the translation first and a rotation's transpose for its inverse");
  v.choice("spawn", c.spawn,
           "how far from its surface a new ray starts: 1e-4 scene units; 256 ulp (Waechter, Binder 2019); as far as "
           "rounding can reach");
  v.choice("transformed_ray", c.transformed_ray,
           "cycle: a ray is brought to model space at each visit, or once an instance and kept (24 bytes)");
  v.choice(
      "instance_data", c.instance_data,
      "cycle: what is stored of an instance: its matrix, the inverse of the linear part beside the translation, or "
      "the inverse matrix; absent: what the transform reads");
  v.choice("invert", c.invert, "cycle: when a stored matrix is inverted; absent: at a visit if it is stored forward");
}

template <class V>
void describe(V& v, CullPlanesConfig& c) {
  v.field("count", c.count, IntRange{0, 8}, "planes per child", "cull planes at most; 0 is none");
  v.choice("nodes", c.nodes, "children that get planes");
  v.field("shared_normals", c.shared_normals, "", "siblings share their planes' normals");
  v.choice("fit", c.fit,
           "what the planes of inner children and instances are moved up to; those of leaves to vertices");
  v.choice("levels", c.levels, "nodes below the instances, above them, where the leaves are instances, or all");
  v.choice("order", c.order,
           "a child's planes are tested after its box has been hit, or before, which then may need no test");
}

template <class V>
void describe(V& v, BundlesConfig::Builder& c) {
  v.field("open", c.open, IntRange{1, 1024}, "bundles", "bundles that still take rays");
  v.field("rays_per_cycle", c.rays_per_cycle, IntRange{1, 1024}, "rays/cycle", "cycle: rays the builder looks at");
  v.field("age", c.age, IntRange{1, 1'000'000}, "rays", "rays looked at before an open bundle is sent on as it is");
  v.choice("similarity", c.similarity, "what must stay small when a ray joins");
  v.choice("measure", c.measure, "whether the threshold is of the size itself or of its growth by the ray");
  v.field("threshold", c.threshold, RealRange{0, 1e6}, "",
          "absolute: of the scene's size for origins, of a unit vector for directions; percent: growth");
  v.field("same_origin", c.same_origin, "", "only rays that start at one point join");
  v.field("same_signs", c.same_signs, "", "only rays whose directions lie in one octant join");
}

template <class V>
void describe(V& v, BundlesConfig::SplitBelow& c) {
  v.field("depth", c.depth, IntRange{0, 255}, "strips", "bundles split below this depth");
  v.field("box_size", c.box_size, RealRange{0, 1}, "of the scene's size", "bundles split at nodes smaller than this");
}

template <class V>
void describe(V& v, BundlesConfig::SplitAbove& c) {
  v.field("spread", c.spread, RealRange{0, 2}, "of the longest component",
          "bundles split whose directions differ by more along an axis; 0: none");
  v.field("silhouette_area", c.silhouette_area, RealRange{0, 1e9}, "of the node's mean face",
          "bundles split whose cross-section at a node is larger; 0: none");
}

template <class V>
void describe(V& v, BundlesConfig& c) {
  v.field("size", c.size, IntRange{0, 64}, "rays", "rays of a bundle at most; 0 is no bundles");
  v.choice("form", c.form, "how a bundle is tested");
  v.choice("edges", c.edges, "cycle: whether a silhouette's edges are tested one after another");
  v.choice("order", c.order, "which of the bundle's tests come first");
  v.field("strict", c.strict, "", "a bundle goes down whole only if each of its rays surely hits the box");
  v.choice("lifetime", c.lifetime, "whether bundles stay together from node to node");
  v.section("builder", c.builder, "which rays make a bundle");
  v.choice("sources", c.sources, "rays that bundles are made of");
  v.choice("split", c.split, "where the rays of a split bundle go: on their own, or to the builder");
  v.field("min_rays", c.min_rays, IntRange{2, 64}, "rays", "fewer than these travel on their own");
  v.section("split_below", c.split_below, "where bundles are split whatever they hit");
  v.section("split_above", c.split_above, "how wide bundles are split whatever they hit");
  v.choice("at_instances", c.at_instances,
           "at an instance with a transform bundles split, or are bounded anew in its space");
  v.choice("hint", c.hint, "what shaders say of rays that left by a wide lobe: that they be left out of bundles");
}

template <class V>
void describe(V& v, MemoryConfig& c) {
  v.field("l2_kib", c.l2_kib, IntRange{1, 1 << 20}, "KiB", "shared cache");
  v.field("line_bytes", c.line_bytes, IntRange{16, 1024}, "bytes", "cache line");
  v.field("ways", c.ways, IntRange{1, 64}, "ways", "associativity of the shared cache");
  v.field("shared_by", c.shared_by, IntRange{1, kMaxResources}, "resources", "resources that share one cache");
  v.field("l2_latency_cycles", c.l2_latency_cycles, kCycles, "cycles", "a hit in the shared cache");
  v.field("dram_latency_cycles", c.dram_latency_cycles, kCycles, "cycles", "a miss");
  v.field("dram_bytes_per_cycle", c.dram_bytes_per_cycle, IntRange{1, 65536}, "bytes/cycle", "memory bandwidth");
  v.choice("fetch", c.fetch, "who fetches shape data: the packet's issuer, each resource, or one for all");
  v.field("fetch_ahead", c.fetch_ahead, IntRange{0, 64}, "packets", "packets whose shapes are fetched in advance");
  v.field("shape_buffer_kib", c.shape_buffer_kib, IntRange{1, 1 << 20}, "KiB", "shape data a resource holds");
}

template <class V>
void describe(V& v, RayFlags& c) {
  v.choice("cull", c.cull, "triangles that are not there for these rays: those that show their back, or their front");
  v.field("force_opaque", c.force_opaque, "", "nothing lets these rays through");
}

template <class V>
void describe(V& v, ShadingConfig& c) {
  v.field("workers", c.workers, IntRange{1, 256}, "workers", "shader workers");
  v.effects("effects", c.effects,
            "effects of light: what the scene calls for, all (nothing is specialised), or of what it calls for only "
            "those named");
  v.field("idle_resources_shade", c.idle_resources_shade, "", "idle resources help the shader workers");
  v.field("cycles_per_shade", c.cycles_per_shade, IntRange{0, 1'000'000}, "cycles",
          "time to shade one ray, where it hit a plain surface or nothing");
  v.field("cycles_per_effect", c.cycles_per_effect, IntRange{0, 1'000'000}, "cycles",
          "time for each texture or layer besides that the surface has, or with effects: all might have");
  v.field("cycles_per_any_hit", c.cycles_per_any_hit, IntRange{0, 1'000'000}, "cycles",
          "time to tell whether a primitive lets a ray through, with testers.any_hit: shader");
  v.section("camera_rays", c.camera_rays, "what the shaders want of camera rays");
  v.section("bounce_rays", c.bounce_rays, "the same of bounce rays");
  v.section("shadow_rays", c.shadow_rays, "and of shadow rays");
  v.choice("distribute", c.distribute, "which worker gets a completed ray");
}

template <class V>
void describe(V& v, TrafficConfig& c) {
  v.choice("pattern", c.pattern, "where packets go");
  v.field("rate", c.rate, RealRange{0, 1, true}, "packets per resource and cycle", "packets injected");
  v.field("packets", c.packets, IntRange{1, 1'000'000'000'000}, "packets", "packets in all, warm-up included");
  v.field("packet_bytes", c.packet_bytes, IntRange{1, 65535}, "bytes", "size of a packet");
  v.field("inject_cycles", c.inject_cycles, IntRange{0, 1'000'000}, "cycles",
          "from a packet's creation to its start on a free link");
  v.field("eject_cycles", c.eject_cycles, IntRange{0, 1'000'000}, "cycles",
          "from a packet's arrival at its last resource to its delivery");
  v.field("warmup_fraction", c.warmup_fraction, RealRange{0, 0.9}, "",
          "part of the time in which packets are created that goes by before anything is measured");
  v.field("hotspot", c.hotspot, IntRange{0, kMaxResources - 1}, "", "for hotspot: the resource");
  v.field("hotspot_fraction", c.hotspot_fraction, RealRange{0, 1}, "",
          "for hotspot: part of the packets that go there; the rest goes anywhere");
  v.field("burst_packets", c.burst_packets, IntRange{1, 1'000'000}, "packets",
          "for bursty: packets created cycle after cycle, on average");
}

inline constexpr RealRange kFaultFraction{0, 0.9};  // something must get through

template <class V>
void describe(V& v, FaultsConfig::Links& c) {
  v.field("drop", c.drop, kFaultFraction, "fraction", "frames that are lost");
  v.field("duplicate", c.duplicate, kFaultFraction, "fraction", "frames that come twice");
  v.field("corrupt", c.corrupt, kFaultFraction, "fraction", "frames with a bit flipped");
  v.field("reorder", c.reorder, kFaultFraction, "fraction", "frames that come after the next one");
  v.field("delay", c.delay, kFaultFraction, "fraction", "frames that come later");
  v.field("delay_cycles", c.delay_cycles, kCycles, "cycles", "by so much; native: at engine.clock_mhz");
}

template <class V>
void describe(V& v, FaultsConfig::Resource& c) {
  v.choice("kind", c.kind, "what befalls a resource: pause (once), slow (to the end), stop (for good), or none");
  v.field("number", c.number, IntRange{0, kMaxResources - 1}, "", "which resource");
  v.field("after_rays", c.after_rays, IntRange{0, 1'000'000'000}, "rays", "completed there before it begins");
  v.field("cycles", c.cycles, IntRange{1, 1'000'000'000}, "cycles", "length of a pause; native: at engine.clock_mhz");
  v.field("factor", c.factor, IntRange{2, 1000}, "times", "slow: a step takes so many times as long");
  v.field("recover", c.recover, "",
          "stop: start its unfinished rays again elsewhere; or else end the run and say what is missing");
  v.field("silence_cycles", c.silence_cycles, IntRange{1, 1'000'000'000}, "cycles",
          "stop: without a sign of life before ray control gives it up; native: 100 ms");
}

template <class V>
void describe(V& v, FaultsConfig& c) {
  v.field("seed", c.seed, kSeed, "", "seed of the faults");
  v.section("links", c.links, "faults of links, which sequence numbers, checksums and go-back-N make good");
  v.section("resource", c.resource, "fault of a resource");
  v.field("compare", c.compare, "", "engine.kind: cycle: simulate once more without faults and report what they cost");
}

template <class V>
void describe(V& v, Config& c) {
  v.field("schema_version", c.schema_version, IntRange{1, 1}, "", "version of these keys");
  v.section("scene", c.scene, "what is rendered");
  v.section("camera", c.camera, "lens of the camera");
  v.section("image", c.image, "picture and paths");
  v.section("engine", c.engine, "how the simulation runs");
  v.section("topology", c.topology, "resources and links");
  v.section("rays", c.rays, "storage of rays");
  v.section("packets", c.packets, "what travels");
  v.section("collections", c.collections, "rays that wait for a node");
  v.section("bvh", c.bvh, "acceleration structure");
  v.section("accuracy", c.accuracy, "arithmetic of the tests");
  v.section("cull_planes", c.cull_planes, "planes that mark parts of boxes as empty");
  v.section("bundles", c.bundles, "similar rays tested as one");
  v.section("testers", c.testers, "test units of a resource; a bare number is units");
  v.section("memory", c.memory, "caches and memory of the simulated machine");
  v.section("shading", c.shading, "shader workers and effects");
  v.choice(
      "primary", c.primary,
      "how what the camera sees first is found: by its rays, or by a rasteriser (pinhole cameras only) that leaves "
      "the other rays to the machine");
  v.section("faults", c.faults, "what goes wrong on request");
  v.choice("verify", c.verify,
           "reference: trace every ray again, depth first, and compare; effects: run again with all effects and "
           "compare the picture");
  v.workload("workload", c.workload, "rays of the picture, rays of a file, or synthetic traffic");
  v.vary("vary", c.vary, "for sweep: values of keys, key.path: [a, b, c]");
}

}  // namespace carousel::config
