#include "scene/load_scene.h"

#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "core/module/module.h"
#include "core/system/error.h"
#include "scene/builtin/builtin.h"
#include "scene/gltf/import.h"
#include "scene/import/gaussian_ply.h"
#include "scene/import/import_file.h"
#include "scene/load_sky.h"
#include "scene/model/camera_pose.h"
#include "scene/model/fitted_camera.h"
#include "scene/model/key_light.h"
#include "scene/model/quantise.h"
#include "scene/place_gaussians.h"

namespace carousel::scene {

namespace {

/// `key` names the file, of a kind that `kind` says.
std::filesystem::path find_file(const char* key, const char* kind, const std::string& name,
                                const std::filesystem::path& config_dir) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::path beside = config_dir / name;
  if (fs::is_regular_file(beside, ignored)) return beside;
  if (fs::is_regular_file(name, ignored)) return name;
  const bool folder = fs::is_directory(beside, ignored) || fs::is_directory(name, ignored);
  const std::string found = std::string("expected ") + kind + ", found '" + name + "', which is ";
  throw ConfigError({{{},
                      key,
                      folder ? found + "a folder"
                             : found + "not there; looked in '" + (config_dir.empty() ? "." : config_dir.string()) +
                                   "' and in the working directory"}});
}

/// The moment that the configuration names.
std::optional<PoseChoice> pose_of(const SceneConfig& config) {
  if (config.animation) return PoseChoice{config.animation->time, config.animation->name};
  if (config.time) return PoseChoice{*config.time, std::nullopt};
  return std::nullopt;
}

Scene load_file(const SceneConfig& config, const std::filesystem::path& config_dir, const WarningSink& warn,
                const ImageChoice& images, Executor* executor) {
  const std::optional<PoseChoice> pose = pose_of(config);
  const std::filesystem::path file = find_file("scene.file", "a scene file", config.file, config_dir);
  Scene scene;
  try {
    scene = is_gltf(file)           ? load_gltf(file, warn, images, pose, executor)
            : is_gaussian_ply(file) ? load_gaussian_ply(file)
                                    : SceneImporter().load(file, warn, images, pose, executor);
  } catch (const ModuleError& missing) {
    throw ConfigError("scene.file", config.file + " is no glTF file, and " + missing.what());
  }
  if (pose && !scene.motion.any() && warn)
    warn(config.file + ": has no animations, skins or morph targets; scene.time changes nothing");
  return scene;
}

/// Gives the scene's camera the view of the configuration.
void set_up(Camera& camera, const CameraConfig& config) {
  constexpr float kRadians = std::numbers::pi_v<float> / 180;
  constexpr float kDefaultDegrees = 40;
  const bool orthographic = camera.projection == Camera::Projection::kOrthographic;
  if (config.field_of_view && orthographic && !config.eye) {
    throw ConfigError("camera.field_of_view",
                      "the scene's camera is orthographic, and has no angle of view; expected auto, or camera.eye "
                      "and camera.target beside it");
  }
  if (config.eye && config.target) {
    const float fallback = orthographic ? kDefaultDegrees * kRadians : camera.yfov;
    camera = look_at(*config.eye, *config.target, fallback, config.up);
    camera.name = "configured";
  }
  if (config.field_of_view) camera.yfov = *config.field_of_view * kRadians;
}

}  // namespace

Scene load_scene(const SceneConfig& config, const std::filesystem::path& config_dir, const WarningSink& warn,
                 const ImageChoice& images, const View& view, Executor* executor) {
  if (config.file.empty() == !config.builtin.has_value()) {
    throw ConfigError("scene", "expected exactly one of file and builtin");
  }
  std::optional<std::filesystem::path> map;  // sought first: the scene may be large
  if (config.sky && !config.sky->file.empty())
    map = find_file("scene.sky.file", "an environment map (.hdr or .exr)", config.sky->file, config_dir);
  Scene scene = config.builtin ? make_builtin(config) : load_file(config, config_dir, warn, images, executor);
  place_gaussians(scene, config.gaussians, config.builtin ? scene.name : config.file);
  if (config.quantise > 0) quantise(scene, static_cast<int>(config.quantise));
  if (map) {
    scene.sky = {Vec3{0}, load_sky_map(*map, *config.sky, warn)};
  } else if (config.sky || !config.builtin) {
    const SkyConfig sky = config.sky.value_or(SkyConfig{});
    scene.sky.radiance = sky.color * sky.strength;
  }
  const auto cameras = static_cast<std::int64_t>(scene.cameras.size());
  if (config.camera < 0 || config.camera >= cameras) {
    throw ConfigError("scene.camera", "expected 0 to " + std::to_string(cameras - 1) +
                                          " (the cameras of this scene), found " + std::to_string(config.camera));
  }
  Camera& camera = scene.cameras[static_cast<std::size_t>(config.camera)];
  if (scene.added.camera && !view.camera.eye) make_up_camera(scene, view.aspect);
  set_up(camera, view.camera);
  if (scene.added.camera && view.camera.eye) scene.added.camera = false;
  if (!config.builtin && !config.sky && !has_light(scene)) {
    scene.lights.push_back(key_light(camera));
    scene.added.sun = true;
    if (warn)
      warn(config.file + ": has no light that could show it; a sun was added (give scene.sky to have the sky alone)");
  }
  return scene;
}

}  // namespace carousel::scene
