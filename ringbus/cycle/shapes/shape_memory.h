#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/builders/quantised_boxes.h"
#include "accel/measure/structure_depths.h"
#include "accel/packed/packed_leaves.h"
#include "accel/structure/accel.h"
#include "accel/structure/shape_bytes.h"
#include "accel/transform/instance_data.h"
#include "core/config/fields/bvh.h"
#include "core/config/fields/memory.h"
#include "ringbus/cycle/shapes/gaussian_records.h"
#include "ringbus/cycle/shapes/leaf_strips.h"
#include "ringbus/cycle/shapes/shape_span.h"

namespace carousel::ringbus::cycle {

/// The layout of the acceleration structure in the simulated memory: nodes first, each with its children's cull planes
/// and the primitives it holds itself behind it, then leaves as they are laid out in the host's, then what is stored of
/// each instance, from a 64-byte border on, in equal room for all of them: its transform, colour and opacity of its
/// Gaussian if it stands for one (and behind them GaussianRecords), of groups and their members world boxes and a few
/// numbers besides (accel/structure/group_placement.h). With `bvh.storage: quantised` nodes have 64 or 80 bytes, or 128
/// with 12 bits a plane, but for those that keep their boxes as floats (accel/builders/quantised_boxes.h), and each
/// primitive of a leaf 64; with `bvh.leaves: strips` leaves hold LeafStrips, and with `blocks` they are
/// accel::PackedLeaves, from a 128-byte border on. A leaf has the micromaps of its triangles in it, each behind its
/// triangle, so that whoever reads the triangle reads them. With `bvh.treelets` nodes and leaves stand where their
/// pieces say (accel::TreePieces).
///
/// With `memory.strip_end: flag` (US 9633468: address of the first element, stride, and a flag at the end) a strip ends
/// behind the last child of a node, unless something stands behind its children's boxes, and behind the last primitive
/// of a leaf. The flag is a bit of a child's flags or of a primitive's number, so it takes no room. Quantised nodes are
/// decoded as a whole, and are read like a record of known length.
class ShapeMemory {
 public:
  ShapeMemory(const accel::Accel& accel, const AccuracyConfig& accuracy, const BvhConfig& bvh = {},
              const MemoryConfig& memory = {})
      : accel_(accel),
        quantised_(is_quantised(bvh.storage)),
        node_bytes_(accel::node_bytes(accel, bvh)),
        strips_(bvh.leaves == BvhConfig::Leaves::kStrips ? LeafStrips(accel) : LeafStrips()),
        blocks_at_(aligned(accel.nodes.size() * node_bytes_ + bytes_behind_nodes(), accel.packed ? 128 : 64)),
        instances_at_(accel.pieces ? accel.pieces->bytes : (blocks_at_ + bytes_of_leaves() + 63) / 64 * 64),
        look_bytes_(accel.gaussians ? accel.gaussians->bytes_in_instance() : 0),
        instance_bytes_(accel::instance_bytes(accuracy) + look_bytes_),
        promoted_bytes_(accel::promoted_bytes(accuracy) + look_bytes_),
        instance_room_(((accel.promoted_instances > 0 ? promoted_bytes_ : instance_bytes_) +
                        (accel.groups.empty() ? 0 : accel::kMemberBytes + accel::kGroupBytes) + 63) /
                       64 * 64),
        records_(record_order(accel)),
        gaussians_(accel, instances_at_ + accel.instances.size() * instance_room_) {
    if (!accel.partition) depths_.emplace(accel);
    if (memory.strip_end == MemoryConfig::StripEnd::kFlag) end_by_flag();
  }

