#include "scene/builtin/builtin.h"

#include "core/system/error.h"

namespace carousel::scene {

namespace {

constexpr std::int64_t kLargestCount = std::int64_t{1} << 28;  // 32-bit vertex indices with room to spare

std::int64_t checked_count(std::int64_t count, const char* key) {
  if (count >= 1 && count <= kLargestCount) return count;
  throw ConfigError(key, "expected 1 to 268435456, found " + std::to_string(count));
}

}  // namespace

Scene make_builtin(const SceneConfig& config) {
  if (!config.builtin) throw ConfigError("scene.builtin", "no built-in scene is named");
  const auto triangles = [&] { return checked_count(config.triangles, "scene.triangles"); };
  const float seconds = config.time.value_or(0);
  switch (*config.builtin) {
    case BuiltinScene::kCornell:
      return make_cornell();
    case BuiltinScene::kSpheres:
      return make_spheres(triangles(), config.seed, config.procedural, seconds);
    case BuiltinScene::kTerrain:
      return make_terrain(triangles(), config.seed, seconds);
    case BuiltinScene::kInstances:
      return make_instances(checked_count(config.instances, "scene.instances"), config.seed, config.levels, seconds);
    case BuiltinScene::kSliver:
      return make_sliver(triangles(), config.seed);
    case BuiltinScene::kFoliage:
      return make_foliage(triangles(), config.seed);
    case BuiltinScene::kGaussians:
      return make_gaussians(checked_count(config.gaussians.count, "scene.gaussians.count"), config.seed,
                            static_cast<int>(config.gaussians.degree.value_or(0)));
  }
  throw ConfigError("scene.builtin", "unknown built-in scene");
}

}  // namespace carousel::scene
