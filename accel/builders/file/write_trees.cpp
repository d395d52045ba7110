#include "accel/builders/file/write_trees.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "accel/builders/file/tree_file.h"
#include "accel/structure/primitive_boxes.h"
#include "core/system/error.h"

namespace carousel::accel {

namespace {

class TreeWriter {
 public:
  TreeWriter(AtomicFile& file, const Accel& accel, const scene::Scene& scene)
      : file_(file), accel_(accel), nodes_(accel.full_nodes.empty() ? accel.nodes : accel.full_nodes), scene_(scene) {}

  void run() {
    put("carousel_trees 1\n");
    std::set<std::uint32_t> written;  // meshes
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const InstanceNode& node = accel_.instances[i];
      const std::uint32_t mesh = scene_.instances[i].mesh.value;
      if (node.triangles == 0 || (accel_.merged.holds(i) && i != accel_.merged.instance())) continue;
      using enum TreeSource::Kind;
      InstanceTransform transform;
      if (i == accel_.merged.instance())
        write({kMerged, 0}, node);
      else if (!make_transform(scene_.instances[i].world_from_model, transform, accel_.accuracy.transform))
        write({kInstance, i}, node);
      else if (written.insert(mesh).second)
        write({kMesh, mesh}, node);
    }
  }

 private:
  void write(const TreeSource& source, const InstanceNode& instance) {
    named_.clear();
    order_.clear();
    if (instance.root.is_inner()) collect(instance.root.node());
    put("\n{} {}\n", source.text(), instance.triangles);
    std::size_t primitives = 0;
    if (order_.empty()) {
      put("node 0\n");
      primitives = write_leaf(source, instance.root, leaf_box(instance.root));
    }
    for (std::size_t number = 0; number < order_.size(); ++number) {
      put("node {}\n", number);
      const Node& node = nodes_[order_[number]];
      for (int lane = 0; lane < node.count; ++lane) {
        const Aabb box{{node.plane[0][lane], node.plane[1][lane], node.plane[2][lane]},
                       {node.plane[3][lane], node.plane[4][lane], node.plane[5][lane]}};
        if (!node.child[lane].is_inner()) {
          primitives += write_leaf(source, node.child[lane], box);
          continue;
        }
        put("inner {}", number_of(node.child[lane].node()));
        put_box(box);
        put("\n");
      }
    }
    if (primitives != instance.triangles) refuse(source);
  }

  /// All nodes below `root` in the order of their numbers, in which parents come before their children.
  void collect(std::uint32_t root) {
    std::vector<std::uint32_t> open{root};
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      order_.push_back(at);
      for (int lane = 0; lane < nodes_[at].count; ++lane)
        if (nodes_[at].child[lane].is_inner()) open.push_back(nodes_[at].child[lane].node());
    }
    std::sort(order_.begin(), order_.end());
  }
  std::size_t number_of(std::uint32_t node) const {
    return static_cast<std::size_t>(std::lower_bound(order_.begin(), order_.end(), node) - order_.begin());
  }

  Aabb leaf_box(NodeRef leaf) const {
    Aabb box;
    for (std::uint32_t i = 0; i < leaf.triangles(); ++i) box.extend(primitive_box(accel_, leaf, i));
    return box;
  }

  std::size_t write_leaf(const TreeSource& source, NodeRef leaf, const Aabb& box) {
    put("leaf");
    put_box(box);
    for (std::uint32_t i = 0; i < leaf.triangles(); ++i) {
      const TriangleBlock& block = accel_.blocks[leaf.first_block() + i / kBlockTriangles];
      const std::uint32_t primitive = block.primitive[i % kBlockTriangles] & kPrimitiveMask;
      if (!named_.insert(primitive).second) refuse(source);
      put(" {}", primitive);
    }
    put("\n");
    return leaf.triangles();
  }
  void put_box(const Aabb& box) {
    for (const Vec3& corner : {box.lo, box.hi}) put(" {} {} {}", corner.x, corner.y, corner.z);
  }
  [[noreturn]] static void refuse(const TreeSource& source) {
    throw ConfigError(
        "--dump-trees",
        fmt::format("a file of trees has each primitive in one leaf, and {} has some in several; expected "
                    "bvh.builder: sah",
                    source.text()));
  }

  template <class... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    text_.clear();
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    file_.write(text_);
  }

  AtomicFile& file_;
  const Accel& accel_;
  const NodeArray& nodes_;
  const scene::Scene& scene_;
  std::vector<std::uint32_t> order_;  // nodes of the tree that is written
  std::set<std::uint32_t> named_;     // primitives that are in a leaf
  std::string text_;
};

}  // namespace

void write_trees(AtomicFile& file, const Accel& accel, const scene::Scene& scene) {
  TreeWriter(file, accel, scene).run();
}

}  // namespace carousel::accel
