#include "scene/model/key_light.h"

#include <algorithm>

#include <glm/geometric.hpp>

namespace carousel::scene {

bool has_light(const Scene& scene) {
  if (!scene.lights.empty()) return true;
  return std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
    const std::vector<MaterialId>& used = scene.meshes[instance.mesh.value].triangle_materials;
    return std::any_of(used.begin(), used.end(),
                       [&](MaterialId m) { return scene.materials[m.value].emissive != Vec3(0.0f); });
  });
}

PunctualLight key_light(const Camera& camera) {
  PunctualLight light;
  light.kind = PunctualLight::Kind::kDirectional;
  light.intensity = Vec3(2.2f, 2.1f, 1.9f);
  light.direction = -glm::normalize(camera.back + 1.2f * camera.up - 0.7f * camera.right);
  return light;
}

}  // namespace carousel::scene
