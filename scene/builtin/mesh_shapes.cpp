#include "scene/builtin/mesh_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "core/numeric/trigonometry.h"

namespace carousel::scene {

namespace {

std::uint32_t add_vertex(Mesh& mesh, Vec3 position, Vec3 normal) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, MaterialId material) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
  mesh.triangle_materials.push_back(material);
}

struct Icosphere {
  std::vector<Vec3> points;  // unit vectors
  std::vector<std::uint32_t> indices;
};

Icosphere icosahedron() {
  const float t = 0.5f * (1.0f + std::sqrt(5.0f));
  Icosphere s;
  s.points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
              {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  for (Vec3& p : s.points) p = glm::normalize(p);
  s.indices = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
               3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
  return s;
}

Icosphere subdivide(const Icosphere& coarse) {
  Icosphere fine{coarse.points, {}};
  fine.indices.reserve(coarse.indices.size() * 4);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) -> std::uint32_t {
    const auto [entry, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)}, 0u);
    if (fresh) {
      entry->second = static_cast<std::uint32_t>(fine.points.size());
      fine.points.push_back(glm::normalize(fine.points[a] + fine.points[b]));
    }
    return entry->second;
  };
  for (std::size_t i = 0; i < coarse.indices.size(); i += 3) {
    const std::uint32_t a = coarse.indices[i], b = coarse.indices[i + 1], c = coarse.indices[i + 2];
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.indices.insert(fine.indices.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
  }
  return fine;
}

const Icosphere& icosphere(int level) {
  // Each level is built once: a field of spheres uses the same one many times.
  thread_local std::vector<Icosphere> levels;
  if (levels.empty()) levels.push_back(icosahedron());
  while (levels.size() <= static_cast<std::size_t>(level)) levels.push_back(subdivide(levels.back()));
  return levels[static_cast<std::size_t>(level)];
}

}  // namespace

MaterialId add_material(Scene& scene, const char* name, Vec3 color, float metallic, float roughness) {
  Material m;
  m.name = name;
  m.base_color = Vec4(color, 1);
  m.metallic = metallic;
  m.roughness = roughness;
  scene.materials.push_back(m);
  return MaterialId(static_cast<std::uint32_t>(scene.materials.size() - 1));
}

void add_quad(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d, MaterialId material) {
  const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const std::uint32_t first = add_vertex(mesh, a, normal);
  add_vertex(mesh, b, normal);
  add_vertex(mesh, c, normal);
  add_vertex(mesh, d, normal);
  add_triangle(mesh, first, first + 1, first + 2, material);
  add_triangle(mesh, first, first + 2, first + 3, material);
}

void add_box(Mesh& mesh, Vec3 lo, Vec3 hi, MaterialId material) {
  const auto corner = [&](int x, int y, int z) { return Vec3{x ? hi.x : lo.x, y ? hi.y : lo.y, z ? hi.z : lo.z}; };
  add_quad(mesh, corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1), material);
  add_quad(mesh, corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0), material);
  add_quad(mesh, corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0), material);
  add_quad(mesh, corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1), material);
  add_quad(mesh, corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1), material);
  add_quad(mesh, corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0), material);
}

void add_icosphere(Mesh& mesh, Vec3 centre, float radius, int level, MaterialId material) {
  const Icosphere& unit = icosphere(level);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : unit.points) add_vertex(mesh, centre + radius * p, p);
  for (std::size_t i = 0; i < unit.indices.size(); i += 3) {
    add_triangle(mesh, first + unit.indices[i], first + unit.indices[i + 1], first + unit.indices[i + 2], material);
  }
}

void add_torus(Mesh& mesh, float major_radius, float minor_radius, int around, int across, MaterialId material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const float tau = 2 * std::numbers::pi_v<float>;
  for (int i = 0; i < around; ++i) {
    const float a = tau * static_cast<float>(i) / static_cast<float>(around);
    const Vec3 out{cos_float(a), 0, sin_float(a)};
    for (int j = 0; j < across; ++j) {
      const float b = tau * static_cast<float>(j) / static_cast<float>(across);
      const Vec3 normal = cos_float(b) * out + Vec3{0, sin_float(b), 0};
      add_vertex(mesh, major_radius * out + minor_radius * normal, normal);
    }
  }
  const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>((i % around) * across + j % across); };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      add_triangle(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1), material);
      add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i + 1, j), material);
    }
  }
}

void add_cone(Mesh& mesh, float radius, float height, int around, MaterialId material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const float tau = 2 * std::numbers::pi_v<float>;
  const auto normal_at = [&](float a) {
    return glm::normalize(Vec3{height * cos_float(a), radius, height * sin_float(a)});
  };
  for (int i = 0; i < around; ++i) {
    const float a = tau * static_cast<float>(i) / static_cast<float>(around);
    const float half = tau * (static_cast<float>(i) + 0.5f) / static_cast<float>(around);
    add_vertex(mesh, {radius * cos_float(a), 0, radius * sin_float(a)}, normal_at(a));
    add_vertex(mesh, {0, height, 0}, normal_at(half));  // its own apex: one shared normal would point nowhere
  }
  for (int i = 0; i < around; ++i) {
    const auto base = first + static_cast<std::uint32_t>(2 * i);
    add_triangle(mesh, base, base + 1, first + static_cast<std::uint32_t>(2 * ((i + 1) % around)), material);
  }
}

}  // namespace carousel::scene
