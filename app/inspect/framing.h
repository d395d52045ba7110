#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/types/aabb.h"
#include "scene/model/scene.h"

namespace carousel::app {

/// A camera for a node, as the keys of a configuration give it: eye, target, up and the vertical angle of view.
struct Framing {
  std::string node;
  std::size_t instances = 0;
  Aabb bounds;  ///< world space
  Vec3 eye, target, up;
  float field_of_view = 0;  ///< degrees
};

/// The camera that sees all of the first node of that name from the front, a little from the right and above, with a
/// margin of 4 %. `aspect`: width of the picture divided by its height. Other nodes may stand before it. Throws a
/// ConfigError for a name that no node that shows anything has, and for a node beyond the range of camera.eye.
Framing frame_node(const scene::Scene& scene, std::string_view name, float aspect);

std::string framing_yaml(const Framing& framing);
nlohmann::ordered_json framing_json(const Framing& framing);

}  // namespace carousel::app
