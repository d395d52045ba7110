#pragma once

#include <cstdint>

#include "core/statistics/collection_counts.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/resource/collections/collection_store.h"

namespace carousel::ringbus::cycle {

/// The layout of a resource's spilled collection entries in the simulated memory, beyond all shapes: block by block,
/// each with room for 12 bytes of key and entry and for its IDs of 4 bytes. A move to memory or back has the 12 bytes
/// and those of its IDs.
class SpillMemory {
 public:
  SpillMemory(ResourceId resource, std::uint64_t block_rays)
      : base_((resource.value + std::uint64_t{1}) << 40), block_bytes_(kHeader + kId * block_rays) {}

  ShapeSpan written(const SpillMove& move) {
    bytes_.written += bytes(move);
    return span(move);
  }
  ShapeSpan read(const SpillMove& move) {
    bytes_.read += bytes(move);
    return span(move);
  }
  const SpillBytes& moved() const { return bytes_; }

 private:
  static constexpr std::uint32_t kHeader = 12, kId = 4;
  static std::uint32_t bytes(const SpillMove& move) { return kHeader + kId * move.ids; }
  ShapeSpan span(const SpillMove& move) const {
    return {base_ + move.block * block_bytes_ + std::uint64_t{kId} * move.first, bytes(move)};
  }

  std::uint64_t base_, block_bytes_;
  SpillBytes bytes_;
};

}  // namespace carousel::ringbus::cycle
