#include "app/run/prepare.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <spdlog/spdlog.h>

#include "accel/build/build.h"
#include "accel/planes/cull_planes.h"
#include "accel/traverse/kernels.h"
#include "app/host/machine_info.h"
#include "app/run/memory_need.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "ringbus/cycle/memory/shape_room.h"
#include "ringbus/protocol/deadlock.h"
#include "scene/load_scene.h"
#include "shading/effects/effects_plan.h"

namespace carousel::app {

namespace {

/// Runs `body`; adds to its ConfigErrors the positions in the user's files.
template <class Body>
auto with_positions(const KeyPositions& positions, const Body& body) {
  try {
    return body();
  } catch (const ConfigError& error) {
    std::vector<ConfigIssue> issues = error.issues();
    for (ConfigIssue& issue : issues)
      if (issue.position.file.empty()) issue.position = positions.find(issue.key_path);
    throw ConfigError(std::move(issues));
  }
}

/// Refuses a list of rays that is not there before the scene is loaded.
void require_ray_file(const Prepared& p) {
  if (p.config().workload.kind != WorkloadConfig::Kind::kRaysFrom) return;
  const std::string& name = p.config().workload.rays_from;
  const std::filesystem::path path = find_beside(p.config_folder, name);
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored)) return;
  const std::string key = "workload.rays_from";
  throw ConfigError({{p.located.positions.find(key), key,
                      fmt::format("expected a file of rays beside the configuration or in the working directory, "
                                  "found '{}', which is not there",
                                  name)}});
}

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void load_scene(Prepared& p) {
  const Stopwatch watch;
  p.scene = scene::load_scene(
      p.config().scene, p.config_folder,
      [&](const std::string& warning) {
        spdlog::warn("{}", warning);
        p.warnings.push_back(warning);
      },
      [&](const scene::Scene& s) { return shading::images_read(s, p.config().shading.effects); });
  shading::strip_effects(p.scene, p.config().shading.effects);
  p.scene_seconds = watch.seconds();
}

void build_accel(Prepared& p) {
  const Stopwatch watch;
  accel::select_simd_target(p.config().engine.simd);
  const auto executor = make_tbb_executor(p.threads);
  p.accel = accel::build(p.scene, p.config().bvh, *executor, p.config().accuracy);
  p.build_seconds = watch.seconds();
  if (p.accel.has_non_opaque) {
    p.alpha_test = std::make_unique<shading::AlphaTest>(p.scene);
    p.accel.any_hit = p.alpha_test.get();
  }
  accel::add_cull_planes(p.accel, p.scene, p.config().cull_planes, *executor);
  p.plane_seconds = watch.seconds() - p.build_seconds;
  if (std::vector<ConfigIssue> issues = ringbus::check_storage(p.config(), p.accel); !issues.empty())
    throw ConfigError(std::move(issues));
  if (std::vector<ConfigIssue> issues = ringbus::cycle::check_shape_buffer(p.config(), p.accel); !issues.empty())
    throw ConfigError(std::move(issues));
}

/// Does all preparation after reading the configuration.
void prepare_located(Prepared& p, bool keep_hits) {
  const std::int64_t cores = std::max(1u, std::thread::hardware_concurrency());
  // A second thread makes the cycle engine faster only if each thread has many resources (docs/performance.md).
  const std::int64_t automatic =
      p.config().engine.kind == EngineKind::kCycle && p.config().topology.resources < 64 ? 1 : cores;
  p.threads = static_cast<std::size_t>(p.config().engine.threads.value_or(automatic));
  if (p.config().workload.kind == WorkloadConfig::Kind::kTraffic) return;  // synthetic traffic needs no scene
  const KeyPositions& positions = p.located.positions;
  require_ray_file(p);
  require_fit(estimate_before_scene(p.config(), keep_hits), usable_memory_bytes(), positions);
  with_positions(positions, [&] {
    load_scene(p);
    build_accel(p);
  });
  require_fit(estimate(p.config(), keep_hits, p.scene, p.accel), usable_memory_bytes(), positions);
}

}  // namespace

float Prepared::scene_size() const {
  const Aabb box = scene.bounds();
  return box.empty() ? 1.0f : glm::length(box.extent());
}

Prepared prepare(const ConfigArguments& arguments, const ValidateOptions& options, bool keep_hits) {
  Prepared p;
  p.located = load_config(read_config_file(arguments.config), arguments.sets, options);
  p.config_folder = std::filesystem::path(arguments.config).parent_path();
  prepare_located(p, keep_hits);
  return p;
}

Prepared prepare_config(const std::string& text, const std::string& name, const std::vector<std::string>& sets) {
  Prepared p;
  p.located = load_config({text, name}, sets, {.force = true});
  prepare_located(p, false);
  return p;
}

std::filesystem::path find_beside(const std::filesystem::path& config_folder, const std::string& file) {
  std::error_code ignored;
  const std::filesystem::path beside = config_folder / file;
  return std::filesystem::exists(beside, ignored) ? beside : std::filesystem::path(file);
}

}  // namespace carousel::app
