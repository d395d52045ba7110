#include "shading/surface/triangle_geometry.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/numeric/octahedral.h"

namespace carousel::shading {

namespace {

/// A point of a sphere: all corners fall together there, so that rounding is bounded as for a triangle's point.
TriangleGeometry sphere_geometry(const scene::Sphere& sphere, const scene::Affine& world, float u, float v) {
  TriangleGeometry g;
  g.linear = DMat3(world.linear);
  g.translation = DVec3(world.translation);
  const double determinant = glm::determinant(g.linear);
  g.mirrored = determinant < 0.0;
  const DVec3 normal = from_octahedral(u, v), point = DVec3(sphere.center) + double{sphere.radius} * normal;
  g.model = {point, point, point};
  g.weights = {1.0, 0.0, 0.0};
  g.position = g.linear * point + g.translation;
  const DVec3 stretched = glm::transpose(glm::inverse(g.linear)) * normal;
  const double length = glm::length(stretched);
  g.normal = stretched / length;
  constexpr double kFourPi = 12.566370614359172954;
  g.area = kFourPi * double{sphere.radius} * double{sphere.radius} * std::abs(determinant) * length;
  return g;
}

/// A point that a program found, with all corners together as those of a sphere.
TriangleGeometry program_geometry(const RayProgram& program, const scene::Affine& world, const Ray& ray,
                                  const Hit& hit) {
  TriangleGeometry g;
  g.linear = DMat3(world.linear);
  g.translation = DVec3(world.translation);
  g.mirrored = glm::determinant(g.linear) < 0.0;
  const DMat3 inverse = glm::inverse(g.linear);
  g.position = DVec3(ray.origin) + double{hit.t} * DVec3(ray.direction);
  const DVec3 point = inverse * (g.position - g.translation);
  g.model = {point, point, point};
  g.weights = {1.0, 0.0, 0.0};
  const DVec3 stretched = glm::transpose(inverse) * from_octahedral(hit.u, hit.v);
  g.normal = stretched / glm::length(stretched);
  g.error = double{program.offset};
  return g;
}

}  // namespace

TriangleGeometry triangle_geometry(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive, float u,
                                   float v) {
  const scene::Instance& placed = scene.instances[instance];
  const scene::Mesh& mesh = scene.meshes[placed.mesh.value];
  const scene::Affine& world = placed.world_from_model;
  if (primitive >= mesh.triangle_count())
    return sphere_geometry(mesh.spheres[primitive - mesh.triangle_count()], world, u, v);

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
      g.linear * (g.weights[0] * g.model[0] + g.weights[1] * g.model[1] + g.weights[2] * g.model[2]) + g.translation;

  const DVec3 cross = glm::cross(g.linear * (g.model[1] - g.model[0]), g.linear * (g.model[2] - g.model[0]));
  const double length = glm::length(cross);
  g.area = 0.5 * length;
  g.normal = length > 0.0 ? cross / (g.mirrored ? -length : length) : DVec3(0.0, 0.0, 1.0);
  return g;
}

TriangleGeometry hit_geometry(const scene::Scene& scene, const Ray& ray, const Hit& hit) {
  const scene::Instance& placed = scene.instances[hit.instance];
  const scene::Mesh& mesh = scene.meshes[placed.mesh.value];
  if (hit.primitive >= mesh.triangle_count()) {
    const scene::Sphere& bounds = mesh.spheres[hit.primitive - mesh.triangle_count()];
    if (bounds.program != scene::kNoProgram)
      return program_geometry(scene.programs[bounds.program], placed.world_from_model, ray, hit);
  }
  return triangle_geometry(scene, hit.instance, hit.primitive, hit.u, hit.v);
}

}  // namespace carousel::shading
