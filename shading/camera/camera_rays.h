#pragma once

#include <cstdint>

#include "core/config/fields/camera.h"
#include "core/types/ray.h"
#include "scene/model/scene.h"
#include "shading/math/sampler.h"

namespace carousel::shading {

/// Rays through the pixels of an image: perspective, with a thin lens if the aperture is open, or
/// orthographic. Directions are unit. Perspective keeps the vertical field of view whatever the image's
/// aspect; orthographic keeps the camera's whole window in view.
class CameraRays {
 public:
  CameraRays(const scene::Camera& camera, const CameraConfig& lens, std::uint32_t width, std::uint32_t height);

  /// Half the size of the window that the picture shows: at distance 1, or in scene units if orthographic.
  Vec2 half_window() const { return {half_width_, half_height_}; }

  /// Row 0 is the top of the image.
  Ray ray(std::uint32_t x, std::uint32_t y, const CameraDraw& draw) const;

 private:
  scene::Camera camera_;
  float lens_radius_, focus_distance_;
  float half_width_, half_height_;  // half the window's size: at distance 1, or in scene units if orthographic
  float inv_width_, inv_height_;
};

}  // namespace carousel::shading
