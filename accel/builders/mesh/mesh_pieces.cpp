#include "accel/builders/mesh/mesh_pieces.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

#include "core/types/aabb.h"

namespace carousel::accel {

namespace {

/// Three times the middle of a primitive, in which it need not be divided.
Vec3 middle(const scene::Mesh& mesh, std::uint32_t primitive) {
  const std::size_t triangles = mesh.triangle_count();
  if (primitive >= triangles) return mesh.spheres[primitive - triangles].center * 3.0f;
  const std::uint32_t* const corner = &mesh.indices[std::size_t{3} * primitive];
  return mesh.positions[corner[0]] + mesh.positions[corner[1]] + mesh.positions[corner[2]];
}

void divide(const scene::Mesh& mesh, std::size_t most, std::span<std::uint32_t> primitives,
            std::vector<MeshPiece>& out) {
  if (primitives.size() <= most) {
    out.emplace_back(primitives.begin(), primitives.end());
    std::sort(out.back().begin(), out.back().end());
    return;
  }
  Aabb box;
  for (const std::uint32_t p : primitives) box.extend(middle(mesh, p));
  const Vec3 side = box.extent();
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const auto half = primitives.begin() + static_cast<std::ptrdiff_t>(primitives.size() / 2);
  std::nth_element(primitives.begin(), half, primitives.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(middle(mesh, a)[axis], a) < std::tuple(middle(mesh, b)[axis], b);
  });
  divide(mesh, most, {primitives.begin(), half}, out);
  divide(mesh, most, {half, primitives.end()}, out);
}

}  // namespace

std::vector<MeshPiece> divide_mesh(const scene::Mesh& mesh, std::size_t most) {
  std::vector<std::uint32_t> primitives(mesh.triangle_count() + mesh.spheres.size());
  std::iota(primitives.begin(), primitives.end(), 0u);
  std::vector<MeshPiece> out;
  divide(mesh, most, primitives, out);
  return out;
}

}  // namespace carousel::accel
