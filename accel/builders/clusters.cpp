#include "accel/builders/clusters.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "accel/builders/deal.h"
#include "accel/structure/cull_plane.h"

namespace carousel::accel {

namespace {

/// Some leaves of a subtree, or all of its kind: calls visit(leaf) depth first.
template <class Visit>
void each_leaf(const Accel& accel, NodeRef ref, const Visit& visit) {
  if (!ref.is_inner()) return visit(ref);
  const Node& node = accel.nodes[ref.node()];
  for (int lane = 0; lane < node.count; ++lane) each_leaf(accel, node.child[lane], visit);
}

int depth_of(const Accel& accel, NodeRef ref) {
  if (!ref.is_inner()) return 1;
  const Node& node = accel.nodes[ref.node()];
  int below = 0;
  for (int lane = 0; lane < node.count; ++lane) below = std::max(below, depth_of(accel, node.child[lane]));
  return below + 1;
}

std::uint32_t primitives_of(const Accel& accel, NodeRef ref) {
  return ref.is_inner() ? accel.nodes[ref.node()].triangles : ref.triangles();
}

class Cut {
 public:
  Cut(const Accel& accel, std::uint32_t most) : accel_(accel), most_(most) {}

  MeshClusters run(std::uint32_t mesh, NodeRef root) {
    out_ = {mesh, root, {}, {}};
    divide(root);
    return std::move(out_);
  }

 private:
  bool of_one_kind(NodeRef ref) const {
    bool triangles = false, others = false;
    each_leaf(accel_, ref, [&](NodeRef leaf) { (leaf.is_procedural() ? others : triangles) = true; });
    return triangles != others;
  }
  void divide(NodeRef ref) {
    const std::uint32_t primitives = primitives_of(accel_, ref);
    if (!ref.is_inner() || (primitives <= most_ && of_one_kind(ref))) {
      out_.clusters.push_back({ref, primitives});
      return;
    }
    out_.above.push_back(ref.node());
    const Node& node = accel_.nodes[ref.node()];
    for (int lane = 0; lane < node.count; ++lane) divide(node.child[lane]);
  }

  const Accel& accel_;
  std::uint32_t most_;
  MeshClusters out_;
};

/// The meshes before and after, of one of which clusters are brought from the one to the other.
class MeshUpdate {
 public:
  MeshUpdate(Accel& accel, MeshClusters& clusters, const scene::Mesh& before, const scene::Mesh& after,
             const scene::Opacity& opacity, ClusterWork& work)
      : accel_(accel), clusters_(clusters), before_(before), mesh_(after), opacity_(opacity), work_(work) {}

  void run(std::uint64_t most_dealt) {
    for (std::uint32_t c = 0; c < clusters_.clusters.size(); ++c) {
      std::vector<NodeRef> leaves;
      std::vector<std::uint32_t> primitives;
      collect(clusters_.clusters[c].root, leaves, primitives);
      if (std::none_of(primitives.begin(), primitives.end(), [&](std::uint32_t p) { return has_moved(p); })) continue;
      work_.moved.push_back(c);
      renew(clusters_.clusters[c].root, leaves, primitives);
    }
    if (work_.moved.empty() || clusters_.above.empty()) return;
    above_.insert(clusters_.above.begin(), clusters_.above.end());
    if (clusters_.clusters.size() <= most_dealt) {
      for (std::uint32_t c = 0; c < clusters_.clusters.size(); ++c)
        numbers_.emplace(clusters_.clusters[c].root.bits(), c);
      moved_.assign(clusters_.clusters.size(), false);
      for (const std::uint32_t c : work_.moved) moved_[c] = true;
      deal_where_many_moved(clusters_.root);
    }
    refit_above(clusters_.root);
  }

 private:
  void collect(NodeRef root, std::vector<NodeRef>& leaves, std::vector<std::uint32_t>& primitives) const {
    each_leaf(accel_, root, [&](NodeRef leaf) {
      leaves.push_back(leaf);
      for (std::uint32_t i = 0; i < leaf.triangles(); ++i)
        primitives.push_back(accel_.blocks[leaf.first_block() + i / kBlockTriangles].primitive[i % kBlockTriangles] &
                             kPrimitiveMask);
    });
  }

  bool has_moved(std::uint32_t primitive) const {
    if (primitive >= mesh_.triangle_count()) {
      const scene::Sphere &a = before_.spheres[primitive - mesh_.triangle_count()],
                          &b = mesh_.spheres[primitive - mesh_.triangle_count()];
      return a.center != b.center || a.radius != b.radius || a.half != b.half || a.material != b.material ||
             a.program != b.program;
    }
    const auto differs = [&](const auto& a, const auto& b, std::size_t vertex) {
      return a.size() != b.size() || (vertex < a.size() && a[vertex] != b[vertex]);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t vertex = mesh_.indices[3 * std::size_t{primitive} + k];
      if (differs(before_.positions, mesh_.positions, vertex) || differs(before_.colors, mesh_.colors, vertex) ||
          differs(before_.uv0, mesh_.uv0, vertex) || differs(before_.uv1, mesh_.uv1, vertex))
        return true;
    }
    return false;
  }

