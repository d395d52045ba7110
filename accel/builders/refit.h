#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/fields/bvh.h"
#include "core/system/executor.h"
#include "core/types/aabb.h"
#include "scene/model/opacity.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// This names what differs between a scene at two moments.
struct SceneChange {
  std::vector<std::uint32_t> meshes;     ///< those with another vertex or sphere
  std::vector<std::uint32_t> instances;  ///< those that stand elsewhere
  std::string other;  ///< a clause that says why they are not one scene that moves; empty if they are

  bool none() const { return meshes.empty() && instances.empty() && other.empty(); }
};
SceneChange change_of(const scene::Scene& before, const scene::Scene& after);

/// The parts of a structure that a change of the scene touches.
struct ChangedParts {
  std::vector<NodeRef> meshes;           ///< roots of structures over meshes, each once
  std::vector<std::uint32_t> instances;  ///< those whose stored transform is another
  bool top = false;                      ///< the nodes of the top level
};
ChangedParts changed_parts(const Accel& accel, const scene::Scene& scene, const SceneChange& change);

/// Brings the structure below a root to its mesh as it now is: of the change's mesh of this number.
using UpdateMesh = std::function<void(std::size_t number, NodeRef root, const scene::Opacity& opacity)>;

/// Gives a structure over `before` the boxes, primitives and transforms of `after`, which differs from it by `change`.
/// Nodes, leaves and their places stay as they are, and each box is the union of those below it, as in a structure that
/// is built: so the hits are those of a structure over `after` that is built from nothing. `storage` is that with which
/// the structure was built, and with which boxes are rounded again. Returns why that cannot be,
/// as a clause, and leaves the structure as it was; an empty text if it is done. Preconditions: a structure of two
/// levels whose nodes hold boxes, without cull planes, merged meshes or a partition. `update`, which is called by any
/// thread and once a mesh, takes the place of the refit of a mesh.
std::string refit(Accel& accel, const scene::Scene& after, const SceneChange& change, BvhConfig::Storage storage,
                  Executor& executor, const UpdateMesh& update = {});

/// Refits the nodes and leaves below a root to a mesh, and returns their box.
Aabb refit_mesh(Accel& accel, NodeRef root, const scene::Mesh& mesh, const scene::Opacity& opacity);

/// The box of a primitive by its number in the mesh, triangles first.
Aabb primitive_box(const scene::Mesh& mesh, std::uint32_t primitive);
/// The box around the children of a node.
Aabb node_box(const Node& node);
void set_child_box(Node& node, int lane, const Aabb& box);
/// Puts these primitives into a leaf, as many as it has.
void fill_leaf(Accel& accel, NodeRef leaf, const scene::Mesh& mesh, const scene::Opacity& opacity,
               const std::uint32_t* primitives);

/// Nodes and blocks that a line through the scene's box meets on average, the top level with them: the sum of their
/// areas over that of the scene, a mesh's weighted by the areas of its instances' world boxes (MacDonald, Booth 1990,
/// as StructureSize::surface_cost). It grows as a tree that is refitted wears out.
double surface_cost(const Accel& accel);

}  // namespace carousel::accel
