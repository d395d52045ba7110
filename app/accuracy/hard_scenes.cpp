#include "app/accuracy/hard_scenes.h"

#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "accel/builders/build.h"
#include "app/accuracy/exact_answers.h"
#include "core/system/executor.h"
#include "scene/builtin/mesh_shapes.h"
#include "shading/surface/spawn_point.h"

namespace carousel::app {

namespace {

/// Uniform numbers, the same on every machine, unlike those of std::uniform_real_distribution.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : engine_(seed) {}
  double operator()(double least, double most) {
    return least + (most - least) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  DVec3 direction() {
    for (;;) {
      const DVec3 v((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
      if (const double size = glm::length(v); size > 0.1 && size <= 1) return v / size;
    }
  }

 private:
  std::mt19937_64 engine_;
};

scene::Scene one_mesh(scene::Mesh mesh, const scene::Affine& placement) {
  scene::Scene scene;
  scene.materials.emplace_back();
  scene.cameras.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({MeshId(0), placement});
  return scene;
}

scene::Mesh ball() {
  scene::Mesh mesh;
  scene::add_icosphere(mesh, {0, 0, 0}, 1, 3, MaterialId(0));
  return mesh;
}

DVec3 world(const scene::Affine& m, const DVec3& p) {
  return DMat3(m.linear) * p + DVec3(m.translation);
}

DVec3 vertex(const scene::Mesh& mesh, std::size_t triangle, std::size_t k) {
  return DVec3(mesh.positions[mesh.indices[3 * triangle + k % 3]]);
}

Ray aimed(const DVec3& from, const DVec3& at) {
  Ray ray;
  ray.origin = Vec3(from);
  ray.direction = Vec3(at - DVec3(ray.origin));
  return ray;
}

RayRequest numbered(const Ray& ray, std::size_t index) {
  return {ray, {static_cast<std::uint32_t>(index), RayKind::kBounce, 0, 0, 0}};
}

/// Rays from within a ball to a point of an edge, or to a vertex: the exact ray hits one of the triangles around it.
RayBatch at_edges_from_inside(const scene::Scene& scene, std::size_t count, Numbers& random) {
  const scene::Mesh& mesh = scene.meshes.front();
  const scene::Affine& m = scene.instances.front().world_from_model;
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t triangle = random.below(mesh.triangle_count()), k = random.below(3);
    const double along = i % 4 == 0 ? 0 : random(0, 1);
    const DVec3 target = vertex(mesh, triangle, k) * (1 - along) + vertex(mesh, triangle, k + 1) * along;
    rays.push_back(numbered(aimed(world(m, random.direction() * random(0, 0.5)), world(m, target)), i));
  }
  return rays;
}

/// Rays from a few units away to points within triangles.
RayBatch at_triangles(const scene::Scene& scene, double distance, std::size_t count, Numbers& random) {
  const scene::Mesh& mesh = scene.meshes.front();
  const scene::Affine& m = scene.instances.front().world_from_model;
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t triangle = random.below(mesh.triangle_count());
    const double a = random(0.1, 0.45), b = random(0.1, 0.45);
    const DVec3 target =
        vertex(mesh, triangle, 0) * (1 - a - b) + vertex(mesh, triangle, 1) * a + vertex(mesh, triangle, 2) * b;
    const DVec3 at = world(m, target);
    rays.push_back(numbered(aimed(at + random.direction() * (distance * random(1, 3)), at), i));
  }
  return rays;
}

/// Triangles that are a million times longer than wide, in every direction.
scene::Mesh slivers(Numbers& random) {
  scene::Mesh mesh;
  for (std::uint32_t t = 0; t < 200; ++t) {
    const DVec3 centre = random.direction() * random(0, 2), along = random.direction();
    const DVec3 across = glm::normalize(glm::cross(along, random.direction()));
    for (const DVec3& p : {centre - along, centre + along, centre + 2e-6 * across}) mesh.positions.push_back(Vec3(p));
    for (std::uint32_t k = 0; k < 3; ++k) mesh.indices.push_back(3 * t + k);
    mesh.triangle_materials.push_back(MaterialId(0));
  }
  return mesh;
}

Mat3 turned(double degrees, const DVec3& axis) {
  const double a = degrees * 3.14159265358979 / 180, c = std::cos(a), s = std::sin(a);
  const DVec3 n = glm::normalize(axis);
  const DMat3 cross(0, n.z, -n.y, -n.z, 0, n.x, n.y, -n.x, 0);
  return Mat3(DMat3(c) + cross * s + glm::outerProduct(n, n) * (1 - c));
}

}  // namespace

std::vector<HardScene> hard_scenes(std::size_t rays, std::uint64_t seed) {
  Numbers random(seed);
  std::vector<HardScene> out;
  const auto add_ball = [&](const char* name, const char* what, const scene::Affine& placement) {
    HardScene& hard = out.emplace_back(HardScene{{name, what, true, false}, one_mesh(ball(), placement), {}});
    hard.rays = at_edges_from_inside(hard.scene, rays, random);
  };
  add_ball("edges", "edges and vertices of a closed ball, from inside", {});
  add_ball("squashed", "the same, scaled by 0.001 in one axis and turned",
           {turned(40, {1, 2, 3}) * Mat3(1, 0, 0, 0, 1e-3f, 0, 0, 0, 1), {}});
  add_ball("far ball", "the same, turned, 100,000 from the origin", {turned(70, {3, -1, 2}), {1e5f, -2e4f, 3e4f}});
  HardScene& thin = out.emplace_back(HardScene{
      {"slivers", "triangles a million times as long as wide", false, true}, one_mesh(slivers(random), {}), {}});
  thin.rays = at_triangles(thin.scene, 1, rays, random);
  HardScene& far = out.emplace_back(
      HardScene{{"far mesh", "a ball of radius 1, a million from the origin, at its triangles", false, false},
                one_mesh(ball(), {turned(25, {-1, 1, 4}), {1e6f, 5e5f, -2e5f}}),
                {}});
  far.rays = at_triangles(far.scene, 4, rays, random);
  return out;
}

SelfHits self_hits_far_away(SpawnOffset spawn, std::size_t rays, std::uint64_t seed) {
  Numbers random(seed);
  SelfHits out;
  for (const float far : {1e4f, 1e6f}) {
    const scene::Scene scene = one_mesh(ball(), {turned(50, {2, 1, -1}), Vec3(far, -0.3f * far, 0.2f * far)});
    const accel::Accel accel = accel::build(scene, {}, *make_sequential_executor());
    RayBatch leaving;
    std::vector<std::uint32_t> left;
    for (std::size_t i = 0; i < rays / 2; ++i) {
      const auto triangle = static_cast<std::uint32_t>(random.below(scene.meshes.front().triangle_count()));
      const double a = random(0, 1), b = random(0, 1 - a);
      const shading::TriangleGeometry geometry = shading::triangle_geometry(scene, 0, triangle, float(a), float(b));
      DVec3 direction = random.direction();
      const bool front = glm::dot(direction, geometry.normal) > 0;
      Ray ray;
      ray.origin = shading::spawn_point(geometry, front ? shading::Side::kFront : shading::Side::kBack, spawn);
      ray.direction = Vec3(direction);
      leaving.push_back(numbered(ray, i));
      left.push_back(triangle);
    }
    const HitList hits = trace(accel, leaving);
    for (std::size_t i = 0; i < hits.size(); ++i) out.self_hits += hits[i].valid() && hits[i].primitive == left[i];
    out.bounces += leaving.size();
  }
  return out;
}

}  // namespace carousel::app
