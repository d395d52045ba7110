#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/fields/bvh.h"
#include "core/system/executor.h"
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

/// Gives a structure over `before` the boxes, primitives and transforms of `after`, which differs from it by `change`.
/// Nodes, leaves and their places stay as they are, and each box is the union of those below it, as in a structure that
/// is built: so the hits are those of a structure over `after` that is built from nothing. `storage` is that with which
/// the structure was built, and with which boxes are rounded again. Returns why that cannot be,
/// as a clause, and leaves the structure as it was; an empty text if it is done. Preconditions: a structure of two
/// levels whose nodes hold boxes, without cull planes, merged meshes or a partition.
std::string refit(Accel& accel, const scene::Scene& after, const SceneChange& change, BvhConfig::Storage storage,
                  Executor& executor);

/// Nodes and blocks that a line through the scene's box meets on average, the top level with them: the sum of their
/// areas over that of the scene, a mesh's weighted by the areas of its instances' world boxes (MacDonald, Booth 1990,
/// as StructureSize::surface_cost). It grows as a tree that is refitted wears out.
double surface_cost(const Accel& accel);

}  // namespace carousel::accel
