#include "scene/model/camera_pose.h"

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

}  // namespace carousel::scene
