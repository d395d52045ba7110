#pragma once

#include <optional>

#include "core/config/fields/field.h"
#include "core/types/vec.h"

namespace carousel {

struct CameraConfig {
  std::optional<Vec3> eye, target;  ///< given together, or the scene's camera stands
  Vec3 up{0, 1, 0};
  std::optional<float> field_of_view;
  float aperture = 0;
  float focus_distance = 1;
};

namespace config {

template <class V>
void describe(V& v, CameraConfig& c) {
  constexpr RealRange kPlace{-1e9, 1e9};
  v.field_or_auto(
      "eye", c.eye, kPlace, "scene units",
      "The place of a camera of your own, which goes with target and takes the place of the scene's camera. "
      "With auto the scene's camera stands; a file without one gets a view of the whole model.");
  v.field_or_auto("target", c.target, kPlace, "scene units", "The point that the camera at eye looks at.");
  v.field("up", c.up, kPlace, "", "The direction that points to the top of the picture of the camera at eye.");
  v.field_or_auto("field_of_view", c.field_of_view, RealRange{0, 179, true}, "degrees",
                  "The vertical angle of view. With auto it is that of the scene's camera, or 40 degrees where that is "
                  "orthographic.");
  v.field("aperture", c.aperture, RealRange{0, 1e6}, "scene units",
          "The diameter of the lens. With 0 the camera is a pinhole.");
  v.field("focus_distance", c.focus_distance, RealRange{0, 1e9, true}, "scene units",
          "The distance of the plane in focus.");
}

}  // namespace config
}  // namespace carousel
