#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/node.h"
#include "scene/model/opacity_micromaps.h"

namespace carousel::accel {

/// The bytes of opacity micromaps that stand behind the primitives of the blocks in the machine's memory, each behind
/// its own.
class MicromapPlaces {
 public:
  MicromapPlaces() = default;
  /// `bytes` by place: kBlockTriangles a block.
  explicit MicromapPlaces(const std::vector<std::uint32_t>& bytes) : before_(1, 0) {
    before_.reserve(bytes.size() + 1);
    for (const std::uint32_t own : bytes) before_.push_back(before_.back() + own);
  }

  /// The bytes behind all primitives that stand before a place of a block.
  std::uint64_t before(std::uint32_t block, std::uint32_t lane = 0) const {
    return before_.empty() ? 0 : before_[std::size_t{block} * kBlockTriangles + lane];
  }
  /// The bytes behind the primitives of a leaf.
  std::uint32_t of(NodeRef leaf) const {
    if (before_.empty()) return 0;
    return static_cast<std::uint32_t>(before(leaf.first_block() + leaf.blocks()) - before(leaf.first_block()));
  }
  std::uint64_t all() const { return before_.empty() ? 0 : before_.back(); }

 private:
  std::vector<std::uint64_t> before_;
};

/// Opacity micromaps and their bytes with the primitives of a structure.
struct PlacedMicromaps {
  const scene::OpacityMicromaps* maps = nullptr;  ///< null: there are none
  MicromapPlaces places;                          ///< empty without
};

}  // namespace carousel::accel
