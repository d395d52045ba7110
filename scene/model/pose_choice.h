#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace carousel::scene {

/// The moment at which a file that moves is shown.
struct PoseChoice {
  float seconds = 0;                     ///< a time outside an animation's is its first or its last
  std::optional<std::string> animation;  ///< name or index; absent: all that move different nodes
};

/// What may move in a file.
struct Motion {
  struct Clip {
    std::string name;
    double seconds = 0;  ///< the time of its last key
    std::size_t channels = 0;
  };
  std::vector<Clip> clips;
  std::size_t skins = 0;
  std::size_t morph_targets = 0;  ///< of all meshes

  bool any() const { return !clips.empty() || skins > 0 || morph_targets > 0; }
};

}  // namespace carousel::scene