  /// The strip below `key`: a node with its children's boxes and planes, or a leaf's triangles.
  ShapeSpan strip(accel::NodeKey key) const {
    ShapeSpan span = room(key);
    if (depths_) span.row = depths_->row(key.ref);
    if (most_leaf_ == 0) return span;
    if (!key.ref.is_inner()) {
      if (!strips_.holds(key.ref) && !quantised_)
        span.bytes = key.ref.triangles() * kPrimitiveBytes + accel_.micromaps.places.of(key.ref);
      span.most = most_leaf_;
    } else if (most_node_ > 0) {
      if (span.bytes == node_bytes_) span.bytes = accel_.nodes[key.ref.node()].count * (node_bytes_ / accel::kMaxWidth);
      span.most = most_node_;
    }
    return span;
  }

  /// The shapes of the strip below `key` that `lanes` selects: all of them, or with `packets.shapes: single` one. A
  /// child of a node is its eighth of the node (a box of 24 bytes or a sphere of 16, its reference, its flags), with
  /// its own cull planes and the primitives that the node holds for it. A primitive of a leaf is its 40 bytes of a
  /// block.
  ShapeSpan shapes(accel::NodeKey key, std::uint32_t lanes) const {
    if (std::popcount(lanes) != 1 || (accel_.packed && !key.ref.is_inner())) return strip(key);
    const ShapeSpan whole = room(key);
    const int lane = std::countr_zero(lanes);
    if (!key.ref.is_inner()) {
      const std::uint32_t block = key.ref.first_block(), at = static_cast<std::uint32_t>(lane);
      const auto maps = [&](std::uint32_t place) {
        return static_cast<std::uint32_t>(accel_.micromaps.places.before(block, place) -
                                          accel_.micromaps.places.before(block));
      };
      return {whole.address + std::uint64_t{at} * kPrimitiveBytes + maps(at),
              kPrimitiveBytes + maps(at + 1) - maps(at)};
    }
    std::uint32_t before = 0;
    for (int l = 0; l < lane; ++l) before += child_bytes(key.ref.node(), l);
    const std::uint32_t bytes = std::min(child_bytes(key.ref.node(), lane), whole.bytes);
    return {whole.address + std::min(before, whole.bytes - bytes), bytes};
  }

  /// True if rays may gather at treelets of the whole tree.
  bool has_treelets() const { return accel_.pieces != nullptr; }
  /// The treelet of a node or leaf; there are treelets.
  ShapeSpan treelet(accel::NodeRef ref) const {
    const accel::TreePieces::Piece& piece = accel_.pieces->piece(ref);
    return {piece.address, piece.bytes};
  }

  /// Bytes of the whole structure, with the gaps that alignment leaves.
  std::uint64_t size_bytes() const {
    return instances_at_ + accel_.instances.size() * instance_room_ + gaussians_.bytes();
  }

  /// How many boxes of the node `key` the lanes select; at least one.
  std::uint32_t boxes(accel::NodeKey key, std::uint32_t lanes) const {
    const auto count = static_cast<std::uint32_t>(accel_.nodes[key.ref.node()].count);
    return std::popcount(lanes) == 1 ? 1 : std::max(1u, count);
  }

  /// With `bvh.leaves: strips`.
  const LeafStrips& strips() const { return strips_; }
  /// Null where ranks share the structure.
  const accel::StructureDepths* depths() const { return depths_ ? &*depths_ : nullptr; }
  /// With `bvh.leaves: blocks`, else null.
  const accel::PackedLeaves* blocks() const { return accel_.packed.get(); }

  /// True if a test at `key` reads its instance's record although no ray is transformed there.
  bool reads_record(accel::NodeKey key) const {
    return accel_.enters_member(key) ||
           (accel_.is_group(key.instance) && accel_.instances[key.instance].transform.identity);
  }
  /// The data of its instance that testing in `instance` needs; no bytes above the instances, and where rays are not
  /// moved outside groups.
  ShapeSpan transform(std::uint32_t instance) const {
    if (instance == kNoInstance) return {};
    const accel::InstanceNode& node = accel_.instances[instance];
    std::uint32_t bytes = node.group || node.member ? accel::kMemberBytes : 0;
    if (node.group) bytes += accel::kGroupBytes;
    if (!node.transform.identity) bytes += node.transform.promoted ? promoted_bytes_ : instance_bytes_;
    if (bytes == 0) return {};
    const std::uint64_t record = records_.empty() ? instance : records_[instance];
    return {instances_at_ + record * instance_room_, bytes};
  }
  /// The records of the Gaussians around which the triangles of a leaf stand.
  std::span<const ShapeSpan> gaussians(accel::NodeKey key) const { return gaussians_.of(key.ref); }
  /// Those of the triangles that `lanes` selects, as for shapes().
  std::span<const ShapeSpan> gaussians(accel::NodeKey key, std::uint32_t lanes) const {
    if (std::popcount(lanes) != 1 || accel_.packed) return gaussians(key);
    return gaussians_.of(key.ref, static_cast<std::uint32_t>(std::countr_zero(lanes)));
  }

