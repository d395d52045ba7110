#pragma once

#include "scene/model/scene.h"

namespace carousel::scene {

/// Whether anything in the scene gives light: a punctual light, or an emissive material that a triangle uses.
bool has_light(const Scene& scene);

/// A sun over the viewer's left shoulder, for files that bring no light of their own: under a sky alone, white
/// things on a white sky cannot be told from it.
PunctualLight key_light(const Camera& camera);

}  // namespace carousel::scene
