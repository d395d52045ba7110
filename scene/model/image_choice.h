#pragma once

#include <functional>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::scene {

/// Selects the images of a scene that are worth decoding: one entry an image. Called once, when all of the scene but
/// its pixels is there.
using ImageChoice = std::function<std::vector<bool>(const Scene&)>;

}  // namespace carousel::scene
