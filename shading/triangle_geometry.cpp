#include "shading/triangle_geometry.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace carousel::shading {

TriangleGeometry triangle_geometry(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive,
                                   float u, float v) {
  const scene::Instance& placed = scene.instances[instance];
  const scene::Mesh& mesh = scene.meshes[placed.mesh.value];
  const scene::Affine& world = placed.world_from_model;

  TriangleGeometry g;
  g.linear = DMat3(world.linear);
  g.translation = DVec3(world.translation);
  const double determinant = glm::determinant(g.linear);
  const bool singular = determinant == 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& p = mesh.positions[mesh.indices[3 * std::size_t{primitive} + k]];
    g.model[k] = singular ? DVec3(world.linear * p + world.translation) : DVec3(p);
  }
  if (singular) {
    g.linear = DMat3(1.0);
    g.translation = DVec3(0.0);
  }
  g.mirrored = determinant < 0.0;
  g.weights = {1.0 - double{u} - double{v}, double{u}, double{v}};
  g.position =
      g.linear * (g.weights[0] * g.model[0] + g.weights[1] * g.model[1] + g.weights[2] * g.model[2]) +
      g.translation;

  const DVec3 cross = glm::cross(g.linear * (g.model[1] - g.model[0]), g.linear * (g.model[2] - g.model[0]));
  const double length = glm::length(cross);
  g.area = 0.5 * length;
  g.normal = length > 0.0 ? cross / (g.mirrored ? -length : length) : DVec3(0.0, 0.0, 1.0);
  return g;
}

}  // namespace carousel::shading