  /// Gives the leaves their primitives, in a better order if there is one, and then the nodes their boxes.
  void renew(NodeRef root, const std::vector<NodeRef>& leaves, std::vector<std::uint32_t>& primitives) {
    std::vector<DealtNode> tree;
    add_shape(root, tree);
    std::vector<DealtItem> items;
    for (const std::uint32_t p : primitives) items.push_back({primitive_box(mesh_, p), p});
    const double refitted = dealt_area(tree, items, kBlockTriangles);
    // For the arrangement as it is, and for the boxes of the new one.
    work_.boxes.push_back(deal(tree, items) + 2 * items.size());
    work_.is_better.push_back(dealt_area(tree, items, kBlockTriangles) < refitted);
    if (work_.is_better.back())
      std::transform(items.begin(), items.end(), primitives.begin(), [](const DealtItem& item) { return item.id; });
    const std::uint32_t* next = primitives.data();
    for (const NodeRef leaf : leaves) {
      fill_leaf(accel_, leaf, mesh_, opacity_, next);
      next += leaf.triangles();
    }
    refit_mesh(accel_, root, mesh_, opacity_);
  }

  std::uint32_t add_shape(NodeRef ref, std::vector<DealtNode>& tree) const {
    const auto at = static_cast<std::uint32_t>(tree.size());
    tree.push_back({{}, primitives_of(accel_, ref)});
    if (!ref.is_inner()) return at;
    const Node& node = accel_.nodes[ref.node()];
    for (int lane = 0; lane < node.count; ++lane) {
      const std::uint32_t child = add_shape(node.child[lane], tree);
      tree[at].children.push_back(child);
    }
    return at;
  }

  // ---- the nodes above the clusters

  bool is_above(NodeRef ref) const { return ref.is_inner() && above_.contains(ref.node()); }

  Aabb box_of_root(NodeRef cluster) const {
    if (cluster.is_inner()) return node_box(accel_.nodes[cluster.node()]);
    Aabb box;
    for (std::uint32_t i = 0; i < cluster.triangles(); ++i)
      box.extend(primitive_box(
          mesh_,
          accel_.blocks[cluster.first_block() + i / kBlockTriangles].primitive[i % kBlockTriangles] & kPrimitiveMask));
    return box;
  }

  /// Deals out what hangs below the highest nodes of which many clusters have moved.
  void deal_where_many_moved(NodeRef ref) {
    if (!is_above(ref)) return;
    std::vector<std::uint32_t> below;
    add_below(ref, below);
    const auto moved = static_cast<std::size_t>(
        std::count_if(below.begin(), below.end(), [&](std::uint32_t cluster) { return moved_[cluster]; }));
    if (moved == 0) return;
    constexpr std::size_t kOneIn = 4;
    if (kOneIn * moved >= below.size()) return deal_below(ref, std::move(below));
    const Node& node = accel_.nodes[ref.node()];
    for (int lane = 0; lane < node.count; ++lane) deal_where_many_moved(node.child[lane]);
  }

  /// The numbers of the clusters below, depth first.
  void add_below(NodeRef ref, std::vector<std::uint32_t>& below) const {
    if (!is_above(ref)) return below.push_back(numbers_.at(ref.bits()));
    const Node& node = accel_.nodes[ref.node()];
    for (int lane = 0; lane < node.count; ++lane) add_below(node.child[lane], below);
  }

  void deal_below(NodeRef root, std::vector<std::uint32_t> below) {
    std::vector<DealtNode> tree;
    std::vector<DealtItem> items;
    places_.clear();
    add_above(root, tree, items);
    DealtClusters& dealt = work_.dealt.emplace_back();
    dealt.root = root;
    dealt.clusters = std::move(below);
    const double refitted = dealt_area(tree, items, 1);
    dealt.boxes = deal(tree, items) + 2 * items.size();
    dealt.is_better = dealt_area(tree, items, 1) < refitted;
    std::vector<bool> stays;  // by place: it has the cluster that it had, which has not moved
    for (std::uint32_t i = 0; i < items.size(); ++i)
      stays.push_back((!dealt.is_better || items[i].id == i) && !moved_[dealt.clusters[i]]);
    if (dealt.is_better) {
      const std::vector<NodeRef> hung = std::exchange(places_, {});
      for (const DealtItem& item : items) places_.push_back(hung[item.id]);
    }
    next_place_ = 0;
    place_above(root, stays, dealt);
  }

  std::uint32_t add_above(NodeRef ref, std::vector<DealtNode>& tree, std::vector<DealtItem>& items) {
    const auto at = static_cast<std::uint32_t>(tree.size());
    tree.push_back({});
    if (!is_above(ref)) {
      tree[at].items = 1;
      items.push_back({box_of_root(ref), static_cast<std::uint32_t>(places_.size())});
      places_.push_back(ref);
      return at;
    }
    const Node& node = accel_.nodes[ref.node()];
    for (int lane = 0; lane < node.count; ++lane) {
      const std::uint32_t child = add_above(node.child[lane], tree, items);
      tree[at].children.push_back(child);
      tree[at].items += tree[child].items;
    }
    return at;
  }

