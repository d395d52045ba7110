#pragma once

#include <cstdint>
#include <vector>

#include "accel/accel.h"
#include "accel/instance_data.h"

namespace carousel::ringbus::cycle {

/// Bytes of shape data and where they stand in the simulated memory.
struct ShapeSpan {
  std::uint64_t address = 0;
  std::uint32_t bytes = 0;
};

/// Where the acceleration structure lies: nodes first, each with its children's cull planes behind it, then triangles as
/// they are laid out in the host's, then what is stored of each instance's transform, from a 64-byte border on.
class ShapeMemory {
 public:
  ShapeMemory(const accel::Accel& accel, const AccuracyConfig& accuracy)
      : accel_(accel),
        blocks_at_((accel.nodes.size() * sizeof(accel::Node) + accel.plane_bytes + 63) / 64 * 64),
        instances_at_((blocks_at_ + accel.blocks.size() * sizeof(accel::TriangleBlock) + 63) / 64 * 64),
        instance_bytes_(accel::instance_bytes(accuracy)) {
    if (accel.planes.empty()) return;
    planes_before_.reserve(accel.nodes.size() + 1);
    planes_before_.push_back(0);
    for (const accel::Node& node : accel.nodes)
      planes_before_.push_back(planes_before_.back() + accel::plane_bytes(node, accel.shared_normals));
  }

  /// The strip below `key`: a node with its children's boxes and planes, or a leaf's triangles.
  ShapeSpan strip(accel::NodeKey key) const {
    if (key.ref.is_inner()) {
      const std::uint32_t node = key.ref.node();
      const std::uint64_t address = std::uint64_t{node} * sizeof(accel::Node);
      if (planes_before_.empty()) return {address, sizeof(accel::Node)};
      const std::uint64_t planes = planes_before_[node + 1] - planes_before_[node];
      return {address + planes_before_[node], static_cast<std::uint32_t>(sizeof(accel::Node) + planes)};
    }
    return {blocks_at_ + std::uint64_t{key.ref.first_block()} * sizeof(accel::TriangleBlock),
            key.ref.blocks() * static_cast<std::uint32_t>(sizeof(accel::TriangleBlock))};
  }

  /// What testing in `instance` needs of its transform; no bytes above the instances and where rays are not moved.
  ShapeSpan transform(std::uint32_t instance) const {
    if (instance == kNoInstance || accel_.instances[instance].transform.identity) return {};
    return {instances_at_ + std::uint64_t{instance} * ((instance_bytes_ + 63) / 64 * 64), instance_bytes_};
  }

 private:
  const accel::Accel& accel_;
  std::uint64_t blocks_at_, instances_at_;
  std::uint32_t instance_bytes_;
  std::vector<std::uint64_t> planes_before_;   // bytes, by node; empty without planes
};

}  // namespace carousel::ringbus::cycle
