#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::bench {

/// A scene to measure: a built-in one of about `triangles` triangles, or a glTF file.
struct SceneChoice {
  std::string builtin;  ///< terrain, spheres or sliver; empty for a file
  std::int64_t triangles = 0;
  std::string file;

  /// Its name in the tables: "terrain 100k", "house.glb".
  std::string name() const;
};

/// Every built-in name with every size, then every file. Throws ConfigError for an unknown name.
std::vector<SceneChoice> choose_scenes(const std::vector<std::string>& builtins, const std::vector<std::int64_t>& sizes,
                                       const std::vector<std::string>& files);
/// Throws SceneError for a file that cannot be read.
scene::Scene make_scene(const SceneChoice& choice);

}  // namespace carousel::bench
