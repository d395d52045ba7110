#include "scene/model/fitted_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/geometric.hpp>

#include "core/numeric/trigonometry.h"
#include "scene/model/camera_pose.h"
#include "scene/model/floor_plan.h"

namespace carousel::scene {

namespace {

/// The positions that triangles use: a file may hold others, which nobody sees. The corners of their box stand for
/// them where instances make them too many to visit.
std::vector<Vec3> outline(const Mesh& mesh, std::size_t instances) {
  constexpr std::size_t kMostVisits = 50'000'000;
  std::vector<bool> used(mesh.positions.size());
  for (const std::uint32_t i : mesh.indices) used[i] = true;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) points.push_back(mesh.positions[i]);
  if (points.size() * instances <= kMostVisits || points.size() <= 8) return points;
  Aabb box;
  for (const Vec3& p : points) box.extend(p);
  points.clear();
  for (int corner = 0; corner < 8; ++corner)
    points.emplace_back(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                        corner & 4 ? box.hi.z : box.lo.z);
  return points;
}

using Outlines = std::vector<std::vector<Vec3>>;

Outlines outlines_of(const Scene& scene, std::span<const Instance> shown) {
  std::vector<std::size_t> instances(scene.meshes.size());
  for (const Instance& instance : shown) ++instances[instance.mesh.value];
  Outlines out(scene.meshes.size());
  for (std::size_t m = 0; m < out.size(); ++m)
    if (instances[m] > 0) out[m] = outline(scene.meshes[m], instances[m]);
  return out;
}

/// The largest value of each direction's product with a point of the model, relative to `centre`.
template <std::size_t N>
std::array<double, N> extents(const Scene& scene, std::span<const Instance> shown, const Outlines& outlines,
                              const DVec3& centre, const std::array<DVec3, N>& directions) {
  std::array<double, N> out;
  out.fill(-std::numeric_limits<double>::infinity());
  // How far the shapes of Gaussians reach depends on scene.gaussians.geometry, and their picture must not.
  for (const Gaussian& gaussian : scene.gaussians.shapes)
    for (std::size_t d = 0; d < N; ++d) {
      const DVec3 local = directions[d] * DMat3(gaussian.spread);
      out[d] = std::max(
          out[d], glm::dot(directions[d], DVec3(gaussian.mean) - centre) + double{gaussian.reach} * glm::length(local));
    }
  if (!scene.gaussians.empty()) return out;
  for (const Instance& instance : shown) {
    const glm::dmat3 linear(instance.world_from_model.linear);
    const DVec3 offset = DVec3(instance.world_from_model.translation) - centre;
    for (std::size_t d = 0; d < N; ++d) {
      const DVec3 local = directions[d] * linear;  // the transpose of `linear` times the direction
      const double shift = glm::dot(directions[d], offset);
      for (const Vec3& p : outlines[instance.mesh.value]) out[d] = std::max(out[d], glm::dot(local, DVec3(p)) + shift);
      for (const Sphere& s : scene.meshes[instance.mesh.value].spheres)
        out[d] = std::max(out[d], glm::dot(local, DVec3(s.center)) + s.radius * glm::length(local) + shift);
    }
  }
  return out;
}

}  // namespace

Camera fitted_camera(const Scene& scene, float aspect) {
  return fitted_camera(scene, aspect, scene.instances);
}

Camera fitted_camera(const Scene& scene, float aspect, std::span<const Instance> shown) {
  constexpr double kFieldOfView = 0.7, kMargin = 1.04;
  const DVec3 back = glm::normalize(DVec3(0.45, 0.35, 1));
  Camera camera = look_at(Vec3(back), Vec3(0), static_cast<float>(kFieldOfView));
  camera.name = "fitted";
  const DVec3 right(camera.right), up(camera.up);
  const Outlines outlines = outlines_of(scene, shown);
  const std::array<DVec3, 6> axes{DVec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  std::array<double, 6> box = extents(scene, shown, outlines, DVec3(0), axes);
  if (!(box[0] >= -box[3])) box.fill(1);  // there is nothing to see
  const DVec3 hi(box[0], box[1], box[2]), lo(-box[3], -box[4], -box[5]), centre = 0.5 * (hi + lo);
  const double high = tan_double(0.5 * kFieldOfView) / kMargin, wide = high * aspect;

  // A point p is in the frame of a camera at c if right.(p - c) <= wide back.(c - p), and so on for the other edges:
  // each edge is a plane through the camera. The planes that touch the model give the camera's place.
  const std::array<DVec3, 5> edges{right + wide * back, wide * back - right, up + high * back, high * back - up, back};
  std::array<double, 5> e = extents(scene, shown, outlines, centre, edges);
  if (!(e[0] > -1e300)) e = {1, 1, 1, 1, 0};
  const double size = std::max(1e-30, glm::length(hi - lo));
  double distance = std::max({(e[0] + e[1]) / (2 * wide), (e[2] + e[3]) / (2 * high), e[4] + 1e-3 * size});
  // Far enough for the camera to differ from the centre after rounding, near enough to stay finite.
  const double magnitude = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z), 1e-20});
  distance = std::clamp(distance, 1e-4 * magnitude, 1e38);
  const DVec3 eye = centre + 0.5 * (e[0] - e[1]) * right + 0.5 * (e[2] - e[3]) * up + distance * back;
  camera.position = Vec3(glm::clamp(eye, DVec3(-3e38), DVec3(3e38)));
  return camera;
}

void make_up_camera(Scene& scene, float aspect) {
  const std::optional<Camera> inside = scene.gaussians.empty() ? inside_camera(scene) : std::nullopt;
  scene.cameras[0] = inside ? *inside : fitted_camera(scene, aspect);
  scene.added.inside = inside.has_value();
}

}  // namespace carousel::scene
