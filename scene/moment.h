#pragma once

#include <cstdint>
#include <optional>

#include "core/config/fields/image.h"
#include "core/config/fields/scene.h"

namespace carousel::scene {

/// The scene at another moment.
inline SceneConfig at_moment(SceneConfig scene, float seconds) {
  if (scene.animation)
    scene.animation->time = seconds;
  else
    scene.time = seconds;
  return scene;
}

/// The moment of a frame, in seconds: that of the scene, and so many steps.
inline float moment_of_frame(const SceneConfig& scene, const FramesConfig& frames, std::int64_t frame) {
  const double start = scene.animation ? scene.animation->time : scene.time.value_or(0);
  return static_cast<float>(start + static_cast<double>(frame) * frames.step);
}

/// The scene of the configuration; of a series of frames that of its first one.
inline SceneConfig first_moment(const SceneConfig& scene, const std::optional<FramesConfig>& frames) {
  if (!frames || frames->count + frames->first == 1) return scene;
  return at_moment(scene, moment_of_frame(scene, *frames, frames->first));
}

}  // namespace carousel::scene
