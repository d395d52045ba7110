#include "ringbus/cycle/builder/builder_work.h"

#include <algorithm>
#include <bit>
#include <unordered_map>
#include <unordered_set>

#include "ringbus/cycle/builder/builder_sources.h"

namespace carousel::ringbus::cycle {

namespace {

using accel::NodeRef;

constexpr std::uint64_t kChunk = 64;   // primitives of a task that streams
constexpr std::uint64_t kCorners = 8;  // of an instance's box, which are brought into the world

class Planner {
 public:
  Planner(const accel::Accel& accel, const ShapeMemory& memory, std::uint64_t local = 0)
      : accel_(accel), memory_(memory), sources_(accel, memory), local_(local) {}
  Planner(const accel::Accel& accel, const ShapeMemory& memory, const accel::TreeClusters& clusters,
          std::uint64_t local)
      : accel_(accel), memory_(memory), sources_(accel, memory, clusters), local_(local) {}

  BuilderWork refit(const accel::ChangedParts& parts) {
    std::unordered_map<std::uint32_t, std::size_t> heights;  // by the bits of a mesh's root
    for (const NodeRef root : parts.meshes) heights[root.bits()] = refit_mesh(root, sources_.first(root));
    move_instances(parts, 0);
    if (parts.top) refit_top(heights);
    return std::move(work_);
  }

  BuilderWork rebuild(const accel::ChangedParts& parts) {
    std::size_t end = 0;
    for (const NodeRef root : parts.meshes) end = std::max(end, rebuild_mesh(root));
    move_instances(parts, end);
    if (parts.top) rebuild_top(end);
    return std::move(work_);
  }

  BuilderWork update(const accel::ChangedParts& parts, const accel::TreeClusters& clusters,
                     std::span<const accel::ClusterWork> done) {
    std::unordered_map<std::uint32_t, std::size_t> heights;
    for (const accel::ClusterWork& of_mesh : done) {
      const accel::MeshClusters& mesh = clusters.meshes[of_mesh.mesh];
      heights[mesh.root.bits()] = update_mesh(mesh, of_mesh);
    }
    move_instances(parts, 0);
    if (parts.top) refit_top(heights);
    return std::move(work_);
  }

 private:
  ShapeSpan span(NodeRef ref) const { return memory_.strip({kNoInstance, ref}); }

  template <class Visit>
  void each_primitive(NodeRef leaf, const Visit& visit) const {
    for (std::uint32_t i = 0; i < leaf.triangles(); ++i)
      visit(accel_.blocks[leaf.first_block() + i / accel::kBlockTriangles].primitive[i % accel::kBlockTriangles] &
            accel::kPrimitiveMask);
  }

  /// The positions of a primitive, which have moved.
  void read_positions(std::uint64_t primitive, BuilderTask& task) {
    task.reads.push_back(sources_.positions(primitive));
    work_.moved.push_back(task.reads.back());
  }

  /// The stored transforms; a level that has no other work of these instances.
  void move_instances(const accel::ChangedParts& parts, std::size_t level) {
    for (const std::uint32_t i : parts.instances) {
      work_.moved.push_back(sources_.matrix(i));
      if (const ShapeSpan record = memory_.transform(i); record.bytes > 0)
        work_.level(level).push_back({{sources_.matrix(i)}, {record}, 0, true});
    }
  }

  /// Returns the level at which the root is written.
  std::size_t refit_mesh(NodeRef ref, std::uint64_t first) {
    BuilderTask task{{span(ref)}, {span(ref)}, 0, false};
    if (!ref.is_inner()) {
      each_primitive(ref, [&](std::uint32_t primitive) { read_positions(first + primitive, task); });
      task.boxes = ref.triangles();
      work_.level(0).push_back(std::move(task));
      return 0;
    }
    const accel::Node& node = accel_.nodes[ref.node()];
    std::size_t level = 0;
    for (int lane = 0; lane < node.count; ++lane) {
      level = std::max(level, refit_mesh(node.child[lane], first) + 1);
      task.reads.push_back(span(node.child[lane]));
    }
    task.boxes = node.count;
    work_.level(level).push_back(std::move(task));
    return level;
  }

