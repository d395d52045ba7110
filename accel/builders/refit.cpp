#include "accel/builders/refit.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <unordered_map>

#include "accel/builders/mesh/primitive_blocks.h"
#include "accel/builders/quantised_boxes.h"
#include "accel/structure/cull_plane.h"
#include "accel/structure/sphere.h"
#include "scene/model/opacity.h"

namespace carousel::accel {

namespace {

bool same(const scene::Affine& a, const scene::Affine& b) {
  return a.linear == b.linear && a.translation == b.translation;
}

bool same_spheres(const std::vector<scene::Sphere>& a, const std::vector<scene::Sphere>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const scene::Sphere& one, const scene::Sphere& other) {
    return one.center == other.center && one.radius == other.radius && one.material == other.material &&
           one.program == other.program && one.half == other.half;
  });
}

/// All that decides the primitives of the mesh and which of them may be non-opaque.
bool same_primitives(const scene::Mesh& a, const scene::Mesh& b) {
  return a.positions == b.positions && a.colors == b.colors && a.uv0 == b.uv0 && a.uv1 == b.uv1 &&
         same_spheres(a.spheres, b.spheres);
}

/// The box of all that stands below a root, in its own space.
Aabb box_below(const Accel& accel, NodeRef root, const scene::Mesh& mesh) {
  if (root.is_inner()) return node_box(accel.nodes[root.node()]);
  Aabb box;
  for (const std::uint32_t index : mesh.indices) box.extend(mesh.positions[index]);
  for (const scene::Sphere& sphere : mesh.spheres) box.extend(box_around(sphere.center, sphere.reach()));
  return box;
}

/// Children stand behind their parents in the array, so that from its end on each node's children are done before it.
void refit_top(Accel& accel) {
  for (std::size_t i = accel.nodes.size(); i-- > 0;) {
    Node& node = accel.nodes[i];
    if (!node.above_instances) continue;
    for (int lane = 0; lane < node.count; ++lane) {
      const NodeRef child = node.child[lane];
      if (child.is_inner() && child.node() <= i) throw std::logic_error("a node stands behind its parent");
      set_child_box(
          node, lane,
          child.is_instance() ? accel.instances[child.instance_index()].world : node_box(accel.nodes[child.node()]));
    }
  }
}

}  // namespace

Aabb primitive_box(const scene::Mesh& mesh, std::uint32_t primitive) {
  if (primitive >= mesh.triangle_count()) {
    const scene::Sphere& sphere = mesh.spheres[primitive - mesh.triangle_count()];
    return box_around(sphere.center, sphere.reach());
  }
  Aabb box;
  for (std::size_t k = 0; k < 3; ++k) box.extend(mesh.positions[mesh.indices[3 * std::size_t{primitive} + k]]);
  return box;
}

Aabb node_box(const Node& node) {
  Aabb box;
  for (int lane = 0; lane < node.count; ++lane) box.extend(child_box(node, lane));
  return box;
}

void set_child_box(Node& node, int lane, const Aabb& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node.plane[axis][lane] = box.lo[axis];
    node.plane[axis + 3][lane] = box.hi[axis];
  }
}

void fill_leaf(Accel& accel, NodeRef leaf, const scene::Mesh& mesh, const scene::Opacity& opacity,
               const std::uint32_t* primitives) {
  const BlasMeshes meshes(mesh);
  for (std::uint32_t i = 0, left = leaf.triangles(); i < leaf.blocks(); ++i) {
    const std::uint32_t count = std::min<std::uint32_t>(left, kBlockTriangles);
    TriangleBlock moved;
    fill_block(meshes, opacity, primitives, count, moved);
    accel.blocks[leaf.first_block() + i] = moved;
    primitives += count;
    left -= count;
  }
}

Aabb refit_mesh(Accel& accel, NodeRef ref, const scene::Mesh& mesh, const scene::Opacity& opacity) {
  Aabb whole;
  if (!ref.is_inner()) {
    std::array<std::uint32_t, kMaxLeafTriangles> primitives{};
    for (std::uint32_t i = 0; i < ref.triangles(); ++i) {
      primitives[i] =
          accel.blocks[ref.first_block() + i / kBlockTriangles].primitive[i % kBlockTriangles] & kPrimitiveMask;
      whole.extend(primitive_box(mesh, primitives[i]));
    }
    fill_leaf(accel, ref, mesh, opacity, primitives.data());
    return whole;
  }
  Node& node = accel.nodes[ref.node()];
  for (int lane = 0; lane < node.count; ++lane) {
    const Aabb box = refit_mesh(accel, node.child[lane], mesh, opacity);
    set_child_box(node, lane, box);
    whole.extend(box);
  }
  return whole;
}

SceneChange change_of(const scene::Scene& before, const scene::Scene& after) {
  SceneChange out;
  if (before.meshes.size() != after.meshes.size() || before.instances.size() != after.instances.size()) {
    out.other = "there are other meshes or instances";
    return out;
  }
  for (std::uint32_t i = 0; i < after.meshes.size(); ++i) {
    const scene::Mesh &a = before.meshes[i], &b = after.meshes[i];
    if (a.indices != b.indices || a.triangle_materials != b.triangle_materials || a.spheres.size() != b.spheres.size())
      out.other = "a mesh has other triangles";
    else if (!same_primitives(a, b))
      out.meshes.push_back(i);
  }
  for (std::uint32_t i = 0; i < after.instances.size(); ++i) {
    const scene::Instance &a = before.instances[i], &b = after.instances[i];
    if (a.mesh != b.mesh)
      out.other = "an instance shows another mesh";
    else if (!same(a.world_from_model, b.world_from_model))
      out.instances.push_back(i);
  }
  return out;
}

