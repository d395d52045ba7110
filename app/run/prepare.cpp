#include "app/run/prepare.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <spdlog/spdlog.h>

#include "accel/builders/build.h"
#include "accel/builders/place_micromaps.h"
#include "accel/planes/cull_planes.h"
#include "accel/traverse/kernels.h"
#include "app/area/machine_area.h"
#include "app/charges/charges.h"
#include "app/host/log.h"
#include "app/host/machine_info.h"
#include "app/run/memory_need.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "core/system/plain_text.h"
#include "core/system/process_memory.h"
#include "report/text/number_text.h"
#include "ringbus/cycle/shapes/shape_room.h"
#include "ringbus/protocol/deadlock.h"
#include "ringbus/results/run_features.h"
#include "scene/model/instance_overlap.h"
#include "scene/moment.h"
#include "scene/place_objects.h"
#include "shading/effects/effects_plan.h"
#include "shading/surface/opacity_states.h"

namespace carousel::app {

namespace {

/// Runs `body`; adds to its ConfigErrors the positions in the user's files; options have none.
template <class Body>
auto with_positions(const KeyPositions& positions, const Body& body) {
  try {
    return body();
  } catch (const ConfigError& error) {
    std::vector<ConfigIssue> issues = error.issues();
    for (ConfigIssue& issue : issues)
      if (issue.position.file.empty() && !issue.key_path.starts_with("--"))
        issue.position = positions.find(issue.key_path);
    throw ConfigError(std::move(issues));
  }
}

/// Refuses a file that a key names and that is not there. `holds`: what it is of.
void require_file(const Prepared& p, const std::string& key, const std::string& name, const char* holds) {
  const std::filesystem::path path = find_beside(p.config_folder, name);
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored)) return;
  throw ConfigError({{p.located.positions.find(key), key,
                      fmt::format("expected a file of {} beside the configuration or in the working directory, "
                                  "found '{}', which is not there",
                                  holds, name)}});
}

/// Refuses a missing list of rays or of memory requests, and missing trees, before the scene is loaded.
void require_files(const Prepared& p) {
  const WorkloadConfig& workload = p.config().workload;
  if (workload.kind == WorkloadConfig::Kind::kMemoryTrace)
    require_file(p, "workload.memory_trace", workload.memory_trace, "memory requests");
  if (workload.kind == WorkloadConfig::Kind::kRaysFrom)
    require_file(p, "workload.rays_from", workload.rays_from, "rays");
  if (p.has_rays() && !p.config().bvh.file.empty()) require_file(p, "bvh.file", p.config().bvh.file, "trees");
}

/// Says what the scene came to, and what was made up for it.
std::string scene_text(const scene::Scene& s) {
  std::string out = fmt::format("{}: {} triangles, {} instances, {} materials", s.name, s.unique_triangle_count(),
                                s.instances.size(), s.materials.size());
  if (s.added.camera) out += s.added.inside ? ", a camera made up inside it" : ", a camera fitted to it";
  if (s.added.sun) out += ", a sun added";
  return out;
}

void load_scene(Prepared& p, const SceneConfig& config) {
  std::optional<Phase> phase(std::in_place, "scene");
  double seconds = 0;
  p.scene = scene::load_scene(
      config, p.config_folder,
      [&](const std::string& warning) {
        if (std::find(p.warnings.begin(), p.warnings.end(), warning) != p.warnings.end()) return;
        spdlog::warn("{}", warning);
        p.warnings.push_back(warning);
      },
      [&](const scene::Scene& s) {
        // From here on images are decoded.
        seconds += phase->seconds();
        phase.emplace("textures");
        return shading::images_read(s, p.config().shading.effects);
      },
      view_of(p.config()), make_executor(p.threads_beside).get());
  scene::place_objects(p.scene, p.config().scene, p.config().primitives, p.config().programs);
  shading::strip_effects(p.scene, p.config().shading.effects);
  std::uint64_t image_bytes = 0;
  for (const scene::Image& image : p.scene.images) image_bytes += image.rgba.size();
  phase->result(p.config().scene.builtin ? scene_text(p.scene)
                                         : fmt::format("{} images, {}; {}", p.scene.images.size(),
                                                       report::bytes_text(image_bytes), scene_text(p.scene)));
  p.scene_seconds = seconds + phase->seconds();
}

