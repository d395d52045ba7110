#include "app/accuracy/spawn_property.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "accel/certificate/case_values.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/placement_cases.h"
#include "accel/exact/dyadic.h"
#include "shading/surface/spawn_point.h"

namespace carousel::app {

namespace {

using accel::Dyadic;
using DyadicVec = std::array<Dyadic, 3>;

DyadicVec exact(const Vec3& v) {
  return {Dyadic(v.x), Dyadic(v.y), Dyadic(v.z)};
}
DyadicVec minus(const DyadicVec& a, const DyadicVec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
DyadicVec cross(const DyadicVec& a, const DyadicVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Dyadic dot(const DyadicVec& a, const DyadicVec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
DyadicVec world(const scene::Affine& m, const Vec3& p) {
  DyadicVec out = exact(m.translation);
  for (int c = 0; c < 3; ++c)
    for (int row = 0; row < 3; ++row)
      out[static_cast<std::size_t>(row)] = out[static_cast<std::size_t>(row)] + Dyadic(m.linear[c][row]) * Dyadic(p[c]);
  return out;
}

accel::CaseValues make_spawn(accel::CaseRandom& random) {
  const scene::Affine m = accel::placement_case(random);
  const double size = accel::log_uniform(random, 0.1, 10);
  const Vec3 base(random.below(2) ? DVec3(0) : accel::log_uniform(random, 0.01, 100) * accel::random_direction(random));
  Vec3 corners[3];
  for (Vec3& corner : corners) corner = base + Vec3(size * accel::random_direction(random));
  float u = random.uniform(), v = random.uniform();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const std::uint32_t where = random.below(6);  // on an edge, at a vertex, inside
  if (where < 2) (where == 0 ? u : v) = 0;
  if (where == 2) u = v = 0;
  accel::CaseWriter out;
  out.add(m).add(corners[0]).add(corners[1]).add(corners[2]).add(u).add(v);
  return out.add(Vec3(accel::random_direction(random))).take();
}

void judge_spawn(const accel::CaseValues& values, std::span<const AccuracyConfig> levels,
                 std::span<accel::Judgement> out, accel::CaseStory* story) {
  accel::CaseReader read(values);
  const bool finite = read.rest_is_finite();
  const scene::Affine m = read.placement();
  const accel::Corners corners{read.vector(), read.vector(), read.vector()};
  const float u = read.number(), v = read.number();
  const Vec3 direction = read.vector();
  if (!finite || u < 0 || v < 0 || u + v > 1) return;
  const DyadicVec a = world(m, corners[0]),
                  normal = cross(minus(world(m, corners[1]), a), minus(world(m, corners[2]), a));
  const DyadicVec columns[3] = {exact(m.linear[0]), exact(m.linear[1]), exact(m.linear[2])};
  const int mirrored = dot(columns[0], cross(columns[1], columns[2])).sign();
  const int facing = dot(normal, exact(direction)).sign() * mirrored;
  if (facing == 0) return;  // along the surface, or no direction

  scene::Scene scene;
  scene::Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions.assign(corners.begin(), corners.end());
  mesh.indices = {0, 1, 2};
  scene.instances.push_back({MeshId(0), m});
  const shading::TriangleGeometry geometry = shading::triangle_geometry(scene, 0, 0, u, v);
  if (geometry.area == 0) return;
  const shading::Side side = facing > 0 ? shading::Side::kFront : shading::Side::kBack;
  accel::OneLeaf leaf({&corners, 1});
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (!leaf.place(m, levels[i].transform)) continue;
    Ray ray;
    ray.origin = shading::spawn_point(geometry, side, levels[i].spawn);
    ray.direction = direction;
    const Hit hit = leaf.hit(ray, levels[i]);
    out[i].applies = true;
    out[i].broken = hit.valid();
    const double moved = glm::dot(DVec3(ray.origin) - geometry.position, geometry.normal) * facing;
    out[i].error = std::max(0.0, moved);
    if (story != nullptr)
      *story = {
          fmt::format("starts at {}, {:.3g} above the surface; {}", accel::text(ray.origin), moved, accel::text(hit)),
          fmt::format("the ray leaves to the {}, and a plane is met once", facing > 0 ? "front" : "back")};
  }
}

}  // namespace

accel::Property spawn_property() {
  using accel::AccuracyKey;
  return {"spawn",
          7,
          "a ray that leaves a triangle does not meet it",
          "moved off the surface",
          {AccuracyKey::kSpawn, AccuracyKey::kTransform},
          {{"linear", 9}, {"translation", 3}, {"a", 3}, {"b", 3}, {"c", 3}, {"u", 1}, {"v", 1}, {"direction", 3}},
          [](const AccuracyConfig& level) {
            return level.spawn == SpawnOffset::kBound && level.transform != TransformLevel::kInverseMatrix;
          },
          make_spawn,
          judge_spawn};
}

}  // namespace carousel::app
