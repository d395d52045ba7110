#pragma once

#include "core/config/fields/field.h"

namespace carousel {

struct CameraConfig {
  float aperture = 0;
  float focus_distance = 1;
};

namespace config {

template <class V>
void describe(V& v, CameraConfig& c) {
  v.field("aperture", c.aperture, RealRange{0, 1e6}, "scene units",
          "The diameter of the lens. With 0 the camera is a pinhole.");
  v.field("focus_distance", c.focus_distance, RealRange{0, 1e9, true}, "scene units",
          "The distance of the plane in focus.");
}

}  // namespace config
}  // namespace carousel