void set_query(Prepared& p) {
  if (p.accel.gaussians) require_for_gaussians(p.config(), p.located.positions);
  const QueryConfig& query = p.config().rays.query;
  const bool all = query.hits == Query::kAll, several = query.nearest > 0,
             list = p.config().workload.kind == WorkloadConfig::Kind::kRaysFrom;
  const auto kept = static_cast<std::size_t>(all ? p.config().rays.hits_per_ray : query.nearest);
  p.all_hits = all || (several && list) ? std::make_unique<AllHits>(kept) : nullptr;
  p.nearest_hits = several ? std::make_unique<NearestHits>(p.all_hits.get()) : nullptr;
  p.accel.all_hits = all ? p.all_hits.get() : nullptr;
  p.accel.nearest_hits = p.nearest_hits.get();
}

/// Refuses a scene whose structure cannot be built here, and warns of one that every ray has to search in many places.
void foretell(Prepared& p) {
  constexpr double kManyInstances = 1000;
  if (p.config().scene.placement != ScenePlacement::kPartitioned) {  // else each rank builds a part
    const MemoryNeed need{.scene = scene_bytes(p.scene), .accel = build_bytes(p.scene), .ring = {}};
    require_fit(need, usable_memory_bytes(), p.located.positions);
  }
  const double met = scene::instances_met(p.scene);
  if (met < kManyInstances) return;
  p.warnings.push_back(
      fmt::format("{}: {} instances lie in each other's boxes; a ray meets about {:.0f} of them, and takes as long",
                  p.scene.name, p.scene.instances.size(), met));
  spdlog::warn("{}", p.warnings.back());
}

accel::BuildRanks build_ranks(ringbus::Transport* transport) {
  if (transport == nullptr) return {};
  return {transport->rank(), transport->ranks(),
          [transport](const std::string& bytes) { return transport->gather(bytes); }};
}

/// Adds up the shares of the ranks.
accel::StructureSize whole_structure(const accel::StructureSize& share, ringbus::Transport& ranks) {
  accel::StructureSize sum;
  for (const std::string& bytes : ranks.gather({reinterpret_cast<const char*>(&share), sizeof share})) {
    accel::StructureSize other;
    std::memcpy(&other, bytes.data(), sizeof other);
    sum += other;
  }
  return sum;
}

void make_micromaps(Prepared& p, const BvhConfig::Micromaps& c) {
  Phase phase("micromaps");
  p.micromaps = std::make_unique<scene::OpacityMicromaps>(
      shading::make_micromaps(p.scene, static_cast<int>(c.level), c.states == BvhConfig::Micromaps::States::kFour));
  accel::set_micromaps(p.accel, *p.micromaps);
  const std::string bytes = report::bytes_text(p.micromaps->size_bytes());
  phase.result(fmt::format("{} triangles with a map, {}", p.micromaps->maps(), bytes));
}

void build_accel(Prepared& p, ringbus::Transport* transport) {
  accel::select_simd_target(p.config().engine.simd);
  const auto executor = make_executor(p.threads);
  {
    Phase phase("build");
    const accel::BuildRanks ranks = build_ranks(transport);
    const bool parts = transport != nullptr && p.config().scene.placement == ScenePlacement::kPartitioned;
    const BvhConfig& bvh = p.config().bvh;
    std::optional<accel::TreeFile> trees;
    if (!bvh.file.empty()) trees = accel::read_trees(find_beside(p.config_folder, bvh.file));
    p.accel = accel::build(p.scene, bvh, *executor, p.config().accuracy, {}, parts ? &ranks : nullptr,
                           trees ? &*trees : nullptr);
    p.build_seconds = phase.seconds();
    if (parts) p.structure = whole_structure(accel::structure_size(p.accel), *transport);
    phase.result(fmt::format("{}, {} nodes; kernels {}", report::bytes_text(p.accel.size_bytes()), p.accel.nodes.size(),
                             accel::simd_targets().front()));
  }
  if (p.accel.baked_instances > 0 || p.accel.promoted_instances > 0)
    spdlog::debug(
        "build: {} instances with singular transforms are stored as triangles of the world, rays of {} nearly "
        "singular ones are transformed in double",
        p.accel.baked_instances, p.accel.promoted_instances);
  renew_any_hit(p);
  {
    std::optional<Phase> phase;
    if (p.config().cull_planes.count > 0) phase.emplace("cull planes");
    const auto start = std::chrono::steady_clock::now();
    accel::add_cull_planes(p.accel, p.scene, p.config().cull_planes, *executor);
    p.plane_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (phase) phase->result(fmt::format("{} planes fitted", p.accel.planes.size()));
  }
  set_query(p);
}

