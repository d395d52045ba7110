#include "scene/load_scene.h"

#include <cstdint>
#include <string>

#include "core/system/error.h"
#include "scene/builtin/builtin.h"
#include "scene/gltf/import.h"
#include "scene/model/key_light.h"

namespace carousel::scene {

namespace {

std::filesystem::path find_file(const std::string& name, const std::filesystem::path& config_dir) {
  std::error_code ignored;
  const std::filesystem::path beside = config_dir / name;
  if (std::filesystem::is_regular_file(beside, ignored)) return beside;
  if (std::filesystem::is_regular_file(name, ignored)) return name;
  throw SceneError(name, "", "no such file; looked in '" + config_dir.string() + "' and in the working directory");
}

}  // namespace

Scene load_scene(const SceneConfig& config, const std::filesystem::path& config_dir, const WarningSink& warn,
                 const ImageChoice& images) {
  if (config.file.empty() == !config.builtin.has_value()) {
    throw ConfigError({{{}, "scene", "expected exactly one of file and builtin"}});
  }
  Scene scene = config.builtin ? make_builtin(config) : load_gltf(find_file(config.file, config_dir), warn, images);
  if (config.sky || !config.builtin) {
    const SkyConfig sky = config.sky.value_or(SkyConfig{});
    scene.sky.radiance = sky.color * sky.strength;
  }
  const auto cameras = static_cast<std::int64_t>(scene.cameras.size());
  if (config.camera < 0 || config.camera >= cameras) {
    throw ConfigError({{{},
                        "scene.camera",
                        "expected 0 to " + std::to_string(cameras - 1) + " (the cameras of this scene), found " +
                            std::to_string(config.camera)}});
  }
  if (!config.builtin && !config.sky && !has_light(scene)) {
    scene.lights.push_back(key_light(scene.cameras[static_cast<std::size_t>(config.camera)]));
    if (warn) warn(config.file + ": has no light; a sun was added (give scene.sky to have the sky alone)");
  }
  return scene;
}

}  // namespace carousel::scene