 private:
  /// All the bytes of a node or leaf.
  ShapeSpan room(accel::NodeKey key) const {
    if (accel_.pieces) return {accel_.pieces->address(key.ref), bytes_in_piece(key.ref)};
    if (key.ref.is_inner()) {
      const std::uint32_t node = key.ref.node();
      const std::uint64_t address = std::uint64_t{node} * node_bytes_;
      if (behind_before_.empty()) return {address, node_bytes_};
      const std::uint64_t behind = behind_before_[node + 1] - behind_before_[node];
      return {address + behind_before_[node], static_cast<std::uint32_t>(node_bytes_ + behind)};
    }
    if (accel_.packed) {
      const accel::PackedLeaves::Place& place = accel_.packed->place(key.ref);
      return {blocks_at_ + place.begin, place.bytes};
    }
    if (strips_.holds(key.ref)) return {blocks_at_ + strips_.begin(key.ref), strips_.bytes(key.ref)};
    const std::uint64_t begin = blocks_at_ + accel_.micromaps.places.before(key.ref.first_block());
    const std::uint32_t maps = accel_.micromaps.places.of(key.ref);
    if (quantised_)
      return {begin + std::uint64_t{primitives_before_[key.ref.first_block()]} * kQuantisedLeafBytes,
              key.ref.triangles() * kQuantisedLeafBytes + maps};
    return {begin + std::uint64_t{key.ref.first_block()} * sizeof(accel::TriangleBlock),
            key.ref.blocks() * static_cast<std::uint32_t>(sizeof(accel::TriangleBlock)) + maps};
  }
  static std::uint64_t aligned(std::uint64_t bytes, std::uint64_t to) { return (bytes + to - 1) / to * to; }
  std::uint32_t bytes_in_piece(accel::NodeRef ref) const {
    if (!ref.is_inner())
      return accel::leaf_bytes(ref, quantised_ ? BvhConfig::Storage::kQuantised : BvhConfig::Storage::kFull);
    if (behind_before_.empty()) return node_bytes_;
    return static_cast<std::uint32_t>(node_bytes_ + behind_before_[ref.node() + 1] - behind_before_[ref.node()]);
  }
  /// Finds the longest strips of nodes and of leaves.
  void end_by_flag() {
    std::uint32_t node = 0, leaf = 1;
    most_leaf_ = most_node_ = 1;  // so that strip() ends them
    const auto consider = [&](accel::NodeRef ref) {
      if (ref.is_instance()) return;
      std::uint32_t& most = ref.is_inner() ? node : leaf;
      most = std::max(most, strip({kNoInstance, ref}).bytes);
    };
    consider(accel_.root_key().ref);
    for (const accel::InstanceNode& instance : accel_.instances) consider(instance.root);
    for (std::uint32_t n = 0; n < accel_.nodes.size(); ++n) {
      consider(accel::NodeRef::inner(n));
      for (int lane = 0; lane < accel_.nodes[n].count; ++lane)
        if ((accel_.nodes[n].direct >> lane & 1) == 0) consider(accel_.nodes[n].child[lane]);
    }
    most_leaf_ = leaf;
    most_node_ = quantised_ ? 0 : node;
  }

