#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/measure/structure_depths.h"
#include "accel/structure/node.h"

namespace carousel::ringbus::cycle {

/// A piece of shape data in the simulated memory.
struct ShapeSpan {
  std::uint64_t address = 0;
  std::uint32_t bytes = 0;
  /// Bytes of the longest strip of its kind, for a strip that ends by its flag (`memory.strip_end: flag`). Until its
  /// end has been found, this is all that is known of its length. 0: the asker knows the length.
  std::uint32_t most = 0;
  std::uint16_t row = accel::StructureDepths::kNoRow;  ///< of a node or leaf
  friend bool operator==(const ShapeSpan& a, const ShapeSpan& b) {
    return a.address == b.address && a.bytes == b.bytes;
  }
};

/// The data that a test needs at one time: shapes, the stored data of their instance's transform, and the records of
/// Gaussians around which triangles among the shapes stand. A span without bytes is not needed. The records are those
/// of ShapeMemory, and differ from one another.
class ShapeNeed {
 public:
  static constexpr std::size_t kMost = 2 + accel::kMaxLeafTriangles;

  ShapeNeed() = default;
  ShapeNeed(const ShapeSpan& shapes, const ShapeSpan& transform, std::span<const ShapeSpan> gaussians = {})
      : own_{shapes, transform}, gaussians_(gaussians) {}

  std::size_t size() const { return own_.size() + gaussians_.size(); }
  const ShapeSpan& operator[](std::size_t i) const { return i < own_.size() ? own_[i] : gaussians_[i - own_.size()]; }
  std::uint32_t bytes() const {
    std::uint32_t sum = own_[0].bytes + own_[1].bytes;
    for (const ShapeSpan& span : gaussians_) sum += span.bytes;
    return sum;
  }

 private:
  std::array<ShapeSpan, 2> own_;
  std::span<const ShapeSpan> gaussians_;
};

}  // namespace carousel::ringbus::cycle
