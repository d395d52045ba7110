#pragma once

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
struct ShapeNeed {
  static constexpr std::size_t kMost = 2 + accel::kMaxLeafTriangles;

  ShapeSpan shapes, transform;
  std::span<const ShapeSpan> gaussians{};

  /// Without the last spans if they are not needed.
  std::size_t size() const { return transform.bytes == 0 && gaussians.empty() ? 1 : 2 + gaussians.size(); }
  const ShapeSpan& operator[](std::size_t i) const { return i == 0 ? shapes : i == 1 ? transform : gaussians[i - 2]; }
  std::uint32_t bytes() const {
    std::uint32_t sum = shapes.bytes + transform.bytes;
    for (const ShapeSpan& span : gaussians) sum += span.bytes;
    return sum;
  }
};

}  // namespace carousel::ringbus::cycle
