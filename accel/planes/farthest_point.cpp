#include "accel/planes/farthest_point.h"

#include <algorithm>
#include <array>
#include <limits>

#include <glm/geometric.hpp>

#include "accel/structure/sphere.h"

namespace carousel::accel {

namespace {

void raise_by_leaf(const Accel& accel, NodeRef leaf, const DVec3& direction, double& most) {
  for (std::uint32_t i = 0; i < leaf.triangles(); ++i) {
    const TriangleBlock& block = accel.blocks[leaf.first_block() + i / kBlockTriangles];
    if (leaf.is_procedural()) {
      const BlockSphere sphere = sphere_in(block, i % kBlockTriangles);
      most = std::max(most, glm::dot(direction, DVec3(sphere.centre)) + sphere.radius * glm::length(direction));
      continue;
    }
    for (const auto& vertex : block.vertex) {
      const DVec3 p(vertex[0][i % kBlockTriangles], vertex[1][i % kBlockTriangles], vertex[2][i % kBlockTriangles]);
      most = std::max(most, direction.x * p.x + direction.y * p.y + direction.z * p.z);
    }
  }
}

// Visits the children whose boxes reach farthest first, and skips those that reach less far than the best point.
void raise(const Accel& accel, NodeRef ref, const DVec3& direction, double& most) {
  if (!ref.is_inner()) {
    raise_by_leaf(accel, ref, direction, most);
    return;
  }
  const Node& node = accel.nodes[ref.node()];
  struct Child {
    double bound;
    NodeRef ref;
  };
  std::array<Child, kMaxWidth> children;
  const std::size_t count = node.count;
  for (std::size_t lane = 0; lane < count; ++lane)
    children[lane] = {farthest_corner(child_box(node, static_cast<int>(lane)), direction), node.child[lane]};
  std::sort(children.begin(), children.begin() + count,
            [](const Child& a, const Child& b) { return a.bound > b.bound; });
  for (std::size_t i = 0; i < count && children[i].bound > most; ++i) raise(accel, children[i].ref, direction, most);
}

}  // namespace

double farthest_along(const Accel& accel, NodeRef root, const DVec3& direction, CullPlanesConfig::Fit fit) {
  double most = -std::numeric_limits<double>::infinity();
  if (fit == CullPlanesConfig::Fit::kVertices || !root.is_inner()) {
    raise(accel, root, direction, most);
    return most;
  }
  const Node& node = accel.nodes[root.node()];
  for (int lane = 0; lane < node.count; ++lane)
    most = std::max(most, farthest_corner(child_box(node, lane), direction));
  return most;
}

Aabb model_box(const Accel& accel, NodeRef root) {
  Aabb box;
  if (root.is_inner()) {
    const Node& node = accel.nodes[root.node()];
    for (int lane = 0; lane < node.count; ++lane) {
      const Aabb child = child_box(node, lane);
      box.extend(child.lo);
      box.extend(child.hi);
    }
    return box;
  }
  for (std::uint32_t i = 0; i < root.triangles(); ++i) {
    const TriangleBlock& block = accel.blocks[root.first_block() + i / kBlockTriangles];
    if (root.is_procedural()) {
      box.extend(procedural_box(block, i % kBlockTriangles));
      continue;
    }
    for (const auto& vertex : block.vertex)
      box.extend(Vec3{vertex[0][i % kBlockTriangles], vertex[1][i % kBlockTriangles], vertex[2][i % kBlockTriangles]});
  }
  return box;
}

}  // namespace carousel::accel