  /// Returns the level at which the root is written.
  std::size_t update_mesh(const accel::MeshClusters& mesh, const accel::ClusterWork& done) {
    const ShapeSpan bits = sources_.cluster_bits(done.mesh, mesh.clusters.size());
    work_.moved.push_back(bits);
    work_.level(0).push_back({{bits}, {}, 0, false});
    const std::uint64_t first = sources_.first(mesh.root);
    std::unordered_map<std::uint32_t, std::uint32_t> moved;  // clusters by the bits of their roots
    std::uint64_t room = 0;                                  // primitives that the task may still take
    for (std::size_t i = 0; i < done.moved.size(); ++i) {
      const std::uint32_t number = done.moved[i];
      const accel::Cluster& cluster = mesh.clusters[number];
      if (cluster.primitives > room) {
        work_.level(1).emplace_back();
        room = std::max<std::uint64_t>(local_, cluster.primitives);
      }
      room -= cluster.primitives;
      BuilderTask& task = work_.level(1).back();
      task.boxes += done.boxes[i];
      task.writes.push_back(sources_.cluster_records(done.mesh, number, 1));
      task.reads.push_back(sources_.numbers(done.mesh, number, cluster.primitives));
      if (done.is_better[i]) task.writes.push_back(task.reads.back());
      update_cluster(cluster.root, first, task);
      moved.emplace(cluster.root.bits(), number);
    }
    if (moved.empty() || mesh.above.empty()) return 1;
    std::unordered_map<std::uint32_t, std::size_t> dealt;  // by the bits of the root
    for (std::size_t i = 0; i < done.dealt.size(); ++i) dealt.emplace(done.dealt[i].root.bits(), i);
    std::unordered_set<std::uint32_t> in_store;
    for (const std::uint32_t cluster : done.moved) in_store.insert(cluster);
    for (const accel::DealtClusters& of : done.dealt) deal_clusters(mesh, done.mesh, of, in_store);
    return refit_above(mesh, done.mesh, moved, dealt);
  }

  /// What hangs below a node is dealt out by the records of its clusters, of which those that have moved are still in
  /// the store, and the lists of children. Nodes are written below which something else hangs, or something has moved,
  /// and lists that are new.
  void deal_clusters(const accel::MeshClusters& mesh, std::size_t number, const accel::DealtClusters& dealt,
                     const std::unordered_set<std::uint32_t>& in_store) {
    BuilderTask task{{}, {}, dealt.boxes, false};
    for (const std::uint32_t cluster : dealt.clusters)
      if (!in_store.contains(cluster)) task.reads.push_back(sources_.cluster_records(number, cluster, 1));
    const auto first =
        static_cast<std::size_t>(std::ranges::find(mesh.above, dealt.nodes.front()) - mesh.above.begin());
    for (std::size_t i = 0; i < dealt.nodes.size(); ++i) {
      const ShapeSpan list =
          sources_.children(number, first + i, static_cast<std::uint32_t>(accel_.nodes[dealt.nodes[i]].count));
      task.reads.push_back(list);
      if (dealt.hangs_anew[i]) task.writes.push_back(list);
      if (dealt.changes[i]) task.writes.push_back(span(NodeRef::inner(dealt.nodes[i])));
    }
    work_.level(2).push_back(std::move(task));
  }

  void update_cluster(NodeRef ref, std::uint64_t first, BuilderTask& task) {
    task.writes.push_back(span(ref));
    if (!ref.is_inner())
      return each_primitive(ref, [&](std::uint32_t primitive) { read_positions(first + primitive, task); });
    task.reads.push_back(span(ref));
    const accel::Node& node = accel_.nodes[ref.node()];
    for (int lane = 0; lane < node.count; ++lane) update_cluster(node.child[lane], first, task);
  }

