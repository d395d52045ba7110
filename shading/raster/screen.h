#pragma once

#include <cstdint>
#include <span>

#include "core/types/vec.h"
#include "scene/model/scene.h"
#include "shading/camera/camera_rays.h"

namespace carousel::shading {

/// Pixels [x0, x1) x [y0, y1).
struct PixelBox {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// Bounds of objects in the picture of a pinhole camera.
class Screen {
 public:
  /// Keeps references to `camera` and `rays`, which is made from it for width * height pixels.
  Screen(const scene::Camera& camera, const CameraRays& rays, std::uint32_t width, std::uint32_t height);

  /// Every pixel with a ray that can meet the convex hull of the points (world space; 1 to 8 of them, those of a
  /// triangle or of a box in any order). The result is never too small; it is the whole picture for a hull that is
  /// partly behind a camera without znear.
  PixelBox bounds(std::span<const DVec3> points) const;

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }

 private:
  const scene::Camera& camera_;
  const Vec2 half_window_;
  const std::uint32_t width_, height_;
};

}  // namespace carousel::shading