  /// Hangs the clusters below the nodes above, in the order of places_. Returns whether all that is below stays.
  bool place_above(NodeRef ref, const std::vector<bool>& stays, DealtClusters& dealt) {
    Node& node = accel_.nodes[ref.node()];
    const std::size_t number = dealt.nodes.size();
    dealt.nodes.push_back(ref.node());
    dealt.hangs_anew.push_back(false);
    dealt.changes.push_back(false);
    bool all_stay = true;
    std::uint64_t primitives = 0;
    for (int lane = 0; lane < node.count; ++lane) {
      if (is_above(node.child[lane])) {
        all_stay &= place_above(node.child[lane], stays, dealt);
      } else {
        all_stay &= stays[next_place_];
        const NodeRef cluster = places_[next_place_++];
        if (node.child[lane] != cluster) dealt.hangs_anew[number] = true;
        node.child[lane] = cluster;
        node.strip_size[lane] =
            cluster.is_inner() ? accel_.nodes[cluster.node()].count : static_cast<std::uint8_t>(cluster.triangles());
      }
      primitives += primitives_of(accel_, node.child[lane]);
    }
    node.triangles = static_cast<std::uint32_t>(std::min<std::uint64_t>(primitives, ~std::uint32_t{0}));
    dealt.changes[number] = !all_stay;
    return all_stay;
  }

  Aabb refit_above(NodeRef root) {
    const auto refit = [&](const auto& self, NodeRef ref) -> Aabb {
      if (!is_above(ref)) return box_of_root(ref);
      Node& node = accel_.nodes[ref.node()];
      for (int lane = 0; lane < node.count; ++lane) set_child_box(node, lane, self(self, node.child[lane]));
      return node_box(node);
    };
    return refit(refit, root);
  }

  Accel& accel_;
  MeshClusters& clusters_;
  const scene::Mesh &before_, &mesh_;
  const scene::Opacity& opacity_;
  ClusterWork& work_;
  std::unordered_set<std::uint32_t> above_;                   // nodes
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;  // of clusters, by the bits of their roots
  std::vector<bool> moved_;                                   // by cluster
  std::vector<NodeRef> places_;                               // clusters, depth first
  std::size_t next_place_ = 0;
};

int deepest(const Accel& accel, const TreeClusters& clusters) {
  int depth = 0;
  for (const MeshClusters& mesh : clusters.meshes) depth = std::max(depth, depth_of(accel, mesh.root));
  return depth;
}

}  // namespace

std::uint64_t TreeClusters::count() const {
  std::uint64_t sum = 0;
  for (const MeshClusters& mesh : meshes) sum += mesh.clusters.size();
  return sum;
}

TreeClusters cut_clusters(const Accel& accel, const scene::Scene& scene, std::optional<std::uint32_t> most,
                          std::uint64_t most_dealt) {
  TreeClusters out;
  std::vector<bool> found(scene.meshes.size());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const std::uint32_t mesh = scene.instances[i].mesh.value;
    if (found[mesh] || accel.instances[i].triangles == 0) continue;
    found[mesh] = true;
    std::uint32_t primitives = most.value_or(1);
    MeshClusters cut = Cut(accel, primitives).run(mesh, accel.instances[i].root);
    while (!most && cut.clusters.size() > most_dealt && 2 * primitives <= most_dealt)
      cut = Cut(accel, primitives *= 2).run(mesh, accel.instances[i].root);
    out.meshes.push_back(std::move(cut));
  }
  return out;
}

std::string update_clusters(Accel& accel, TreeClusters& clusters, const scene::Scene& before, const scene::Scene& after,
                            const SceneChange& change, BvhConfig::Storage storage, std::uint64_t most_dealt,
                            Executor& executor, std::vector<ClusterWork>& work) {
  work.clear();
  std::vector<std::size_t> number_of(change.meshes.size());  // in `work`
  for (std::size_t m = 0; m < change.meshes.size(); ++m)
    for (std::uint32_t c = 0; c < clusters.meshes.size(); ++c)
      if (clusters.meshes[c].mesh == change.meshes[m]) {
        number_of[m] = work.size();
        work.emplace_back().mesh = c;
      }
  const int depth = deepest(accel, clusters);
  const auto update = [&](std::size_t m, NodeRef, const scene::Opacity& opacity) {
    ClusterWork& of_mesh = work[number_of[m]];
    MeshClusters& cut = clusters.meshes[of_mesh.mesh];
    MeshUpdate(accel, cut, before.meshes[cut.mesh], after.meshes[cut.mesh], opacity, of_mesh).run(most_dealt);
  };
  const std::string why = refit(accel, after, change, storage, executor, update);
  if (why.empty()) accel.max_depth += deepest(accel, clusters) - depth;
  return why;
}

}  // namespace carousel::accel
