#include "scene/model/camera_pose.h"

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
  const Aabb box = bounds.empty() ? Aabb{Vec3(-1), Vec3(1)} : bounds;
  const Vec3 centre = box.centre();
  const double yfov = 0.7, margin = 1.08;
  const DVec3 back = glm::normalize(DVec3(0.45, 0.35, 1));
  const Camera pose = look_at(Vec3(back), Vec3(0), static_cast<float>(yfov));
  // The least distance at which every corner lies inside a square picture.
  const double slope = std::tan(0.5 * yfov) / margin;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const DVec3 p =
        DVec3(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y, corner & 4 ? box.hi.z : box.lo.z) -
        DVec3(centre);
    const double aside = std::max(std::abs(glm::dot(p, DVec3(pose.right))), std::abs(glm::dot(p, DVec3(pose.up))));
    distance = std::max(distance, glm::dot(p, back) + aside / slope);
  }
  // Far enough for the camera to differ from the centre after rounding, near enough to stay finite.
  const double magnitude = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z), 1e-20f});
  distance = std::clamp(distance, 1e-4 * magnitude, 1e38);
  Camera camera = pose;
  camera.name = "fitted";
  camera.position = Vec3(DVec3(centre) + distance * back);
  return camera;
}

}  // namespace carousel::scene
