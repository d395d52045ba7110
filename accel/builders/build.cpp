#include "accel/builders/build.h"

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>

#include "accel/builders/binary/sah_build.h"
#include "accel/builders/bounding_oriented_boxes.h"
#include "accel/builders/bounding_spheres.h"
#include "accel/builders/file/file_blas.h"
#include "accel/builders/group_levels.h"
#include "accel/builders/mesh/blas_meshes.h"
#include "accel/builders/placed_blas.h"
#include "accel/builders/quantised_boxes.h"
#include "accel/builders/rank_shares.h"
#include "accel/builders/top_children.h"
#include "accel/cut/tree_cut.h"
#include "accel/packed/packed_leaves.h"
#include "accel/planes/cull_planes.h"
#include "core/system/error.h"
#include "scene/model/opacity.h"

namespace carousel::accel {

namespace {

constexpr std::size_t kGuestNumbers = 1 << 24;  // for shapes of other ranks: some gigabytes of addresses

class AccelBuilder {
 public:
  AccelBuilder(const scene::Scene& scene, const BvhConfig& config, Executor& executor, const AccuracyConfig& accuracy,
               const CullPlanesConfig& planes, const BuildRanks* ranks, const TreeFile* trees)
      : scene_(scene), config_(config), executor_(executor), planes_(planes), ranks_(ranks), trees_(trees) {
    accel_.width = static_cast<int>(config.width);
    accel_.accuracy = accuracy;
    accel_.programs = scene.programs;
    accel_.gaussians = gaussian_shapes(scene.gaussians);
  }

  Accel run() {
    place_instances();
    build_blases();
    join_blases();
    join_pieces();
    const std::size_t above = accel_.nodes.size();
    fill_instances();
    const TopMembers top = top_members();
    first_of_top_ = accel_.nodes.size();
    build_tlas(top);
    for (std::size_t i = above; i < accel_.nodes.size(); ++i) accel_.nodes[i].above_instances = true;
    for (const PlacedBlas& placed : blases_) accel_.has_non_opaque |= placed.blas.has_non_opaque;
    for (const scene::Instance& instance : scene_.instances)
      accel_.procedural_primitives |= !scene_.meshes[instance.mesh.value].spheres.empty();
    mix_nodes();
    if (config_.elements == BvhConfig::Elements::kSpheres)
      accel_.elements.spheres = bounding_spheres(accel_, executor_);
    if (config_.elements == BvhConfig::Elements::kOrientedBoxes)
      accel_.elements.oriented_boxes = bounding_oriented_boxes(accel_, executor_);
    add_cull_planes(accel_, scene_, planes_, executor_);
    if (ranks_ != nullptr) {
      partition_.above_end = static_cast<std::uint32_t>(accel_.nodes.size());
      accel_.partition = std::make_shared<Partition>(partition_);
      accel_.guests = std::make_shared<GuestShapes>(accel_.nodes, accel_.blocks);
    }
    return std::move(accel_);
  }

 private:
  // Which BLAS each instance uses: its mesh's, the merged one, or one of its own when it must be baked.
  void place_instances() {
    if (config_.merge == BvhConfig::Merge::kWorld) accel_.merged = merge_meshes(scene_, sources_);
    names_.assign(sources_.size(), {TreeSource::Kind::kMerged, 0});
    accel_.instances.resize(scene_.instances.size());
    blas_of_.resize(scene_.instances.size());
    std::vector<std::optional<std::uint32_t>> blas_of_mesh(scene_.meshes.size());
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const scene::Instance& instance = scene_.instances[i];
      const scene::Mesh& mesh = scene_.meshes[instance.mesh.value];
      if (accel_.merged.holds(static_cast<std::uint32_t>(i))) continue;
      if (make_transform(instance.world_from_model, accel_.instances[i].transform, accel_.accuracy.transform)) {
        auto& shared = blas_of_mesh[instance.mesh.value];
        if (!shared) {
          shared = static_cast<std::uint32_t>(sources_.size());
          sources_.emplace_back(mesh);
          names_.push_back({TreeSource::Kind::kMesh, instance.mesh.value});
        }
        blas_of_[i] = *shared;
        accel_.promoted_instances += accel_.instances[i].transform.promoted;
      } else {
        if (!mesh.spheres.empty())
          throw SceneError(
              scene_.name, "",
              "instance " + std::to_string(i) + " flattens a procedural primitive: its transform has no inverse");
        accel_.instances[i].transform = InstanceTransform{};
        baked_.emplace(i, bake(mesh, instance.world_from_model));
        blas_of_[i] = static_cast<std::uint32_t>(sources_.size());
        sources_.emplace_back(baked_.at(i));
        names_.push_back({TreeSource::Kind::kInstance, static_cast<std::uint32_t>(i)});
        ++accel_.baked_instances;
      }
    }
  }

