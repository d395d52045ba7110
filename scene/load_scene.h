#pragma once

#include <filesystem>

#include "core/config/fields/camera.h"
#include "core/config/fields/scene.h"
#include "scene/gltf/import.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// The view of the picture: what the configuration says of the camera, and width divided by height.
struct View {
  CameraConfig camera;
  float aspect = 1;
};

/// The scene a configuration names, built in or a file (looked for in `config_dir`, then in the working
/// directory), with the configuration's sky, whose map is looked for likewise; without one a built-in scene keeps its
/// own and a file gets SkyConfig's default, and a sun when it brings no light that could show it. A file without a
/// camera gets one that shows all of the model, or stands inside it (scene/model/floor_plan.h). The camera of the
/// configuration takes the place of the scene's. A file that moves is shown at the configuration's moment, or in its
/// base pose. `executor` is that of load_gltf(). Throws SceneError for a file, ConfigError when it is not there,
/// neither or both of file and builtin are given, when a count is out of range, or when the scene has no camera of that
/// index.
Scene load_scene(const SceneConfig& config, const std::filesystem::path& config_dir, const WarningSink& warn = {},
                 const ImageChoice& images = {}, const View& view = {}, Executor* executor = nullptr);

}  // namespace carousel::scene
