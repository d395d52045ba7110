#pragma once

#include <optional>

#include "scene/model/scene.h"

namespace carousel::scene {

/// A camera that stands inside a model of rooms; absent if the model is to be seen from outside.
///
/// A room is at least 3 units wide both ways, as glTF counts in metres: cars and boxes whose faces are turned inside
/// out are not. The model is cut at 0.4 of its height (y is up in glTF), and sight lines are drawn in this plan, from
/// outside and from 7 by 7 places inside. It is an interior in two cases. Its walls have no outside: most lines from
/// outside end at the back of a surface, and at least half of those from inside at the front of one. Or its walls have
/// one, but two thirds of the lines from inside end in the model, and 60 % of these at the front of a surface, unlike
/// in a solid.
///
/// The camera stands where it overlooks the largest area, near one end of the longest sight line through that place,
/// and looks along it.
std::optional<Camera> inside_camera(const Scene& scene);

}  // namespace carousel::scene
