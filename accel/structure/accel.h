#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "accel/structure/bounding_elements.h"
#include "accel/structure/cull_plane.h"
#include "accel/structure/gaussian_shapes.h"
#include "accel/structure/group_placement.h"
#include "accel/structure/guest_shapes.h"
#include "accel/structure/merged_meshes.h"
#include "accel/structure/micromap_places.h"
#include "accel/structure/node.h"
#include "accel/structure/partition.h"
#include "accel/structure/tree_pieces.h"
#include "accel/transform/transform.h"
#include "core/config/fields/accuracy.h"
#include "core/program/program.h"
#include "core/types/aabb.h"
#include "core/types/any_hit.h"
#include "core/types/hit_sink.h"
#include "core/types/nearest_sink.h"

namespace carousel::accel {

class PackedLeaves;

/// One placement of a bottom-level structure.
struct InstanceNode {
  NodeRef root;  ///< inner node or leaf of the mesh's BLAS
  InstanceTransform transform;
  Aabb world;                   ///< a hit has to lie in it (docs/how-it-works/design.md, What a hit is)
  std::uint8_t strip_size = 0;  ///< shapes below the root
  bool group = false;           ///< the root belongs to a group's structure, described by a GroupPlacement
  bool member = false;          ///< the instance is a group's member: a ray's way to it leads through a group's nodes
  std::uint32_t triangles = 0;
};

/// Two levels: a TLAS over instances and a BLAS a mesh, all nodes in one array and all triangles in another. With
/// `bvh.levels` above 2 there are structures over groups between them, a structure shared by all placements of its
/// group, up to eight levels in all (US 12394134, paragraph 5).
/// Immutable once built; any thread may read. The top level's root is an inner node, with no children when the
/// scene is empty.
struct Accel {
  NodeArray nodes;
  BlockArray blocks;
  NodeArray full_nodes;                        ///< with bvh.storage: quantised the nodes as they were; else empty
  std::vector<CullPlane> planes;               ///< in order of the nodes; empty without cull_planes
  BoundingElements elements;                   ///< tested instead of nodes' boxes; empty with bvh.elements: boxes
  bool shared_normals = false;                 ///< siblings share their normals; `planes` repeats them
  bool second_spheres = false;                 ///< in place of planes, see CullPlane
  bool planes_first = false;                   ///< a child's planes are tested before its box
  std::uint64_t plane_bytes = 0;               ///< bytes of the planes, with shared normals counted once
  std::vector<InstanceNode> instances;         ///< indexed as Scene::instances; behind these the placements of groups
  std::vector<GroupPlacement> groups;          ///< one for each placement, the last instances; empty with two levels
  std::vector<std::uint32_t> members;          ///< instances that are the members of these placements, in their order
  MergedMeshes merged;                         ///< meshes of several instances with one structure in the top level
  NodeKey root;                                ///< as root_key()
  std::shared_ptr<const Partition> partition;  ///< null: all shapes are here
  std::shared_ptr<GuestShapes> guests;         ///< shapes of other ranks while packets bring them; with `partition`
  std::shared_ptr<const TreePieces> pieces;    ///< null: the tree is not cut (`bvh.treelets`)
  std::shared_ptr<const PackedLeaves> packed;  ///< null: leaves are not compressed (`bvh.leaves: blocks`)
  const AnyHit* any_hit = nullptr;  ///< answers any-hit calls, set before tracing; null: every surface is opaque
  PlacedMicromaps micromaps;        ///< asked before `any_hit`, set with it
  HitSink* all_hits = nullptr;      ///< takes the hits of rays with kRayAll, set before tracing; null: no ray has it
  NearestSink* nearest_hits = nullptr;  ///< takes the hits of rays that look for several, set before tracing; or null
  std::shared_ptr<const GaussianShapes> gaussians;  ///< null: the scene consists of surfaces
  std::vector<RayProgram> programs;                 ///< of primitives; kept by no rank apart, as a unit holds them all
  AccuracyConfig accuracy;                          ///< arithmetic of the tests on it
  bool procedural_primitives = false;               ///< there are some
  bool has_non_opaque = false;                      ///< some primitives have kNonOpaqueBit
  int width = kMaxWidth;                            ///< children a node at most
  int max_depth = 0;                                ///< strips on the longest way down: TLAS nodes + BLAS nodes + leaf
  std::size_t baked_instances = 0;                  ///< singular transforms, stored as world-space triangles
  std::size_t promoted_instances = 0;               ///< nearly singular ones, whose rays are transformed in double

  /// A hit that is reported costs a call.
  bool calls_any_hit() const { return (has_non_opaque && any_hit != nullptr) || all_hits != nullptr; }
  /// Places on the longest way down where a ray may be in a collection: strips, or pieces of the tree.
  int levels() const { return pieces ? pieces->depth : max_depth; }
  /// The most other places that a ray may come to from one of them.
  int most_ways() const { return pieces ? std::max(1, static_cast<int>(pieces->most_exits)) : width; }
  /// Bytes of the structure at this rank.
  std::size_t size_bytes() const {
    return nodes.here() * sizeof(Node) + blocks.here() * sizeof(TriangleBlock) + elements.size_bytes() + plane_bytes +
           instances.size() * sizeof(InstanceNode) + groups.size() * sizeof(GroupPlacement) +
           members.size() * sizeof(std::uint32_t) + (gaussians ? gaussians->size_bytes() : 0);
  }
  /// The node at which every ray starts: the top level's root, or the root of the only instance.
  NodeKey root_key() const { return root; }
  /// The node a child lane leads to; an instance child leads to the root of its BLAS.
  NodeKey child_key(NodeKey parent, int lane) const {
    const NodeRef ref = nodes[parent.ref.node()].child[lane];
    if (!ref.is_instance()) return {parent.instance, ref};
    const std::uint32_t instance = instance_at(parent.instance, ref);
    return {instance, instances[instance].root};
  }
  /// The instance that a child of a node leads to: in the top level its own number, in a group that of a member.
  std::uint32_t instance_at(std::uint32_t parent, NodeRef child) const {
    if (parent == kNoInstance) [[likely]]
      return child.instance_index();
    return members[group(parent).first_member + child.instance_index()];
  }
  /// The placement that an instance stands for; the instance must be the placement of a group.
  const GroupPlacement& group(std::uint32_t instance) const {
    return groups[instance - (instances.size() - groups.size())];
  }
  bool is_group(std::uint32_t instance) const {
    return !groups.empty() && instance != kNoInstance && instances[instance].group;
  }
  /// True where rays come out of a group's nodes: they are then tested against the world box of what they come to.
  bool enters_member(NodeKey key) const {
    return !groups.empty() && key.instance != kNoInstance && instances[key.instance].member &&
           instances[key.instance].root == key.ref;
  }
  /// The leaf that `node` holds itself in a lane of its `direct`. In the top level it belongs to an instance without a
  /// transform.
  NodeRef held_leaf(const Node& node, int lane) const {
    const NodeRef child = node.child[lane];
    return child.is_instance() ? instances[child.instance_index()].root : child;
  }
  /// Shapes in the strip of `key`: children of an inner node, triangles of a leaf.
  int strip_size(NodeKey key) const;
  /// Shapes in the strip of the child in a lane of `parent`; the child need not be here.
  int child_strip_size(NodeKey parent, int lane) const { return nodes[parent.ref.node()].strip_size[lane]; }
  /// Triangles below `key`.
  std::uint32_t triangles_below(NodeKey key) const;
};

}  // namespace carousel::accel
