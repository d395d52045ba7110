#pragma once

#include "scene/model/scene.h"

namespace carousel::scene {

/// True if something in the scene emits light: a punctual light, Gaussians, or an emissive material that a triangle
/// uses, unless its emissive texture is mostly black. Reads the decoded images.
bool has_light(const Scene& scene);

/// A sun over the viewer's left shoulder, for files without a light. Under a uniform sky alone, a white object would
/// look like the sky behind it.
PunctualLight key_light(const Camera& camera);

}  // namespace carousel::scene
