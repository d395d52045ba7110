#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/structure/accel.h"
#include "ringbus/cycle/shapes/shape_span.h"

namespace carousel::ringbus::cycle {

/// The records of Gaussians in the simulated memory where their shapes are triangles, by leaf: who tests a leaf reads
/// the record of each Gaussian around which one of its triangles stands, once. A record begins at a 64-byte border.
/// Nothing where there are no such records. Immutable; any thread may read.
class GaussianRecords {
 public:
  GaussianRecords(const accel::Accel& accel, std::uint64_t at) {
    if (accel.gaussians == nullptr || accel.gaussians->bytes_apart() == 0) return;
    const std::uint32_t bytes = accel.gaussians->bytes_apart();
    const std::uint64_t room = (std::uint64_t{bytes} + 63) / 64 * 64;
    bytes_ = accel.gaussians->count() * room;
    of_leaf_.resize(accel.blocks.size());
    const auto consider = [&](accel::NodeRef ref) {
      if (ref.is_inner() || ref.is_instance()) return;
      Leaf& leaf = of_leaf_[ref.first_block()];
      if (leaf.count > 0) return;
      leaf.begin = static_cast<std::uint32_t>(spans_.size());
      for (std::uint32_t lane = 0; lane < ref.triangles(); ++lane) {
        const accel::TriangleBlock& block = accel.blocks[ref.first_block() + lane / accel::kBlockTriangles];
        const std::uint32_t primitive = block.primitive[lane % accel::kBlockTriangles] & accel::kPrimitiveMask;
        const ShapeSpan record{at + *accel.gaussians->of_triangle(primitive) * room, bytes};
        const auto own = std::find(spans_.begin() + leaf.begin, spans_.end(), record);
        of_lane_.resize(std::max(of_lane_.size(), 4 * std::size_t{ref.first_block()} + lane + 1));
        of_lane_[4 * std::size_t{ref.first_block()} + lane] = static_cast<std::uint32_t>(own - spans_.begin());
        if (own == spans_.end()) spans_.push_back(record);
      }
      leaf.count = static_cast<std::uint32_t>(spans_.size()) - leaf.begin;
    };
    consider(accel.root_key().ref);
    for (const accel::InstanceNode& instance : accel.instances) consider(instance.root);
    for (const accel::Node& node : accel.nodes)
      for (int lane = 0; lane < node.count; ++lane) consider(node.child[lane]);
  }

  /// Those of a leaf; none of a node.
  std::span<const ShapeSpan> of(accel::NodeRef ref) const {
    if (spans_.empty() || ref.is_inner()) return {};
    const Leaf& leaf = of_leaf_[ref.first_block()];
    return std::span(spans_).subspan(leaf.begin, leaf.count);
  }
  /// That of one triangle of a leaf.
  std::span<const ShapeSpan> of(accel::NodeRef ref, std::uint32_t lane) const {
    if (spans_.empty() || ref.is_inner()) return {};
    return std::span(spans_).subspan(of_lane_[4 * std::size_t{ref.first_block()} + lane], 1);
  }
  /// Of all Gaussians, with the gaps that alignment leaves.
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Leaf {
    std::uint32_t begin = 0, count = 0;  // in spans_
  };

  std::vector<ShapeSpan> spans_;
  std::vector<Leaf> of_leaf_;           // by its first block
  std::vector<std::uint32_t> of_lane_;  // in spans_, by first block and lane
  std::uint64_t bytes_ = 0;
};

}  // namespace carousel::ringbus::cycle
