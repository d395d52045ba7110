#pragma once

#include "scene/model/scene.h"

namespace carousel::scene {

/// A perspective camera at `position` that looks at `target`, which must differ from it. `up` need not be
/// perpendicular; where it is parallel to the view, another axis takes its place.
Camera look_at(Vec3 position, Vec3 target, float yfov, Vec3 up = {0, 1, 0});

/// A perspective camera that sees all of `bounds` from the front, a little from the right and above; for a
/// scene without a camera of its own. An empty or flat box gives a usable camera too.
Camera fitted_camera(const Aabb& bounds);

}  // namespace carousel::scene