ChangedParts changed_parts(const Accel& accel, const scene::Scene& scene, const SceneChange& change) {
  ChangedParts out;
  std::vector<bool> moved(scene.meshes.size());
  for (const std::uint32_t mesh : change.meshes) moved[mesh] = true;
  std::vector<bool> found(scene.meshes.size());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const std::uint32_t mesh = scene.instances[i].mesh.value;
    if (!moved[mesh] || found[mesh] || accel.instances[i].triangles == 0) continue;
    found[mesh] = true;
    out.meshes.push_back(accel.instances[i].root);
  }
  for (const std::uint32_t i : change.instances)
    if (accel.instances[i].triangles > 0) out.instances.push_back(i);
  out.top = !out.meshes.empty() || !out.instances.empty();
  return out;
}

std::string refit(Accel& accel, const scene::Scene& after, const SceneChange& change, BvhConfig::Storage storage,
                  Executor& executor, const UpdateMesh& update) {
  if (!change.other.empty()) return change.other;
  if (accel.baked_instances > 0) return "an instance with a singular transform stands in the world as triangles";
  std::vector<InstanceTransform> transforms(after.instances.size());
  std::size_t promoted = 0;
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    if (!make_transform(after.instances[i].world_from_model, transforms[i], accel.accuracy.transform))
      return "the transform of an instance has become singular";
    if (transforms[i].identity != accel.instances[i].transform.identity)
      return "an instance has come to stand in the world without a transform, or has left it";
    promoted += transforms[i].promoted;
  }
  if ((promoted > 0) != (accel.promoted_instances > 0)) return "transforms take another room";

  if (is_quantised(storage)) accel.nodes = std::move(accel.full_nodes);
  const scene::Opacity opacity(after);
  std::unordered_map<std::uint32_t, NodeRef> roots;  // by mesh
  for (std::size_t i = 0; i < after.instances.size(); ++i)
    if (accel.instances[i].triangles > 0) roots.emplace(after.instances[i].mesh.value, accel.instances[i].root);
  executor.parallel_for(change.meshes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      const auto root = roots.find(change.meshes[m]);
      if (root == roots.end()) continue;
      if (update)
        update(m, root->second, opacity);
      else
        refit_mesh(accel, root->second, after.meshes[change.meshes[m]], opacity);
    }
  });
  std::unordered_map<std::uint32_t, Aabb> boxes;  // by mesh
  for (const auto& [mesh, root] : roots) boxes.emplace(mesh, box_below(accel, root, after.meshes[mesh]));
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    InstanceNode& instance = accel.instances[i];
    instance.transform = transforms[i];
    if (instance.triangles == 0) continue;
    instance.world = world_box(after.instances[i].world_from_model, boxes.at(after.instances[i].mesh.value),
                               accel.accuracy.transform);
  }
  accel.promoted_instances = promoted;
  accel.has_non_opaque = std::any_of(accel.blocks.begin(), accel.blocks.end(), [](const TriangleBlock& block) {
    return std::any_of(std::begin(block.primitive), std::end(block.primitive), [](std::uint32_t primitive) {
      return primitive != kNoPrimitive && (primitive & kNonOpaqueBit) != 0;
    });
  });
  refit_top(accel);
  if (is_quantised(storage)) quantise_boxes(accel, plane_bits(storage));
  return "";
}

double surface_cost(const Accel& accel) {
  const NodeArray& nodes = accel.full_nodes.empty() ? accel.nodes : accel.full_nodes;
  struct Open {
    NodeRef ref;
    double area;
  };
  // The areas of all below `root`, which has that area itself; instances are given to `at_instance`.
  const auto areas = [&](NodeRef root, double area, const auto& at_instance) {
    double sum = 0;
    std::vector<Open> open{{root, area}};
    while (!open.empty()) {
      const Open at = open.back();
      open.pop_back();
      if (at.ref.is_instance()) {
        sum += at_instance(at.ref.instance_index(), at.area);
        continue;
      }
      sum += at.area * (at.ref.is_inner() ? 1.0 : at.ref.blocks());
      if (!at.ref.is_inner()) continue;
      const Node& node = nodes[at.ref.node()];
      for (int lane = 0; lane < node.count; ++lane)
        open.push_back({node.child[lane], child_box(node, lane).half_area()});
    }
    return sum;
  };
  std::unordered_map<std::uint32_t, double> visits;  // of a line through a mesh's box, by the bits of its root
  const auto visits_of = [&](NodeRef root) {
    const auto [place, is_new] = visits.emplace(root.bits(), root.is_inner() ? 1.0 : root.blocks());
    if (!is_new || !root.is_inner()) return place->second;
    const double area = node_box(nodes[root.node()]).half_area();
    if (area > 0) place->second = areas(root, area, [](std::uint32_t, double) { return 0.0; }) / area;
    return place->second;
  };
  const auto instance_areas = [&](std::uint32_t i, double area) { return area * visits_of(accel.instances[i].root); };
  const NodeKey root = accel.root_key();
  if (root.instance != kNoInstance) return visits_of(root.ref);
  if (!root.ref.is_inner() || nodes[root.ref.node()].count == 0) return 0;
  const double area = node_box(nodes[root.ref.node()]).half_area();
  return area > 0 ? areas(root.ref, area, instance_areas) / area : 0;
}

}  // namespace carousel::accel
