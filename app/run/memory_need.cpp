#include "app/run/memory_need.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "accel/traverse/hit_oracle.h"
#include "core/config/own_sections.h"
#include "core/system/error.h"
#include "core/system/process_memory.h"
#include "report/csv/ray_csv.h"
#include "report/text/number_text.h"
#include "shading/effects/effects_plan.h"
#include "shading/path/path_state.h"

namespace carousel::app {

namespace {

// Measured with a million triangles (terrain, spheres, sliver) and 100,000 instances, as the peak minus that of a tiny
// scene: 200 to 225 bytes a triangle, of which the mesh keeps 27 to 52 and the structure 60; 440 bytes an instance.
constexpr std::uint64_t kSceneBytesPerTriangle = 55;
constexpr std::uint64_t kAccelBytesPerTriangle = 180;
constexpr std::uint64_t kBytesPerInstance = 512;
constexpr int kAssumedDepth =
    24;  // depth of the structure; with 8 children a node, 100 million triangles need far less

std::uint64_t frame_paths(const Config& config) {
  return static_cast<std::uint64_t>(config.image.width) * static_cast<std::uint64_t>(config.image.height) *
         static_cast<std::uint64_t>(config.image.samples);
}

MemoryNeed frame_need(const Config& config, bool keep_hits) {
  MemoryNeed need;
  if (config.workload.kind != WorkloadConfig::Kind::kRays) return need;
  const auto depth = static_cast<std::uint64_t>(config.image.max_depth);
  need.paths = paths_in_flight(config) * (sizeof(shading::PathState) + depth * sizeof(Vec3) + sizeof(std::uint32_t));
  // Three sums of 8 bytes, the linear picture of 12, the display picture of 3.
  need.film = frame_paths(config) / static_cast<std::uint64_t>(config.image.samples) * (24 + 12 + 3);
  if (config.primary == Primary::kRaster) need.film += frame_paths(config) * sizeof(Hit);
  if (keep_hits) need.hits = frame_paths(config) * sizeof(report::HitRow);
  return need;
}

}  // namespace

std::uint64_t scene_bytes(const scene::Scene& scene) {
  std::uint64_t bytes =
      scene.instances.size() * sizeof(scene::Instance) + scene.placements.size() * sizeof(scene::GroupPlacement);
  for (const scene::Image& image : scene.images) bytes += image.rgba.size();
  bytes += scene.gaussians.shapes.size() * sizeof(scene::Gaussian) + scene.gaussians.harmonics.size() * sizeof(Vec3);
  bytes += scene.sky.map.texels.size() * (sizeof(Vec3) + sizeof(std::uint32_t));  // with its SkyLight
  for (const scene::Mesh& mesh : scene.meshes) {
    bytes += mesh.positions.size() * sizeof(Vec3) + mesh.normals.size() * sizeof(Vec3);
    bytes += (mesh.uv0.size() + mesh.uv1.size()) * sizeof(Vec2) + mesh.colors.size() * sizeof(Vec4);
    bytes += mesh.spheres.size() * sizeof(scene::Sphere);
    bytes += mesh.indices.size() * sizeof(std::uint32_t) + mesh.triangle_materials.size() * sizeof(MaterialId);
  }
  return bytes;
}

std::uint64_t build_bytes(const scene::Scene& scene) {
  return scene.unique_triangle_count() * kAccelBytesPerTriangle + scene.instances.size() * kBytesPerInstance;
}

std::uint64_t paths_in_flight(const Config& config) {
  const auto slots = static_cast<std::uint64_t>(all_slots(config));
  return std::min(slots, frame_paths(config));
}

MemoryNeed estimate_before_scene(const Config& config, bool keep_hits) {
  MemoryNeed need = frame_need(config, keep_hits);
  const bool gaussians = config.scene.builtin.value_or(BuiltinScene::kGaussians) == BuiltinScene::kGaussians;
  need.ring = ringbus::estimate_memory(config, kAssumedDepth, gaussians);
  if (!config.scene.builtin) return need;
  const bool instances = *config.scene.builtin == BuiltinScene::kInstances;
  const bool sized = *config.scene.builtin != BuiltinScene::kCornell && !instances && !gaussians;
  if (sized) need.scene = static_cast<std::uint64_t>(config.scene.triangles) * kSceneBytesPerTriangle;
  if (config.scene.placement == ScenePlacement::kPartitioned) return need;  // this rank's share may be small
  if (sized) need.accel = static_cast<std::uint64_t>(config.scene.triangles) * kAccelBytesPerTriangle;
  if (instances) need.accel = static_cast<std::uint64_t>(config.scene.instances) * kBytesPerInstance;
  if (gaussians) {
    const GaussiansConfig& cloud = config.scene.gaussians;
    const bool triangles = cloud.geometry == GaussiansConfig::Geometry::kTriangles;
    need.accel = static_cast<std::uint64_t>(cloud.count) *
                 (triangles ? scene::kProxyTriangles * kAccelBytesPerTriangle : kBytesPerInstance);
  }
  return need;
}

MemoryNeed estimate(const Config& config, bool keep_hits, const scene::Scene& scene, const accel::Accel& accel) {
  MemoryNeed need = frame_need(config, keep_hits);
  need.scene = scene_bytes(scene);
  if (need.paths > 0) need.paths = paths_in_flight(config) * shading::plan_effects(scene, config).path_state_bytes();
  need.accel = accel.size_bytes();
  if (config.verify == Verify::kReference) need.accel += accel::HitOracle::foretold_bytes(scene);
  need.ring = ringbus::estimate_memory(config, accel.max_depth, accel.gaussians != nullptr);
  return need;
}

std::string memory_text(const MemoryNeed& need, std::uint64_t usable_bytes) {
  std::string out =
      fmt::format("memory: about {} of {}\n", report::bytes_text(need.total()), report::bytes_text(usable_bytes));
  const std::array<std::pair<const char*, std::uint64_t>, 10> parts{{
      {"scene", need.scene},
      {"acceleration structure", need.accel},
      {"rays", need.ring.ray_store},
      {"stacks", need.ring.ray_stacks},
      {"collections, if full", need.ring.collections},
      {"packets", need.ring.packets},
      {"waiting rays", need.ring.rays_waiting},
      {"caches of workers", need.ring.worker_caches},
      {"paths and film", need.paths + need.film},
      {"rows of hits", need.hits},
  }};
  for (const auto& [name, bytes] : parts)
    if (bytes > 0) out += fmt::format("  {:<24} {:>10}\n", name, report::bytes_text(bytes));
  return out;
}

void require_fit(const MemoryNeed& need, std::uint64_t usable_bytes, const KeyPositions& positions) {
  if (usable_bytes == 0 || need.total() <= usable_bytes) return;
  const std::array<std::pair<const char*, std::uint64_t>, 5> keys{{
      {"scene", need.scene + need.accel},
      {"rays.slots_per_resource", need.ring.ray_store + need.ring.ray_stacks + need.ring.rays_waiting + need.paths},
      {"collections.capacity", need.ring.collections},
      {"shading.workers", need.ring.worker_caches},
      {"image", need.film + need.hits},
  }};
  const auto most =
      std::max_element(keys.begin(), keys.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  throw ConfigError(
      {{positions.find(most->first), most->first,
        fmt::format("expected what fits into the {} memory of {}, found a need of about {}, {} of it here",
                    data_memory_limit() > 0 ? "process's" : "machine's", report::bytes_text(usable_bytes),
                    report::bytes_text(need.total()), report::bytes_text(most->second))}});
}

}  // namespace carousel::app
