#include "accel/packed/packed_leaves.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace carousel::accel {

namespace {

constexpr std::uint32_t kPrimitiveBytes = sizeof(TriangleBlock) / kBlockTriangles;

}  // namespace

std::vector<PackedTriangle> triangles_of(const Accel& accel, NodeRef leaf) {
  std::vector<PackedTriangle> out(leaf.triangles());
  for (std::uint32_t i = 0; i < leaf.triangles(); ++i) {
    const TriangleBlock& block = accel.blocks[leaf.first_block() + i / kBlockTriangles];
    const std::uint32_t lane = i % kBlockTriangles;
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
      for (std::size_t axis = 0; axis < 3; ++axis)
        out[i].vertex[vertex][axis] = std::bit_cast<std::uint32_t>(block.vertex[vertex][axis][lane]);
    out[i].primitive = block.primitive[lane];
  }
  return out;
}

PackedLeaves::PackedLeaves(const Accel& accel) : places_(accel.blocks.size()) {
  for (const Node& node : accel.nodes)
    for (int lane = 0; lane < node.count; ++lane) add(accel, node.child[lane]);
  for (const InstanceNode& instance : accel.instances) add(accel, instance.root);
  add(accel, accel.root_key().ref);
  close();
  bytes_ = blocks_.size() * kPackedBytes;
  counts_.blocks = blocks_.size();
  counts_.bytes = bytes_;
  for (const PackedBlock& block : blocks_) {
    counts_.vertices += block.vertices;
    counts_.raw_blocks += block.raw;
  }
  for (const NodeRef leaf : procedural_) {
    Place& place = places_[leaf.first_block()];
    place.begin = bytes_;
    bytes_ += place.bytes;
  }
#ifdef CAROUSEL_CHECKED
  check(accel);
#endif
}

void PackedLeaves::add(const Accel& accel, NodeRef leaf) {
  if (leaf.is_inner() || leaf.is_instance() || leaf.triangles() == 0) return;
  Place& place = places_[leaf.first_block()];
  if (place.bytes > 0) return;
  if (leaf.is_procedural()) {
    place.bytes = leaf.triangles() * kPrimitiveBytes;
    procedural_.push_back(leaf);
    return;
  }
  std::vector<PackedTriangle> triangles = triangles_of(accel, leaf);
  order_in_strips(triangles);
  leaves_.push_back(leaf);
  ++counts_.leaves;
  counts_.triangles += triangles.size();
  place.triangles = leaf.triangles();
  std::vector<PackedTriangle> together = open_;
  together.insert(together.end(), triangles.begin(), triangles.end());
  std::optional<PackedBlock> block = encode_block(together);
  if (!block && !open_.empty()) {
    close();
    together = triangles;
    block = encode_block(together);
  }
  if (!block) return add_alone(triangles, place);
  place.begin = blocks_.size() * kPackedBytes;
  place.bytes = kPackedBytes;
  place.blocks = 1;
  place.first = static_cast<std::uint32_t>(open_.size());
  open_ = std::move(together);
  filled_ = *block;
}

/// A leaf that does not fit into a block has as many triangles in each of its own as fit.
void PackedLeaves::add_alone(const std::vector<PackedTriangle>& triangles, Place& place) {
  place.begin = blocks_.size() * kPackedBytes;
  for (std::size_t first = 0; first < triangles.size();) {
    std::size_t count = triangles.size() - first;
    std::optional<PackedBlock> block;
    while (!(block = encode_block({triangles.data() + first, count}))) --count;
    blocks_.push_back(*block);
    first += count;
    ++place.blocks;
  }
  place.bytes = place.blocks * kPackedBytes;
}

void PackedLeaves::close() {
  if (open_.empty()) return;
  blocks_.push_back(filled_);
  open_.clear();
}

std::vector<PackedTriangle> PackedLeaves::decoded(NodeRef leaf) const {
  const Place& at = place(leaf);
  std::vector<PackedTriangle> all;
  for (std::uint32_t i = 0; i < at.blocks; ++i) {
    const std::vector<PackedTriangle> one = decode_block(blocks_[at.begin / kPackedBytes + i].bits);
    all.insert(all.end(), one.begin(), one.end());
  }
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(at.first);
  return {first, first + static_cast<std::ptrdiff_t>(at.triangles)};
}

void PackedLeaves::check(const Accel& accel) const {
  for (const NodeRef leaf : leaves_) {
    std::vector<PackedTriangle> stored = triangles_of(accel, leaf), back = decoded(leaf);
    std::sort(stored.begin(), stored.end());
    std::sort(back.begin(), back.end());
    if (stored != back) throw std::logic_error("a block of triangles is decoded to other triangles");
  }
}

}  // namespace carousel::accel
