#include "scene/camera_pose.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace carousel::scene {

Camera look_at(Vec3 position, Vec3 target, float yfov, Vec3 up) {
  // In double: for scenes far from the origin the difference of two rounded points has few digits left.
  const DVec3 back = glm::normalize(DVec3(position) - DVec3(target));
  DVec3 right = glm::cross(DVec3(up), back);
  if (glm::length(right) < 1e-6) right = glm::cross(DVec3(0, 0, -1), back);
  if (glm::length(right) < 1e-6) right = glm::cross(DVec3(1, 0, 0), back);
  right = glm::normalize(right);
  Camera camera;
  camera.position = position;
  camera.right = Vec3(right);
  camera.up = Vec3(glm::cross(back, right));
  camera.back = Vec3(back);
  camera.yfov = yfov;
  return camera;
}

Camera fitted_camera(const Aabb& bounds) {
  const Vec3 centre = bounds.empty() ? Vec3{0} : bounds.centre();
  const DVec3 extent = bounds.empty() ? DVec3{2} : DVec3(bounds.hi) - DVec3(bounds.lo);
  const double yfov = 0.7;
  // Far enough for the bounding sphere, and for the camera to differ from the centre after rounding.
  const double magnitude = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z), 1e-20f});
  const double radius = std::max(0.5 * glm::length(extent), 1e-4 * magnitude);
  const double distance = std::min(radius / std::sin(0.5 * yfov), 1e38);
  const DVec3 direction = glm::normalize(DVec3(0.45, 0.35, 1));
  Camera camera = look_at(Vec3(DVec3(centre) + distance * direction), centre, static_cast<float>(yfov));
  camera.name = "fitted";
  return camera;
}

}  // namespace carousel::scene