  /// The nodes above clusters that moved, from these or from those that were dealt out up. A node has the boxes of its
  /// children, and those that have moved are read again. Returns the level at which the root is written.
  std::size_t refit_above(const accel::MeshClusters& mesh, std::size_t number,
                          const std::unordered_map<std::uint32_t, std::uint32_t>& moved,
                          const std::unordered_map<std::uint32_t, std::size_t>& dealt) {
    std::unordered_map<std::uint32_t, std::uint32_t> numbers;  // of all clusters
    for (std::uint32_t c = 0; c < mesh.clusters.size(); ++c) numbers.emplace(mesh.clusters[c].root.bits(), c);
    const auto refit = [&](const auto& self, NodeRef ref) -> std::size_t {  // the level; 0: nothing below has moved
      if (numbers.contains(ref.bits())) return moved.contains(ref.bits()) ? 1 : 0;
      if (dealt.contains(ref.bits())) return 2;
      const accel::Node& node = accel_.nodes[ref.node()];
      BuilderTask task{{span(ref)}, {span(ref)}, 0, false};
      std::size_t level = 0;
      for (int lane = 0; lane < node.count; ++lane) {
        const std::size_t below = self(self, node.child[lane]);
        if (below == 0) continue;
        const auto cluster = numbers.find(node.child[lane].bits());
        task.reads.push_back(cluster == numbers.end() ? span(node.child[lane])
                                                      : sources_.cluster_records(number, cluster->second, 1));
        ++task.boxes;
        level = std::max(level, below);
      }
      if (level == 0) return 0;
      work_.level(level + 1).push_back(std::move(task));
      return level + 1;
    };
    return refit(refit, mesh.root);
  }

  void refit_top(const std::unordered_map<std::uint32_t, std::size_t>& meshes) {
    std::unordered_map<std::uint32_t, std::size_t> level_of;  // by node
    for (std::uint32_t i = static_cast<std::uint32_t>(accel_.nodes.size()); i-- > 0;) {
      const accel::Node& node = accel_.nodes[i];
      if (!node.above_instances) continue;
      BuilderTask task{{span(NodeRef::inner(i))}, {span(NodeRef::inner(i))}, node.count, true};
      std::size_t level = 0;
      for (int lane = 0; lane < node.count; ++lane) {
        const NodeRef child = node.child[lane];
        if (child.is_instance()) {
          const NodeRef root = accel_.instances[child.instance_index()].root;
          task.reads.insert(task.reads.end(), {sources_.matrix(child.instance_index()), span(root)});
          task.boxes += kCorners;
          if (const auto mesh = meshes.find(root.bits()); mesh != meshes.end())
            level = std::max(level, mesh->second + 1);
        } else {
          task.reads.push_back(span(child));
          level = std::max(level, level_of.at(child.node()) + 1);
        }
      }
      level_of[i] = level;
      work_.level(level).push_back(std::move(task));
    }
  }

  /// Returns the first level behind it.
  std::size_t rebuild_mesh(NodeRef root) {
    first_ = sources_.first(root);
    top_ = false;
    const std::uint64_t count = below(root);
    for (std::uint64_t i = 0; i < count; i += kChunk) {
      const std::uint64_t some = std::min(kChunk, count - i);
      work_.level(0).push_back({{sources_.positions(first_ + i, some)}, {records(i, some)}, some, false});
    }
    return divide(root, 0, 1);
  }

  void rebuild_top(std::size_t level) {
    first_ = 0;
    top_ = true;
    std::uint64_t record = 0;
    for (const accel::Node& node : accel_.nodes)
      for (int lane = 0; node.above_instances && lane < node.count; ++lane) {
        if (!node.child[lane].is_instance()) continue;
        const std::uint32_t instance = node.child[lane].instance_index();
        work_.level(level).push_back({{sources_.matrix(instance), span(accel_.instances[instance].root)},
                                      {records(record++, 1)},
                                      kCorners,
                                      true});
      }
    for (std::uint32_t i = 0; i < accel_.nodes.size(); ++i) {
      if (!accel_.nodes[i].above_instances) continue;
      divide(NodeRef::inner(i), 0, level + 1);  // the first one is the root of the level
      break;
    }
  }

  std::uint64_t below(NodeRef ref) const {
    if (ref.is_instance()) return 1;
    if (!ref.is_inner()) return ref.triangles();
    const accel::Node& node = accel_.nodes[ref.node()];
    if (!top_) return node.triangles;
    std::uint64_t sum = 0;
    for (int lane = 0; lane < node.count; ++lane) sum += below(node.child[lane]);
    return sum;
  }
  ShapeSpan records(std::uint64_t first, std::uint64_t count) const {
    return sources_.records(first_ + first, count, top_);
  }

