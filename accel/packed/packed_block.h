#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/packed/bit_string.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// A triangle as a leaf holds it. `primitive` has kNonOpaqueBit. Two are equal if they are so to the bit.
struct PackedTriangle {
  std::array<std::array<std::uint32_t, 3>, 3> vertex;  ///< [vertex][axis], the bits of floats
  std::uint32_t primitive = 0;
  friend bool operator==(const PackedTriangle&, const PackedTriangle&) = default;
  friend auto operator<=>(const PackedTriangle&, const PackedTriangle&) = default;
};

inline constexpr std::uint32_t kMostPackedTriangles = 64, kMostPackedVertices = 64, kMostRawTriangles = 3;

/// A block of 128 bytes with up to 64 vertices and 64 triangles. It stands on a grid with steps of a power of two,
/// the largest of which all coordinates are multiples. An anchor an axis has up to 26 bits, and each vertex its offset
/// from it in as many bits as the largest offset of that axis needs. Triangles follow one another as in a strip: each
/// says which edge of the one before it it has, how its vertices are rotated, and if its own vertex is the next one or
/// an earlier one, which it names. Primitive numbers are a smallest one and offsets, or differences from the number
/// before. docs/reference/triangle-blocks.md has the format, bit by bit. Blocks of this size and purpose, with another
/// encoding and triangles that are rotated for it, are in J. Barczak, C. Benthin, D. McAllister, DGF: A Dense,
/// Hardware-Friendly Geometry Format for Lossily Compressing Meshlets with Arbitrary Topologies, HPG 2024.
///
/// Triangles without such a grid, with coordinates too far apart or not finite, are raw: three to a block, as floats.
/// Nothing is lost in either: decode_block() has the same bits, in the same order.
struct PackedBlock {
  PackedBits bits{};
  std::uint32_t vertices = 0, triangles = 0;  ///< as in the bits
  bool raw = false;                           ///< likewise
};

/// All of the triangles as one block, in their order; nothing if they do not fit. 1 to 3 triangles always do.
std::optional<PackedBlock> encode_block(std::span<const PackedTriangle> triangles);
std::vector<PackedTriangle> decode_block(const PackedBits& bits);

/// Puts the triangles of a leaf into the order of strips, with many edges shared by one and the next.
void order_in_strips(std::span<PackedTriangle> triangles);

}  // namespace carousel::accel
