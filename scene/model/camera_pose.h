#pragma once

#include "scene/model/scene.h"

namespace carousel::scene {

/// A perspective camera at `position` that looks at `target`, which must differ from it. `up` need not be
/// perpendicular; where it is parallel to the view, another axis takes its place.
Camera look_at(Vec3 position, Vec3 target, float yfov, Vec3 up = {0, 1, 0});

}  // namespace carousel::scene
