#include "scene/gltf/pose/transform.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace carousel::scene {

std::optional<DMat4> compose_trs(const DVec3& translation, const double (&rotation)[4], const DVec3& scale) {
  const glm::dquat q(rotation[3], rotation[0], rotation[1], rotation[2]);  // w first
  const double length = std::sqrt(glm::dot(q, q));
  if (!(length > 1e-12) || !std::isfinite(length)) return std::nullopt;
  const glm::dmat3 r = glm::mat3_cast(q / length);
  return DMat4(glm::dvec4(r[0] * scale.x, 0), glm::dvec4(r[1] * scale.y, 0), glm::dvec4(r[2] * scale.z, 0),
               glm::dvec4(translation, 1));
}

DMat4 node_transform(const GltfDocument& document, const tinygltf::Node& node, const std::string& path) {
  if (node.matrix.size() == 16) {
    DMat4 m;
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) m[c][r] = node.matrix[static_cast<std::size_t>(4 * c + r)];
    }
    const double off = std::abs(m[0][3]) + std::abs(m[1][3]) + std::abs(m[2][3]) + std::abs(m[3][3] - 1);
    if (!(off < 1e-6))
      document.fail(json_path(path, "matrix"), "the last row must be 0 0 0 1: not an affine transform");
    m[0][3] = m[1][3] = m[2][3] = 0;
    m[3][3] = 1;
    return m;
  }
  const auto triple = [](const std::vector<double>& v, double fallback) {
    return v.size() == 3 ? DVec3(v[0], v[1], v[2]) : DVec3(fallback);
  };
  double rotation[4] = {0, 0, 0, 1};
  if (node.rotation.size() == 4) std::copy(node.rotation.begin(), node.rotation.end(), rotation);
  const auto local = compose_trs(triple(node.translation, 0), rotation, triple(node.scale, 1));
  if (!local) document.fail(json_path(path, "rotation"), "the quaternion has length zero");
  return *local;
}

Affine rounded(const GltfDocument& document, const DMat4& world, const std::string& path) {
  Affine out;
  bool finite = true;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 3; ++r) {
      const auto v = static_cast<float>(world[c][r]);
      finite = finite && std::isfinite(v);
      (c < 3 ? out.linear[c][r] : out.translation[r]) = v;
    }
  }
  if (!finite) document.fail(path, "the transform to world space is too large for single precision");
  return out;
}

DVec3 moved_normal(const DMat4& m, const DVec3& normal) {
  // The inverse transpose, but for its length; it exists for flat matrices as well.
  const DVec3 a(m[0]), b(m[1]), c(m[2]);
  const DMat3 cofactors(glm::cross(b, c), glm::cross(c, a), glm::cross(a, b));
  const DVec3 moved = cofactors * normal;
  const double length = glm::length(moved);
  if (!(length > 0)) return normal;
  return moved / (glm::dot(a, cofactors[0]) < 0 ? -length : length);
}

std::optional<Frame> orthonormal_frame(const DMat4& world) {
  const auto direction = [](DVec3 v) -> std::optional<DVec3> {
    const double length = glm::length(v);
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    return v / length;
  };
  const auto back = direction(DVec3(world[2]));
  if (!back) return std::nullopt;
  DVec3 up(world[1]);
  if (const auto unit_up = direction(up)) up = *unit_up;
  auto right = direction(glm::cross(up, *back));
  if (!right) right = direction(glm::cross(std::abs(back->y) < 0.9 ? DVec3(0, 1, 0) : DVec3(1, 0, 0), *back));
  return Frame{Vec3(*right), Vec3(glm::cross(*back, *right)), Vec3(*back)};
}

}  // namespace carousel::scene