  void build_blases() {
    const scene::Opacity opacity(scene_);
    divide_meshes();
    executor_.parallel_for(blases_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        PlacedBlas& placed = blases_[i];
        if (here(i)) {
          placed.blas = blas(placed, opacity);
          placed.nodes = static_cast<std::uint32_t>(placed.blas.nodes.size());
          placed.blocks = static_cast<std::uint32_t>(placed.blas.blocks.size());
        }
        placed.piece = {};
      }
    });
    if (ranks_ != nullptr) exchange_summaries(*ranks_, home_, blases_);
  }

  Blas blas(const PlacedBlas& placed, const scene::Opacity& opacity) const {
    const BlasMeshes& source = sources_[placed.source];
    if (trees_ != nullptr && source.size() > 0)
      return blas_of_file(trees_->of(names_[placed.source]), trees_->name, source, opacity, config_, executor_);
    return build_blas(source, opacity, config_, executor_, placed.piece.empty() ? nullptr : &placed.piece);
  }

  bool here(std::size_t i) const { return ranks_ == nullptr || home_[i] == ranks_->rank; }

  // One BLAS a mesh. For ranks meshes are divided so far that the shares can be about equal.
  void divide_meshes() {
    if (ranks_ != nullptr) return share_out(sources_, *ranks_, blases_, home_);
    blases_.resize(sources_.size());
    for (std::uint32_t i = 0; i < sources_.size(); ++i) blases_[i].source = i;
  }

  // The shapes of a rank have consecutive numbers (Partition).
  void join_blases() {
    std::vector<std::uint32_t> order(blases_.size());
    std::iota(order.begin(), order.end(), 0u);
    if (ranks_ != nullptr)
      std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return home_[a] < home_[b]; });
    std::vector<std::uint64_t> node_sums(ranks_ == nullptr ? 0 : ranks_->ranks), block_sums(node_sums.size());
    std::size_t nodes = 0, blocks = 0;
    for (const std::uint32_t i : order) {
      PlacedBlas& placed = blases_[i];
      placed.first_node = static_cast<std::uint32_t>(nodes);
      placed.first_block = static_cast<std::uint32_t>(blocks);
      nodes += placed.nodes;
      blocks += placed.blocks;
      if (nodes + 2 * scene_.instances.size() >= kMaxNodes || blocks >= kMaxBlocks)
        throw SceneError(scene_.name, "", "has more triangles than the acceleration structure can name");
      if (ranks_ == nullptr) continue;
      node_sums[home_[i]] += placed.nodes;
      block_sums[home_[i]] += placed.blocks;
    }
    if (ranks_ != nullptr) {
      partition_ = partition_of(ranks_->rank, node_sums, block_sums);
      accel_.nodes.allow_gaps(std::min<std::size_t>(kMaxNodes, nodes + 2 * scene_.instances.size() + kGuestNumbers));
      accel_.blocks.allow_gaps(std::min<std::size_t>(kMaxBlocks, blocks + kGuestNumbers));
    } else if (blases_.size() == 1) {
      accel_.nodes = std::move(blases_[0].blas.nodes);
      accel_.blocks = std::move(blases_[0].blas.blocks);
      return;
    }
    accel_.nodes.reserve(nodes);
    accel_.blocks.reserve(blocks);
    for (const std::uint32_t i : order) {
      PlacedBlas& placed = blases_[i];
      if (!here(i)) {
        accel_.nodes.skip(placed.nodes);
        accel_.blocks.skip(placed.blocks);
        continue;
      }
      for (Node& node : placed.blas.nodes) {
        for (int lane = 0; lane < node.count; ++lane) node.child[lane] = placed.place(node.child[lane]);
        accel_.nodes.push_back(node);
      }
      for (const TriangleBlock& block : placed.blas.blocks) accel_.blocks.push_back(block);
      placed.blas.nodes = {};
      placed.blas.blocks = {};
    }
  }

  // The nodes above the pieces of a mesh are at every rank, as those of the top level are.
  void join_pieces() {
    meshes_.resize(sources_.size());
    for (std::size_t first = 0, end; first < blases_.size(); first = end) {
      PlacedMesh& mesh = meshes_[blases_[first].source];
      end = first + 1;
      while (end < blases_.size() && blases_[end].source == blases_[first].source) ++end;
      mesh = {blases_[first].blas.tree, blases_[first].blas.box};
      if (mesh.tree.triangles > 0) mesh.tree.root = blases_[first].place(mesh.tree.root);
      if (end - first > 1)
        mesh = join_at_top({blases_.data() + first, end - first}, accel_.width, executor_, accel_.nodes);
    }
  }

  bool is_baked(std::size_t i) const { return baked_.contains(i); }

  void fill_instances() {
    for (std::uint32_t i = 0; i < accel_.instances.size(); ++i) {
      const PlacedMesh& placed = meshes_[blas_of_[i]];
      if (placed.tree.triangles == 0 || (accel_.merged.holds(i) && i != accel_.merged.instance())) continue;
      InstanceNode& node = accel_.instances[i];
      node.root = placed.tree.root;
      node.strip_size = placed.tree.root_strip_size;
      node.triangles = placed.tree.triangles;
      node.world = is_baked(i) ? placed.box
                               : world_box(scene_.instances[i].world_from_model, placed.box, accel_.accuracy.transform);
      blas_depth_ = std::max(blas_depth_, placed.tree.depth);
    }
  }

  // Builds the levels between the top one and the meshes.
  TopMembers top_members() {
    if (config_.levels > 2 && !scene_.placements.empty()) {
      const auto box_of = [&](std::uint32_t i) {
        return is_baked(i) ? PlacedBox{accel_.instances[i].world, {}}
                           : PlacedBox{meshes_[blas_of_[i]].box, scene_.instances[i].world_from_model};
      };
      return build_group_levels(scene_, config_, box_of, executor_, accel_);
    }
    TopMembers top;
    for (std::uint32_t i = 0; i < accel_.instances.size(); ++i)
      if (accel_.instances[i].triangles > 0) top.instances.push_back(i);
    return top;
  }

  std::vector<TopChild> top_children(const TopMembers& top) const {
    std::vector<TopChild> out;
    const InstanceNode* merged = nullptr;
    for (const std::uint32_t i : top.instances) {
      const InstanceNode& node = accel_.instances[i];
      if (i == accel_.merged.instance())
        merged = &node;
      else if (!accel_.merged.holds(i))
        out.push_back({NodeRef::instance(i), node.world, node.strip_size, node.triangles});
    }
    if (merged != nullptr) hang_opened(*merged, accel_.nodes, out);
    return out;
  }

  void build_tlas(const TopMembers& top) {
    const std::vector<TopChild> children = top_children(top);
    BuildPrimitives primitives;
    for (const TopChild& child : children) {
      BuildPrimitive p;
      p.lo = child.box.lo;
      p.hi = child.box.hi;
      p.index = static_cast<std::uint32_t>(primitives.size());
      primitives.push_back(p);
    }
    int tlas_depth = 1;
    if (primitives.size() <= 1) {
      accel_.root = {kNoInstance, NodeRef::inner(static_cast<std::uint32_t>(accel_.nodes.size()))};
      accel_.nodes.emplace_back();
      if (!children.empty()) add_only_child(accel_.nodes.back(), children[0]);
    } else {
      const BinaryTree binary = build_sah(primitives, {.leaf_primitives = 1, .block_primitives = 1}, executor_);
      const auto make_leaf = [&](const BinaryNode& leaf, std::uint32_t) {
        const TopChild& child = children[primitives[leaf.first].index];
        return WideLeaf{child.ref, child.strip_size, child.triangles};
      };
      const WideTree tree = collapse(binary, accel_.width, make_leaf, executor_, accel_.nodes);
      accel_.root = {kNoInstance, tree.root};
      tlas_depth = tree.depth;
    }
    accel_.max_depth = tlas_depth + top.groups_depth + blas_depth_;
  }

  // Small leaves are tested where their boxes would be, also those that are whole meshes of the world: so a node of the
  // top level may hold primitives and instances (US 12394134, paragraph 8: leaf nodes that reference primitives in
  // world space, and leaf nodes that reference instances).
  void mix_nodes() {
    for (const auto& part : accel_.nodes.parts())
      for (std::size_t i = part.begin; i < part.end; ++i) {
        Node& node = accel_.nodes[i];
        for (int lane = 0; lane < node.count; ++lane)
          if (holds(node.child[lane], i >= first_of_top_)) node.direct |= static_cast<std::uint8_t>(1u << lane);
      }
  }
  bool holds(NodeRef child, bool in_top) const {
    if (ranks_ != nullptr && !partition_.here(child)) return false;  // nodes above a mesh's pieces
    if (!child.is_instance()) return !child.is_inner() && child.triangles() <= config_.mixed_triangles;
    // A group's member has a frame of its own; and merged meshes have that of the world, which no instance may take.
    if (!in_top || accel_.merged.count() > 0) return false;
    const InstanceNode& instance = accel_.instances[child.instance_index()];
    return instance.transform.identity && !instance.root.is_inner() &&
           instance.root.triangles() <= config_.top_triangles;
  }

  void add_only_child(Node& root, const TopChild& child) {
    // Without a transform the world box is the union of the boxes below it: passing one of those implies it, no
    // earlier entered, so it decides nothing and rays may start below it. So does a group's, whatever its transform.
    if (!child.ref.is_instance()) {
      accel_.root = {kNoInstance, child.ref};
    } else {
      const InstanceNode& node = accel_.instances[child.ref.instance_index()];
      if (node.transform.identity || node.group) accel_.root = {child.ref.instance_index(), node.root};
    }
    root.count = 1;
    root.triangles = child.triangles;
    root.child[0] = child.ref;
    root.strip_size[0] = child.strip_size;
    for (int axis = 0; axis < 3; ++axis) {
      root.plane[axis][0] = child.box.lo[axis];
      root.plane[axis + 3][0] = child.box.hi[axis];
    }
  }

  const scene::Scene& scene_;
  const BvhConfig& config_;
  Executor& executor_;
  const CullPlanesConfig& planes_;
  const BuildRanks* ranks_;  // null: the whole structure is built here
  const TreeFile* trees_;    // null: the structures over meshes are built here
  Accel accel_;
  std::vector<BlasMeshes> sources_;           // the merged meshes, one a mesh, and those that are baked
  std::vector<TreeSource> names_;             // as sources_
  std::map<std::size_t, scene::Mesh> baked_;  // by instance
  std::vector<std::uint32_t> blas_of_;        // one an instance, in sources_
  std::vector<std::uint32_t> home_;           // with ranks_: the rank of each BLAS
  Partition partition_;                       // with ranks_
  int blas_depth_ = 0;
  std::size_t first_of_top_ = 0;    // node
  std::vector<PlacedBlas> blases_;  // in order of sources_
  std::vector<PlacedMesh> meshes_;  // as sources_
};

}  // namespace

Accel build(const scene::Scene& scene, const BvhConfig& config, Executor& executor, const AccuracyConfig& accuracy,
            const CullPlanesConfig& planes, const BuildRanks* ranks, const TreeFile* trees) {
  Accel accel = AccelBuilder(scene, config, executor, accuracy, planes, ranks, trees).run();
  std::vector<std::uint32_t> as_floats;
  if (is_quantised(config.storage)) {
    quantise_boxes(accel, plane_bits(config.storage));
    if (config.treelets.bytes > 0) as_floats = unquantised_nodes(accel);
  }
  if (config.treelets.bytes > 0) accel.pieces = std::make_shared<const TreePieces>(cut_tree(accel, config, as_floats));
  if (config.leaves == BvhConfig::Leaves::kBlocks) accel.packed = std::make_shared<const PackedLeaves>(accel);
  return accel;
}

}  // namespace carousel::accel
