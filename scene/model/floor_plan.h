#pragma once

#include <optional>

#include "scene/model/scene.h"

namespace carousel::scene {

/// A camera that stands inside a model of rooms; absent if the model is to be seen from outside.
///
/// The model is cut at 0.4 of its height (y is up in glTF). It counts as an interior if most horizontal sight lines
/// from outside end at the back of a surface (walls that nobody was to see from there), and most sight lines from
/// places inside end at the front of one, or leave through an opening. The camera stands where it overlooks the largest
/// area, near one end of the longest sight line through that place, and looks along it.
std::optional<Camera> inside_camera(const Scene& scene);

}  // namespace carousel::scene
