#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/run/cull_planes.h"
#include "report/run/traffic.h"

namespace carousel::report {

// The report of one run (DESIGN.md section 9, a contract): plain structs, filled by app/. Units and meanings
// stand in report/run/report_fields.h. What is std::optional is left out of the file when absent, which is how an
// engine without a simulated clock leaves out what needs one.

struct Program {
  std::string version, commit, compiler, build_type;
  bool checked = false;
};

struct Bounds {
  std::array<double, 3> lo{}, hi{};
};

struct SceneSummary {
  std::string name;
  std::uint64_t triangles = 0, instanced_triangles = 0, meshes = 0, instances = 0, materials = 0, textures = 0;
  std::uint64_t lights = 0, cameras = 0;
  Bounds bounds;
  std::vector<std::string> warnings;
};

/// Digests of what happened, one a stretch of the run.
struct Epochs {
  std::uint64_t cycles_each = 0;
  std::vector<std::string> digests;
};

struct Engine {
  std::string kind;
  std::optional<std::uint64_t> cycles{};
  std::optional<Epochs> epochs{};
  bool deterministic = false;
  std::string reason;
};

struct RaysByKind {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
};

struct Rays {
  std::uint64_t emitted = 0, completed = 0, lost = 0, restarted = 0, paths_restarted = 0;
  RaysByKind by_kind;
};

/// Simulated speed; steady: between a quarter and three quarters of the rays.
struct Rate {
  double rays_per_kilocycle = 0, mrays_per_second_at_clock = 0;
};

struct Throughput {
  double packets_per_ray = 0, hops_per_ray = 0, tests_per_ray = 0;
  std::optional<Rate> whole{}, steady{};
};

struct TestKind {
  std::uint64_t count = 0;
  double per_ray = 0;
};

/// What became of the child boxes that bundles were tested against, at one depth or in all.
struct BundleTests {
  std::uint64_t depth = 0, all_hit = 0, all_miss = 0, split = 0;
  std::uint64_t box_tests_spared = 0;
  std::int64_t ray_reads_spared = 0;
};

struct Bundles {
  std::uint64_t formed = 0;
  double rays_mean = 0;
  BundleTests sum;
  std::int64_t ray_bytes_spared = 0;
  std::vector<BundleTests> by_depth;
};

struct Tests {
  TestKind box, plane, triangle, bundle, transforms, inversions{}, culled{}, ray_reads{};
  std::optional<TestKind> procedural{}, any_hit{};
  std::optional<Bundles> bundles{};
};

struct Packets {
  std::uint64_t issued = 0, retired = 0, hops = 0;
  double rays_mean = 0, local_fraction = 0, bubble_fraction = 0;
  std::optional<Latency> latency{};
};

struct Collections {
  std::uint64_t created = 0, peak = 0;
  double fullness_mean = 0;
  std::uint64_t memberships_peak = 0, spilled = 0;
};

struct Stalls {
  std::uint64_t credits = 0, link = 0, slots = 0, storage = 0, reserve = 0;
};

/// Cycles of a group of equal units; the parts add up to the run.
struct UnitCycles {
  std::uint64_t busy = 0, other_units = 0, memory = 0, link = 0, credits = 0, storage = 0, shading = 0, idle = 0;
};

struct Units {
  UnitCycles box, triangle, transform;
  std::uint64_t handler_busy = 0, handler_idle = 0;
  std::optional<UnitCycles> plane{}, bundle{}, ray_reads{}, procedural{}, any_hit{};
};

/// What moved onto the stacks of a resource's rays and from them.
struct Stack {
  std::uint64_t pushed_bytes = 0, popped_bytes = 0, peak_bytes = 0, ray_peak_bytes = 0;
};

/// Model-space rays kept beside the records.
struct TransformedRays {
  std::uint64_t written_bytes = 0, read_bytes = 0, peak_bytes = 0;
};

struct Resource {
  std::uint64_t resource = 0;
  std::uint64_t rays_admitted = 0, rays_completed = 0;
  std::uint64_t packets_issued = 0, packets_retired = 0, packets_seen = 0, bubbles = 0, hops = 0;
  std::uint64_t rays_tested = 0, box_tests = 0, triangle_tests = 0, transforms = 0;
  std::uint64_t collections_created = 0, collections_peak = 0, memberships_peak = 0, spilled = 0;
  Stalls stalls;
  std::optional<Units> units{};
  std::optional<Stack> stack{};
  std::optional<TransformedRays> transformed_rays{};
};

struct LinkCycles {
  std::uint64_t busy = 0, stalled = 0, idle = 0;
};

/// How full a link was for a while.
struct LinkOccupancy {
  double seconds = 0, mean = 0;
  std::uint64_t most = 0;
};

/// What faults did to a link.
struct LinkFaults {
  std::uint64_t dropped = 0, duplicated = 0, corrupted = 0, reordered = 0, delayed = 0, resent = 0, discarded = 0;
};

struct Link {
  std::uint64_t from = 0, to = 0, depth = 0, packets = 0;
  double occupancy_mean = 0;
  std::uint64_t occupancy_max = 0, stalled = 0;
  std::optional<double> utilisation{};
  std::optional<LinkCycles> cycles{};
  std::optional<std::string> queue{};
  std::optional<double> sent_at_once{}, received_at_once{};
  std::optional<std::uint64_t> full_stalls{}, empty_stalls{};
  std::optional<std::vector<LinkOccupancy>> occupancy{};
  std::optional<LinkFaults> faults{};
};

struct Cache {
  std::uint64_t requests = 0, lines = 0, hits = 0, merged = 0, misses = 0;
  double hit_fraction = 0;
};

struct Memory {
  std::vector<Cache> caches;
  std::uint64_t dram_lines = 0, dram_bytes = 0, dram_busy_cycles = 0;
  double dram_utilisation = 0;
};

/// What a class of parts alone would allow.
struct BoundClass {
  std::string name;
  double rays_per_kilocycle = 0;
};

struct Bound {
  double rays_per_kilocycle = 0, reached = 0;
  std::vector<BoundClass> classes;
};

struct BottleneckGain {
  std::string name, action;
  double rays_per_kilocycle = 0, gain = 0;
};

struct Bottleneck {
  std::string limits, verdict;
  double rays_per_kilocycle = 0, noise = 0;
  std::uint64_t paths = 0;
  std::vector<BottleneckGain> gains;
};

struct EffectCost {
  std::uint64_t rays = 0, texture_reads = 0, path_state_bytes = 0, cycles_per_hit = 0, cycles_per_path = 0;
};

struct Effect {
  std::string name;
  bool on = false, called_for = false;
  std::uint64_t callers = 0;
  std::string why;
  EffectCost cost;
};

/// Materials by what they need of the shader, and bytes that no effect needs.
struct ShaderClass {
  std::string name;
  std::uint64_t materials = 0;
};
struct EffectsSaved {
  std::uint64_t path_state_bytes = 0, images_not_decoded = 0;
};

/// What `verify: effects` found.
struct EffectsProof {
  bool same_hits = false, same_image = false;
  std::int64_t rays_spared = 0, tests_spared = 0;
  std::optional<std::int64_t> cycles_spared{};
};

struct Shading {
  std::uint64_t workers = 0, shaded = 0, saturated = 0;
  std::optional<double> utilisation;
  std::vector<Effect> effects;
  std::string effects_choice;
  std::uint64_t path_state_bytes = 0;
  EffectsSaved saved;
  std::vector<ShaderClass> classes;
  std::optional<EffectsProof> proof{};
};

/// A resource that stopped for good, and what became of its work.
struct Stop {
  std::uint64_t resource = 0, packets_discarded = 0;
  std::optional<std::uint64_t> stopped_cycle{}, noticed_cycle{}, restarted_cycle{};
};

/// What went wrong on request, and what it cost.
struct Faults {
  std::optional<Stop> stop{};
  std::optional<std::uint64_t> cycles_without{};
  std::optional<std::int64_t> cycles_lost{};
  std::optional<bool> same_hits{};
};

struct Verify {
  std::uint64_t compared = 0, mismatches = 0;
  std::string example;
};

struct Digest {
  std::string hits;
  std::optional<std::string> image;
};

struct Machine {
  std::string cpu, system;
  std::uint64_t cores = 0, memory_bytes = 0;
};

struct Host {
  std::uint64_t threads = 0;
  double wall_seconds = 0, rays_per_second = 0, scene_seconds = 0, build_seconds = 0;
  std::uint64_t accel_bytes = 0, peak_memory_bytes = 0;
  std::string simd;
  Machine machine;
  std::optional<double> plane_seconds{}, raster_seconds{}, recovery_seconds{}, all_effects_seconds{};
};

/// The pass that stands in for camera rays.
struct Raster {
  std::uint64_t triangles = 0, binned = 0, tested = 0, any_hit_calls = 0;
  std::uint64_t hits = 0, misses = 0, left_to_rays = 0;
};

struct Report {
  std::int64_t schema_version = 1;
  bool incomplete = false;
  Program carousel;
  nlohmann::ordered_json config = nlohmann::ordered_json::object();
  SceneSummary scene;
  Engine engine;
  Rays rays;
  std::optional<Raster> raster;
  std::optional<Throughput> throughput;
  std::optional<Tests> tests;
  std::optional<CullPlanes> cull_planes;
  std::optional<Packets> packets;
  std::optional<Collections> collections;
  std::optional<std::vector<Resource>> resources;
  std::optional<std::vector<Link>> links;
  std::optional<Memory> memory;
  std::optional<Traffic> traffic;
  Shading shading;
  std::optional<Bound> bound;
  std::optional<Bottleneck> bottleneck;
  std::optional<Faults> faults;
  std::optional<Verify> verify;
  Digest digest;
  Host host;
};

}  // namespace carousel::report