/// Refuses a machine that does not fit the prepared structure, and one that the host's memory does not hold.
void require_room(const Prepared& p, bool keep_hits) {
  with_positions(p.located.positions, [&] {
    if (std::vector<ConfigIssue> issues = ringbus::check_storage(p.config(), p.accel); !issues.empty())
      throw ConfigError(std::move(issues));
    if (std::vector<ConfigIssue> issues = ringbus::cycle::check_shape_buffer(p.config(), p.accel); !issues.empty())
      throw ConfigError(std::move(issues));
  });
  const MemoryNeed need = estimate(p.config(), keep_hits, p.scene, p.accel);
  spdlog::debug("memory: about {} of {} usable", report::bytes_text(need.total()),
                report::bytes_text(usable_memory_bytes()));
  require_fit(need, usable_memory_bytes(), p.located.positions);
}

/// Refuses a graph whose links can fill up and stop, and traffic on the lines of a hierarchical network, which is one.
/// Of other shapes `topology.flow` alone says whether they can.
void require_flow(const Prepared& p) {
  const bool graph = p.config().topology.shape == TopologyShape::kGraph;
  if (!graph && p.config().workload.kind != WorkloadConfig::Kind::kTraffic) return;
  if (!graph && p.config().topology.shape != TopologyShape::kHierarchical) return;
  const ringbus::DeadlockVerdict verdict = ringbus::deadlock_verdict(p.config());
  const char* key = graph ? "topology.links" : "topology.shape";
  if (verdict.can_deadlock)
    throw ConfigError({{p.located.positions.find(key), key,
                        fmt::format("{}; expected links without such a circle, or --force", verdict.rule)}});
}

/// Refuses a machine of several ranks where a command does not join them.
void require_one_rank(const Prepared& p) {
  if (p.config().engine.transport != EngineTransport::kLocal)
    throw ConfigError({{p.located.positions.find("engine.transport"), "engine.transport",
                        fmt::format("ranks play carousel run only; expected local, found {}",
                                    enum_name(p.config().engine.transport))}});
}

/// Refuses a series of frames where a command shows one.
void require_one_frame(const Prepared& p) {
  if (p.config().frames && p.config().frames->count > 1)
    throw ConfigError(
        {{p.located.positions.find("frames.count"), "frames.count",
          fmt::format("a series is for carousel run only; expected 1, found {}", p.config().frames->count)}});
}

/// From here on the process gets no more memory than the configuration says, which has to be more than it has.
void limit_memory(const Prepared& p) {
  constexpr std::uint64_t kMib = 1 << 20, kLeast = 16 * kMib;
  const auto limit = static_cast<std::uint64_t>(p.config().engine.memory_limit_mib) * kMib;
  limit_data_memory(0);
  if (const std::uint64_t taken = data_memory_bytes(); limit > 0 && limit < taken + kLeast)
    throw ConfigError({{p.located.positions.find("engine.memory_limit_mib"), "engine.memory_limit_mib",
                        fmt::format("this process has {} MiB before it has a scene; expected at least {}, found {}",
                                    taken / kMib, (taken + kLeast) / kMib + 1, limit / kMib)}});
  static_cast<void>(usable_memory_bytes());  // looks at what has been taken so far
  limit_data_memory(limit);
}

/// Makes the storage of collections large enough for the structure where its size is left to the program.
void adapt_storage(Prepared& p) {
  if (std::ranges::count(p.located.positions.given(), "collections.capacity") > 0) return;
  const std::int64_t needed = ringbus::minimum_capacity(p.config(), p.accel.most_ways(), p.accel.levels());
  std::int64_t& capacity = p.located.config.collections.capacity;
  if (needed <= capacity) return;
  spdlog::debug("collections.capacity: {}, which the reserve needs", needed);
  capacity = needed;
}

/// Chooses what depends on the scene, and holds the machine to its area, now that the scene is known.
void fit(Prepared& p) {
  adapt_storage(p);
  fit_area(p.located, ringbus::scene_facts(p.accel));
}

void choose_threads(Prepared& p) {
  const std::int64_t cores = std::max(1u, std::thread::hardware_concurrency());
  // A second thread makes the cycle engine faster only if each thread has many resources
  // (docs/internals/performance.md).
  const std::int64_t automatic =
      p.config().engine.kind == EngineKind::kCycle && p.config().topology.resources < 64 ? 1 : cores;
  p.threads = static_cast<std::size_t>(p.config().engine.threads.value_or(automatic));
  p.threads_beside = static_cast<std::size_t>(p.config().engine.threads.value_or(cores));
  spdlog::debug("threads: {}{}", p.threads, p.config().engine.threads ? "" : ", chosen");
}