  static constexpr std::uint32_t kPrimitiveBytes = sizeof(accel::TriangleBlock) / accel::kBlockTriangles;
  static constexpr std::uint32_t kQuantisedLeafBytes = accel::kQuantisedLeafBytes;

  /// Fills in primitives_before_ where each primitive has a leaf's bytes for itself; the bytes in all.
  std::uint64_t bytes_of_leaves() {
    if (accel_.packed) return accel_.packed->bytes();
    if (strips_.bytes() > 0) return strips_.bytes();
    const std::uint64_t maps = accel_.micromaps.places.all();
    if (!quantised_) return accel_.blocks.size() * sizeof(accel::TriangleBlock) + maps;
    std::uint32_t primitives = 0;
    primitives_before_.reserve(accel_.blocks.size());
    for (const accel::TriangleBlock& block : accel_.blocks) {
      primitives_before_.push_back(primitives);
      for (const std::uint32_t primitive : block.primitive) primitives += primitive != accel::kNoPrimitive;
    }
    return std::uint64_t{primitives} * kQuantisedLeafBytes + maps;
  }

  /// Members of one placement of a group stand one behind the other, so that the first tells where all are.
  static std::vector<std::uint32_t> record_order(const accel::Accel& accel) {
    std::vector<std::uint32_t> records;
    if (accel.groups.empty()) return records;
    records.resize(accel.instances.size());
    std::uint32_t next = 0;
    for (const std::uint32_t member : accel.members) records[member] = next++;
    for (std::size_t i = 0; i < records.size(); ++i)
      if (!accel.instances[i].member) records[i] = next++;
    return records;
  }

  std::uint32_t child_bytes(std::uint32_t index, int lane) const {
    const accel::Node& node = accel_.nodes[index];
    std::uint32_t bytes = node_bytes_ / accel::kMaxWidth;
    if (node.plane_counts != 0)
      bytes += static_cast<std::uint32_t>(accel::plane_count(node, lane)) * std::uint32_t{sizeof(accel::CullPlane)};
    if (node.direct >> lane & 1) {
      const accel::NodeRef leaf = accel_.held_leaf(node, lane);
      bytes +=
          leaf.blocks() * static_cast<std::uint32_t>(sizeof(accel::TriangleBlock)) + accel_.micromaps.places.of(leaf);
    }
    return bytes;
  }
  /// Fills in behind_before_; the bytes in all.
  std::uint64_t bytes_behind_nodes() {
    std::uint64_t bytes = 0;
    std::vector<bool> full(accel_.nodes.size());
    if (quantised_)
      for (const std::uint32_t n : accel::unquantised_nodes(accel_)) full[n] = true;
    behind_before_.reserve(accel_.nodes.size() + 1);
    for (std::size_t n = 0; n < accel_.nodes.size(); ++n) {
      const accel::Node& node = accel_.nodes[n];
      behind_before_.push_back(bytes);
      if (full[n]) bytes += sizeof(accel::Node) - node_bytes_;
      bytes += accel::bytes_behind(accel_, node);
    }
    behind_before_.push_back(bytes);
    if (bytes == 0) behind_before_.clear();
    return bytes;
  }

  const accel::Accel& accel_;
  bool quantised_;
  std::vector<std::uint32_t> primitives_before_;  // by block; of quantised structures
  std::vector<std::uint64_t> behind_before_;      // bytes, by node; empty when there are none
  std::uint32_t node_bytes_;
  LeafStrips strips_;
  std::uint64_t blocks_at_, instances_at_;
  std::uint32_t look_bytes_;  // of a Gaussian, in its instance
  std::uint32_t instance_bytes_, promoted_bytes_, instance_room_;
  std::uint32_t most_node_ = 0, most_leaf_ = 0;   // bytes of the longest strip that ends by its flag; 0: none does
  std::optional<accel::StructureDepths> depths_;  // of a structure that is here as a whole
  std::vector<std::uint32_t> records_;            // by instance: the place of its record; empty: its number
  GaussianRecords gaussians_;
};

}  // namespace carousel::ringbus::cycle
