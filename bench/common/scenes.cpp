#include "bench/common/scenes.h"

#include <filesystem>

#include "core/system/error.h"
#include "scene/builtin/builtin.h"
#include "scene/gltf/import.h"

namespace carousel::bench {

std::string SceneChoice::name() const {
  if (!file.empty()) return std::filesystem::path(file).filename().string();
  if (triangles % 1'000'000 == 0) return builtin + " " + std::to_string(triangles / 1'000'000) + "M";
  if (triangles % 1'000 == 0) return builtin + " " + std::to_string(triangles / 1'000) + "k";
  return builtin + " " + std::to_string(triangles);
}

std::vector<SceneChoice> choose_scenes(const std::vector<std::string>& builtins, const std::vector<std::int64_t>& sizes,
                                       const std::vector<std::string>& files) {
  std::vector<SceneChoice> scenes;
  for (const std::string& builtin : builtins) {
    if (builtin != "terrain" && builtin != "spheres" && builtin != "sliver")
      throw ConfigError("--builtin", "expected terrain, spheres or sliver, found " + builtin);
    for (const std::int64_t size : sizes) scenes.push_back({builtin, size, {}});
  }
  for (const std::string& file : files) scenes.push_back({{}, 0, file});
  return scenes;
}

scene::Scene make_scene(const SceneChoice& choice) {
  constexpr std::int64_t kSeed = 1;
  if (!choice.file.empty()) return scene::load_gltf(choice.file);
  if (choice.builtin == "terrain") return scene::make_terrain(choice.triangles, kSeed);
  if (choice.builtin == "spheres") return scene::make_spheres(choice.triangles, kSeed);
  return scene::make_sliver(choice.triangles, kSeed);
}

}  // namespace carousel::bench
