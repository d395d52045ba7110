#pragma once

#include <cstdint>
#include <limits>

#include "accel/structure/shape_array.h"
#include "core/types/ray.h"

namespace carousel::accel {

inline constexpr int kMaxWidth = 8;
/// Triangles stand in blocks of this many, one SIMD register a coordinate.
inline constexpr int kBlockTriangles = 4;
inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;

/// Marks a primitive of a block that may be non-opaque and needs the any-hit call (core/types/any_hit.h).
inline constexpr std::uint32_t kNonOpaqueBit = 1u << 31;
inline constexpr std::uint32_t kPrimitiveMask = kNonOpaqueBit - 1;

/// Names a shape of the structure in 32 bits: an inner node, a leaf (1 to 16 triangles, or procedural primitives, in
/// consecutive blocks), or, below the top level only, an instance.
class NodeRef {
 public:
  enum class Kind : std::uint8_t { kInner = 0, kLeaf = 1, kInstance = 2, kProcedural = 3 };

  constexpr NodeRef() = default;
  static constexpr NodeRef inner(std::uint32_t node) { return NodeRef(node); }
  static constexpr NodeRef leaf(std::uint32_t first_block, std::uint32_t triangles) {
    return NodeRef(1u << 30 | (triangles - 1) << 26 | first_block);
  }
  static constexpr NodeRef procedural(std::uint32_t first_block, std::uint32_t primitives) {
    return NodeRef(3u << 30 | (primitives - 1) << 26 | first_block);
  }
  static constexpr NodeRef instance(std::uint32_t index) { return NodeRef(2u << 30 | index); }
  static constexpr NodeRef from_bits(std::uint32_t bits) { return NodeRef(bits); }

  constexpr Kind kind() const { return static_cast<Kind>(bits_ >> 30); }
  constexpr bool is_inner() const { return bits_ < (1u << 30); }
  constexpr std::uint32_t node() const { return bits_; }
  constexpr bool is_instance() const { return kind() == Kind::kInstance; }
  constexpr bool is_procedural() const { return kind() == Kind::kProcedural; }
  // Valid for either kind of leaf.
  constexpr std::uint32_t first_block() const { return bits_ & 0x03ffffffu; }
  constexpr std::uint32_t triangles() const { return ((bits_ >> 26) & 15u) + 1; }
  constexpr std::uint32_t blocks() const { return (triangles() + 3) / 4; }
  constexpr std::uint32_t instance_index() const { return bits_ & 0x3fffffffu; }
  constexpr std::uint32_t bits() const { return bits_; }
  friend constexpr bool operator==(NodeRef, NodeRef) = default;

 private:
  constexpr explicit NodeRef(std::uint32_t bits) : bits_(bits) {}
  std::uint32_t bits_ = 0;
};
inline constexpr std::uint32_t kMaxNodes = 1u << 30;
inline constexpr std::uint32_t kMaxBlocks = 1u << 26;
inline constexpr std::uint32_t kMaxLeafTriangles = 16;

/// A node at its place in the world. A collection gathers rays for one, and a packet names one. `instance` is
/// kNoInstance above the instances.
struct NodeKey {
  std::uint32_t instance = kNoInstance;
  NodeRef ref;

  std::uint64_t bits() const { return std::uint64_t{instance} << 32 | ref.bits(); }
  friend bool operator==(const NodeKey&, const NodeKey&) = default;
};

/// Up to eight child boxes, planes as structure of arrays: rows 0..2 are lo x, y, z, rows 3..5 hi x, y, z.
/// Unused lanes hold an inverted infinite box, which no ray can hit.
struct alignas(64) Node {
  float plane[6][kMaxWidth];
  NodeRef child[kMaxWidth];
  std::uint8_t strip_size[kMaxWidth];  ///< shapes below each child: its children, or its triangles
  std::uint8_t count = 0;              ///< children, in lanes 0..count-1
  std::uint8_t depth = 0;              ///< below the root of its structure, 255 at most; set with cull planes
  bool above_instances = false;        ///< part of the top level
  std::uint8_t direct =
      0;  ///< a bit a lane: Accel::held_leaf(), whose primitives are tested with the boxes, without its own
  std::uint32_t triangles = 0;     ///< below this node, instances counted each time; saturates
  std::uint32_t first_plane = 0;   ///< in Accel::planes: lane by lane, where there are any
  std::uint32_t plane_counts = 0;  ///< cull planes of each child, four bits a lane
  /// The margin by which the node's planes and boxes are moved outwards before a line is clipped to them: the first
  /// value times the distance along an axis from the ray's origin to the far side of the box, plus the second.
  float margin_per_reach = 0, least_margin = 0;

  Node() {
    for (int lane = 0; lane < kMaxWidth; ++lane) {
      for (int axis = 0; axis < 3; ++axis) {
        plane[axis][lane] = std::numeric_limits<float>::infinity();
        plane[axis + 3][lane] = -std::numeric_limits<float>::infinity();
      }
      strip_size[lane] = 0;
    }
  }
};
static_assert(sizeof(Node) == 256);

/// Four triangles, vertex by vertex, axis by axis. Unused lanes hold NaN positions, which no ray can hit.
/// A block of procedural primitives has the middles of their boxes for first vertices, and for third ones the ways from
/// there to the sides. Where a second vertex has its x is the radius of a sphere, or of one around what a program
/// finds; where it has its y are the bits of the program's number. The rest stays unused.
struct alignas(16) TriangleBlock {
  float vertex[3][3][kBlockTriangles];       ///< [vertex][axis][lane]
  std::uint32_t primitive[kBlockTriangles];  ///< with kNonOpaqueBit

  TriangleBlock() {
    for (auto& v : vertex)
      for (auto& axis : v)
        for (float& x : axis) x = std::numeric_limits<float>::quiet_NaN();
    for (auto& p : primitive) p = kNoPrimitive;
  }
};
static_assert(sizeof(TriangleBlock) == 160);

using NodeArray = ShapeArray<Node>;
using BlockArray = ShapeArray<TriangleBlock>;

}  // namespace carousel::accel
