#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "accel/builders/refit.h"
#include "accel/structure/accel.h"
#include "core/config/fields/bvh.h"
#include "core/system/executor.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// A subtree whose nodes and leaves keep their places, and whose primitives stay in it. They are all triangles, or all
/// procedural.
struct Cluster {
  NodeRef root;
  std::uint32_t primitives = 0;
};

/// The structure over a mesh, cut into clusters and the nodes above them.
struct MeshClusters {
  std::uint32_t mesh = 0;
  NodeRef root;
  std::vector<Cluster> clusters;     ///< at first depth first
  std::vector<std::uint32_t> above;  ///< nodes, depth first; none if the mesh is one cluster
};

/// The clusters of all meshes, in the order of their first instances.
struct TreeClusters {
  std::vector<MeshClusters> meshes;

  std::uint64_t count() const;
};

/// Cuts the structure of each mesh: a cluster is a largest subtree of at most `most` primitives of one kind. A leaf is
/// one though it has more. Without a value of `most` it is the least power of two for which the mesh has at most
/// `most_dealt` clusters, or the last one up to that number. Preconditions: those of refit().
TreeClusters cut_clusters(const Accel& accel, const scene::Scene& scene, std::optional<std::uint32_t> most,
                          std::uint64_t most_dealt);

/// Clusters below a node above them were dealt out anew.
struct DealtClusters {
  NodeRef root;
  std::vector<std::uint32_t> clusters;  ///< those below, depth first
  std::vector<std::uint32_t> nodes;     ///< above them, the root first, depth first
  std::vector<bool> hangs_anew;         ///< for each of these: it has another cluster for a child
  std::vector<bool> changes;            ///< or a cluster below it is another or has moved
  std::uint64_t boxes = 0;              ///< how often a box was added to another
  bool is_better = false;               ///< a better arrangement was found
};

/// The work of an update in one mesh.
struct ClusterWork {
  std::uint32_t mesh = 0;            ///< number in TreeClusters::meshes
  std::vector<std::uint32_t> moved;  ///< clusters with a primitive that has moved
  std::vector<std::uint64_t> boxes;  ///< for each of these: how often a box was added to another
  std::vector<bool> is_better;       ///< for each: its primitives got another order
  std::vector<DealtClusters>
      dealt;  ///< nodes above that are in none of these, and have a moved cluster below, are refitted
};

/// Brings a structure over `before` to `after` as refit() does, but for meshes that changed: in a cluster of which a
/// primitive has moved, the primitives are dealt out anew to its leaves (deal.h), if the sum of the areas becomes less
/// than that of a refit. Then the same is done below the highest nodes above clusters of which at least one cluster in
/// four has moved: the clusters are dealt out to the places where they hang. Other nodes above are refitted, and in a
/// mesh of more than `most_dealt` clusters all of them. `work` has a row for each mesh that changed. Nodes and leaves
/// keep their places and sizes. Throws what refit() throws.
std::string update_clusters(Accel& accel, TreeClusters& clusters, const scene::Scene& before, const scene::Scene& after,
                            const SceneChange& change, BvhConfig::Storage storage, std::uint64_t most_dealt,
                            Executor& executor, std::vector<ClusterWork>& work);

}  // namespace carousel::accel