  /// The subtree whose records begin with number `begin` of its structure. Returns the first level behind it.
  std::size_t divide(NodeRef ref, std::uint64_t begin, std::size_t level) {
    if (ref.is_instance()) return level;
    const std::uint64_t count = below(ref);
    if (!ref.is_inner() || count <= local_) {
      BuilderTask task{{records(begin, count)}, {}, count * std::bit_width(count), top_};
      add_subtree(ref, task);
      work_.level(level).push_back(std::move(task));
      return level + 1;
    }
    const accel::Node& node = accel_.nodes[ref.node()];
    for (int halvings = std::bit_width(static_cast<unsigned>(node.count) - 1); halvings > 0; --halvings, level += 2)
      for (std::uint64_t i = 0; i < count; i += kChunk) {
        const std::uint64_t some = std::min(kChunk, count - i);
        work_.level(level).push_back({{records(begin + i, some)}, {}, some, top_});
        work_.level(level + 1).push_back({{records(begin + i, some)}, {records(begin + i, some)}, some, top_});
      }
    work_.level(level).push_back({{}, {span(ref)}, node.count, top_});
    std::size_t end = level + 1;
    for (int lane = 0; lane < node.count; ++lane) {
      end = std::max(end, divide(node.child[lane], begin, level));
      begin += below(node.child[lane]);
    }
    return end;
  }

  void add_subtree(NodeRef ref, BuilderTask& task) const {
    if (ref.is_instance()) return;
    task.writes.push_back(span(ref));
    if (!ref.is_inner()) {
      if (const ShapeSpan maps = sources_.micromaps(accel_, ref); maps.bytes > 0) task.reads.push_back(maps);
      return each_primitive(ref, [&](std::uint32_t p) { task.reads.push_back(sources_.positions(first_ + p)); });
    }
    const accel::Node& node = accel_.nodes[ref.node()];
    for (int lane = 0; lane < node.count; ++lane) add_subtree(node.child[lane], task);
  }

  const accel::Accel& accel_;
  const ShapeMemory& memory_;
  BuilderSources sources_;
  std::uint64_t local_;
  BuilderWork work_;
  std::uint64_t first_ = 0;  // primitive of the mesh that is rebuilt
  bool top_ = false;         // the top level is
};

}  // namespace

accel::ChangedParts all_parts(const accel::Accel& accel) {
  accel::ChangedParts out;
  std::unordered_map<std::uint32_t, bool> found;
  for (std::uint32_t i = 0; i < accel.instances.size(); ++i) {
    const accel::InstanceNode& instance = accel.instances[i];
    if (instance.triangles == 0) continue;
    out.instances.push_back(i);
    if (found.emplace(instance.root.bits(), true).second) out.meshes.push_back(instance.root);
  }
  out.top = !out.instances.empty();
  return out;
}

BuilderWork refit_work(const accel::Accel& accel, const ShapeMemory& memory, const accel::ChangedParts& parts) {
  return Planner(accel, memory).refit(parts);
}

BuilderWork rebuild_work(const accel::Accel& accel, const ShapeMemory& memory, const accel::ChangedParts& parts,
                         std::uint64_t local_primitives) {
  return Planner(accel, memory, local_primitives).rebuild(parts);
}

BuilderWork cluster_work(const accel::Accel& accel, const ShapeMemory& memory, const accel::ChangedParts& parts,
                         const accel::TreeClusters& clusters, std::span<const accel::ClusterWork> done,
                         std::uint64_t local_primitives) {
  return Planner(accel, memory, clusters, local_primitives).update(parts, clusters, done);
}

std::uint64_t cluster_bytes(const accel::Accel& accel, const accel::TreeClusters& clusters) {
  std::uint64_t bytes = (clusters.count() + 7) / 8 + clusters.count() * BuilderSources::kRecordBytes;
  for (const accel::MeshClusters& mesh : clusters.meshes) {
    for (const accel::Cluster& cluster : mesh.clusters)
      bytes += std::uint64_t{cluster.primitives} * BuilderSources::kNumberBytes;
    for (const std::uint32_t node : mesh.above)
      bytes += static_cast<std::uint64_t>(accel.nodes[node].count) * BuilderSources::kNumberBytes;
  }
  return bytes;
}

}  // namespace carousel::ringbus::cycle
