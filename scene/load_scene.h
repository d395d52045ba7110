#pragma once

#include <filesystem>

#include "core/config/config.h"
#include "scene/gltf/import.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// The scene a configuration names, built in or a file (looked for in `config_dir`, then in the working
/// directory), with the configuration's sky; without one a built-in scene keeps its own and a file gets
/// SkyConfig's default, and a sun when it brings no light at all. Throws SceneError for the file, ConfigError when
/// neither or both of file and builtin are given, when a count is out of range, or when the scene has no camera of that
/// index.
Scene load_scene(const SceneConfig& config, const std::filesystem::path& config_dir, const WarningSink& warn = {},
                 const ImageChoice& images = {});

}  // namespace carousel::scene
