#pragma once

#include <span>

#include "scene/model/scene.h"

namespace carousel::scene {

/// A perspective camera that sees the whole model from the front, a little from the right and above, as near as the
/// picture allows: the model touches the edges of the frame, but for a margin of 4 %. `aspect` is the picture's width
/// divided by its height. An empty or flat scene gives a usable camera too.
Camera fitted_camera(const Scene& scene, float aspect = 1);

/// As fitted_camera(), for the instances `shown` of the scene's alone; others may stand before them.
Camera fitted_camera(const Scene& scene, float aspect, std::span<const Instance> shown);

/// Makes up cameras[0] of a scene whose file has no camera: inside the model where it is an interior
/// (scene/model/floor_plan.h), and fitted_camera() otherwise.
void make_up_camera(Scene& scene, float aspect);

}  // namespace carousel::scene
