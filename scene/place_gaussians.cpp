#include "scene/place_gaussians.h"

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

#include "core/numeric/exponential.h"
#include "core/system/error.h"
#include "scene/builtin/mesh_shapes.h"

namespace carousel::scene {

namespace {

constexpr float kMargin = 1 + 0x1p-10f;

/// Standard deviations from the mean of a Gaussian to its end: as configured, or to where it takes the least share of
/// light that counts (N. Moenne-Loccoz et al. 2024, equation 9, with a least share of 0.01).
float reach_of(const Gaussian& gaussian, const GaussiansConfig& config) {
  if (config.least_alpha <= 0) return config.radius;
  const double times = double{gaussian.opacity} / double{config.least_alpha};
  constexpr double kLeastReach = 1e-3;
  const double reach = times > 1 ? std::sqrt(2 * log_precise(times)) : 0;
  return std::min(config.radius, static_cast<float>(std::max(reach, kLeastReach)));
}

/// From the unit sphere into the world. Turned so that it does not mirror, which changes no Gaussian.
Mat3 shape_of(const Gaussian& gaussian, float times) {
  Mat3 out = gaussian.spread * (gaussian.reach * times);
  if (glm::determinant(out) < 0) out[0] = -out[0];
  return out;
}

/// A node of a file may move a Gaussian out of single precision, or stretch it beyond.
bool is_finite(const Gaussian& gaussian) {
  const Mat3 shape = shape_of(gaussian, 2);  // farther than the corners of its triangles
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i)
      if (!std::isfinite(gaussian.mean[i] + shape[axis][i]) || !std::isfinite(gaussian.mean[i] - shape[axis][i]))
        return false;
  return true;
}

void leave_out_harmonics(GaussianCloud& cloud, int above) {
  if (cloud.degree <= above) return;
  const std::size_t had = higher_harmonics(cloud.degree), has = higher_harmonics(above);
  for (std::size_t i = 0; i < cloud.shapes.size(); ++i)
    for (std::size_t k = 0; k < has; ++k) cloud.harmonics[i * has + k] = cloud.harmonics[i * had + k];
  cloud.harmonics.resize(cloud.shapes.size() * has);
  cloud.harmonics.shrink_to_fit();
  cloud.degree = above;
}

void place_ellipsoids(Scene& scene, MaterialId material) {
  Mesh mesh;
  mesh.name = "unit sphere";
  mesh.spheres.push_back({Vec3(0), 1, material});
  scene.meshes.push_back(std::move(mesh));
  scene.instances.reserve(scene.gaussians.shapes.size());
  for (const Gaussian& gaussian : scene.gaussians.shapes)
    scene.instances.push_back({MeshId(0), {shape_of(gaussian, kMargin), gaussian.mean}});
}

void place_triangles(Scene& scene, MaterialId material) {
  Mesh unit;
  add_icosphere(unit, Vec3(0), 1, 0, material);
  constexpr float kAroundSphere = 1.2584085f;  // of an icosahedron: radius of its corners over that of its faces
  Mesh mesh;
  mesh.name = "triangles around Gaussians";
  mesh.positions.reserve(scene.gaussians.shapes.size() * unit.positions.size());
  mesh.indices.reserve(scene.gaussians.shapes.size() * unit.indices.size());
  for (const Gaussian& gaussian : scene.gaussians.shapes) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Mat3 shape = shape_of(gaussian, kAroundSphere * kMargin);
    for (const Vec3& p : unit.positions) mesh.positions.push_back(gaussian.mean + shape * p);
    for (const std::uint32_t i : unit.indices) mesh.indices.push_back(first + i);
  }
  mesh.triangle_materials.assign(mesh.triangle_count(), material);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({MeshId(0), {}});
}

}  // namespace

void place_gaussians(Scene& scene, const GaussiansConfig& config, const std::string& file) {
  if (scene.gaussians.empty()) return;
  const auto shows = [](const Mesh& mesh) { return !mesh.indices.empty() || !mesh.spheres.empty(); };
  if (std::any_of(scene.meshes.begin(), scene.meshes.end(), shows))
    throw SceneError(file, "", "has Gaussians and triangles; expected Gaussians alone, or none");
  constexpr std::size_t kMost = (std::size_t{1} << 28) / kProxyTriangles;
  if (scene.gaussians.shapes.size() > kMost)
    throw SceneError(file, "",
                     "expected at most " + std::to_string(kMost) + " Gaussians, found " +
                         std::to_string(scene.gaussians.shapes.size()));
  scene.meshes.clear();
  scene.instances.clear();
  scene.groups.clear();
  scene.placements.clear();
  scene.nodes.clear();
  scene.gaussians.geometry = config.geometry;
  if (config.degree) leave_out_harmonics(scene.gaussians, static_cast<int>(*config.degree));
  scene.gaussians.opaque_below = config.opaque_below;
  for (Gaussian& gaussian : scene.gaussians.shapes) {
    gaussian.reach = reach_of(gaussian, config);
    if (!is_finite(gaussian))
      throw SceneError(file, "",
                       "Gaussian " + std::to_string(&gaussian - scene.gaussians.shapes.data()) +
                           " lies or reaches beyond the numbers of single precision");
  }
  const MaterialId material(static_cast<std::uint32_t>(scene.materials.size()));
  Material& made = scene.materials.emplace_back();
  made.name = "Gaussians";
  made.unlit = true;  // nothing is lit by rays from it
  if (config.geometry == GaussiansConfig::Geometry::kEllipsoids)
    place_ellipsoids(scene, material);
  else
    place_triangles(scene, material);
}

}  // namespace carousel::scene