/// Does all preparation after reading the configuration.
void prepare_located(Prepared& p, bool keep_hits, ringbus::Transport* transport = nullptr) {
  choose_threads(p);
  limit_memory(p);
  const KeyPositions& positions = p.located.positions;
  require_files(p);
  if (!p.has_rays()) return;
  require_fit(estimate_before_scene(p.config(), keep_hits), usable_memory_bytes(), positions);
  with_positions(positions, [&] {
    load_scene(p, scene::first_moment(p.config().scene, p.config().frames));
    foretell(p);
    build_accel(p, transport);
  });
  fit(p);
  choose_threads(p);
  require_room(p, keep_hits);
}

}  // namespace

scene::Scene load_moment(Prepared& p, float seconds) {
  scene::Scene before = std::move(p.scene);
  with_positions(p.located.positions, [&] { load_scene(p, scene::at_moment(p.config().scene, seconds)); });
  std::swap(before, p.scene);
  return before;
}

void rebuild(Prepared& p) {
  with_positions(p.located.positions, [&] { build_accel(p, nullptr); });
  renew_room(p);
}

void renew_room(Prepared& p) {
  adapt_storage(p);
  require_room(p, false);
}

void renew_any_hit(Prepared& p) {
  p.alpha_test = p.accel.has_non_opaque ? std::make_unique<shading::AlphaTest>(p.scene) : nullptr;
  p.accel.any_hit = p.alpha_test.get();
  const BvhConfig::Micromaps& maps = p.config().bvh.micromaps;
  if (p.accel.has_non_opaque && maps.states != BvhConfig::Micromaps::States::kNone) make_micromaps(p, maps);
}

Config Prepared::absolute_config() const {
  Config out = config();
  std::string* map = out.scene.sky ? &out.scene.sky->file : nullptr;
  for (std::string* name : {&out.scene.file, map, &out.bvh.file, &out.workload.rays_from, &out.workload.memory_trace}) {
    if (name == nullptr || name->empty()) continue;
    std::error_code ignored;
    const std::string path = std::filesystem::absolute(find_beside(config_folder, *name), ignored).string();
    if (plain_text(path) == path) *name = path;  // others cannot stand in a file of text
  }
  for (std::size_t i = 0; i < located.plugins.size(); ++i)
    if (plain_text(located.plugins[i]) == located.plugins[i]) out.engine.plugins[i] = located.plugins[i];
  return out;
}

bool Prepared::has_rays() const {
  using enum WorkloadConfig::Kind;
  return config().workload.kind != kTraffic && config().workload.kind != kMemoryTrace;
}

std::vector<IgnoredKey> Prepared::ignored() const {
  return ignored_keys(located, ringbus::scene_facts(accel));
}

float Prepared::scene_size() const {
  const Aabb box = scene.bounds();
  return box.empty() ? 1.0f : glm::length(box.extent());
}

Prepared prepare(const ConfigArguments& arguments, const ValidateOptions& options, bool keep_hits,
                 const std::function<void(const Prepared&)>& before_scene,
                 const std::function<ringbus::Transport*()>& ranks) {
  Prepared p;
  const ConfigText text = read_config_file(arguments.config);
  p.located =
      arguments.charge_all ? load_charged(text, arguments.sets, options) : load_config(text, arguments.sets, options);
  if (!options.ranks) require_one_rank(p);
  if (!options.frames) require_one_frame(p);
  if (!options.searches) require_no_search(p.located);
  if (!options.force) require_flow(p);
  p.config_folder = std::filesystem::path(arguments.config).parent_path();
  const bool is_fitted = p.config().area.budget_mm2 && !is_searched(p.config().area);
  const auto call = [&] {
    if (before_scene) with_positions(p.located.positions, [&] { before_scene(p); });
  };
  if (!is_fitted) call();
  prepare_located(p, keep_hits, ranks ? ranks() : nullptr);
  if (is_fitted) call();
  if (arguments.strict) refuse_ignored(p.ignored());
  return p;
}

void set_machine(Prepared& p, LocatedConfig located) {
  p.located = std::move(located);
  require_one_rank(p);
  require_one_frame(p);
  require_no_search(p.located);
  limit_memory(p);
  if (!p.has_rays()) return;
  set_query(p);
  fit(p);
  require_room(p, false);
}

Prepared prepare_config(const std::string& text, const std::string& name, const std::vector<std::string>& sets) {
  Prepared p;
  p.located = load_config({text, name}, sets, {.force = true});
  require_one_rank(p);
  require_one_frame(p);
  prepare_located(p, false);
  return p;
}

}  // namespace carousel::app
