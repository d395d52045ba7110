#include "shading/camera/camera_rays.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "shading/math/disk.h"

namespace carousel::shading {

CameraRays::CameraRays(const scene::Camera& camera, const CameraConfig& lens, std::uint32_t width, std::uint32_t height)
    : camera_(camera),
      lens_radius_(0.5f * lens.aperture),
      focus_distance_(lens.focus_distance),
      inv_width_(1.0f / static_cast<float>(width)),
      inv_height_(1.0f / static_cast<float>(height)) {
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (camera.projection == scene::Camera::Projection::kOrthographic) {
    half_height_ = std::max(camera.ymag, camera.xmag / aspect);
  } else {
    const SinCos half = sin_cos_turns(0.5f * camera.yfov * 0.159154943f);
    half_height_ = half.sin / half.cos;
  }
  half_width_ = half_height_ * aspect;
}

Ray CameraRays::ray(std::uint32_t x, std::uint32_t y, const CameraDraw& draw) const {
  const float sx = half_width_ * (2.0f * (static_cast<float>(x) + draw.pixel.x) * inv_width_ - 1.0f);
  const float sy = half_height_ * (1.0f - 2.0f * (static_cast<float>(y) + draw.pixel.y) * inv_height_);
  Ray ray;
  if (camera_.projection == scene::Camera::Projection::kOrthographic) {
    ray.origin = camera_.position + camera_.right * sx + camera_.up * sy;
    ray.direction = -camera_.back;
    ray.tmin = camera_.znear;
    return ray;
  }
  ray.origin = camera_.position;
  Vec3 local{sx, sy, -1.0f};
  if (lens_radius_ > 0.0f) {
    const Vec2 lens = square_to_disk(draw.lens) * lens_radius_;
    ray.origin += camera_.right * lens.x + camera_.up * lens.y;
    local = local * focus_distance_ - Vec3{lens.x, lens.y, 0.0f};
  }
  local = glm::normalize(local);
  ray.direction = glm::normalize(camera_.right * local.x + camera_.up * local.y + camera_.back * local.z);
  ray.tmin = camera_.znear / -local.z;  // znear is measured along the view axis
  return ray;
}

}  // namespace carousel::shading
