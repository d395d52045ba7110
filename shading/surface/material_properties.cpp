#include "shading/surface/material_properties.h"

#include <cmath>

namespace carousel::shading {

using scene::Material;

namespace {

constexpr float kLeastRefraction = 0.005f;  // an index of refraction closer to 1 bends no ray

}  // namespace

bool may_be_dielectric(const Material& m) {
  return m.metallic < 1 || m.metallic_roughness_texture;
}

bool transmits(const Material& m) {
  return m.transmission.weight > 0 && may_be_dielectric(m);
}

bool has_volume(const Material& m) {
  return transmits(m) && m.volume.thickness > 0;
}

bool refracts(const Material& m) {
  return has_volume(m) && m.ior >= 1 && std::abs(m.ior - 1) > kLeastRefraction;
}

bool absorbs(const Material& m) {
  const auto& v = m.volume;
  return has_volume(m) && std::isfinite(v.attenuation_distance) && v.attenuation_distance > 0 &&
         v.attenuation_color != Vec3{1};
}

std::vector<bool> reached_materials(const scene::Scene& scene) {
  std::vector<bool> reached(scene.materials.size(), false), seen(scene.meshes.size(), false);
  for (const scene::Instance& instance : scene.instances) {
    if (seen[instance.mesh.value]) continue;
    seen[instance.mesh.value] = true;
    for (const MaterialId id : scene.meshes[instance.mesh.value].triangle_materials) reached[id.value] = true;
    for (const scene::Sphere& sphere : scene.meshes[instance.mesh.value].spheres) reached[sphere.material.value] = true;
  }
  return reached;
}

}  // namespace carousel::shading
