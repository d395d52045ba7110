#include "accel/packed/packed_block.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "accel/structure/node.h"

namespace carousel::accel {

namespace {

constexpr unsigned kCountBits = 6, kExponentBits = 9, kWidthBits = 5, kAnchorBits = 26, kPrimitiveBits = 31;
constexpr int kLeastExponent = -149;  // of floats
constexpr std::int64_t kMostAnchor = std::int64_t{1} << (kAnchorBits - 1);
constexpr unsigned kRotationBits = 2, kEdgeBits = 2, kOpacityBits = 2;
constexpr std::uint32_t kNewStrip = 0;  // else the edge of the last triangle that is shared, from 1 on
enum Opacity : std::uint32_t { kAllOpaque, kNoneOpaque, kSomeOpaque };  // of the triangles that are opaque

using VertexNumbers = std::array<std::uint32_t, 3>;  // of a triangle, by number of the vertex
using Coordinates = std::array<std::uint32_t, 3>;

unsigned bits_for(std::uint32_t most) {
  return static_cast<unsigned>(std::bit_width(most));
}

/// Bits of a number in two's complement, at least one.
unsigned signed_bits_for(std::int64_t value) {
  return bits_for(static_cast<std::uint32_t>(value < 0 ? ~value : value)) + 1;
}

/// The number of `width` bits that `low` has there.
std::int32_t extended(std::uint32_t low, unsigned width) {
  return static_cast<std::int32_t>(low << (32 - width)) >> (32 - width);
}

/// Vertices in the order in which triangles first have them.
struct Indexed {
  std::vector<Coordinates> vertices;
  std::vector<VertexNumbers> triangles;
};

Indexed indexed(std::span<const PackedTriangle> triangles) {
  Indexed out;
  for (const PackedTriangle& triangle : triangles) {
    VertexNumbers& corners = out.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = std::find(out.vertices.begin(), out.vertices.end(), triangle.vertex[i]);
      corners[i] = static_cast<std::uint32_t>(found - out.vertices.begin());
      if (found == out.vertices.end()) out.vertices.push_back(triangle.vertex[i]);
    }
  }
  return out;
}

/// A float as an odd number times a power of two; 0 has no power.
struct OddNumber {
  std::int64_t odd = 0;
  int exponent = std::numeric_limits<int>::max();
};

std::optional<OddNumber> odd_number(std::uint32_t bits) {
  const auto value = std::bit_cast<float>(bits);
  if (!std::isfinite(value) || bits == std::uint32_t{1} << 31) return std::nullopt;  // a grid has one zero
  if (value == 0) return OddNumber{};
  int exponent = 0;
  auto whole = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 24));
  exponent -= 24;
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(whole));
  whole /= std::int64_t{1} << zeros;
  return OddNumber{whole, exponent + zeros};
}

/// The vertices as multiples of 2^exponent.
struct OnGrid {
  int exponent = 0;
  std::vector<std::array<std::int64_t, 3>> at;
  std::array<std::int64_t, 3> anchor{};
  std::array<std::uint32_t, 3> most{};  // offset
};

std::optional<OnGrid> on_grid(std::span<const Coordinates> vertices) {
  OnGrid out;
  int exponent = std::numeric_limits<int>::max();
  for (const Coordinates& vertex : vertices)
    for (const std::uint32_t bits : vertex) {
      const std::optional<OddNumber> number = odd_number(bits);
      if (!number) return std::nullopt;
      exponent = std::min(exponent, number->exponent);
    }
  out.exponent = exponent == std::numeric_limits<int>::max() ? 0 : exponent;
  for (const Coordinates& vertex : vertices) {
    std::array<std::int64_t, 3>& at = out.at.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const OddNumber number = *odd_number(vertex[axis]);
      if (number.odd == 0) continue;
      if (number.exponent - out.exponent >= static_cast<int>(kAnchorBits)) return std::nullopt;
      at[axis] = number.odd * (std::int64_t{1} << (number.exponent - out.exponent));
      if (at[axis] < -kMostAnchor || at[axis] >= kMostAnchor) return std::nullopt;
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto less = [&](const auto& a, const auto& b) { return a[axis] < b[axis]; };
    const auto [first, last] = std::minmax_element(out.at.begin(), out.at.end(), less);
    out.anchor[axis] = (*first)[axis];
    out.most[axis] = static_cast<std::uint32_t>((*last)[axis] - (*first)[axis]);
  }
  return out;
}

/// How a triangle goes on from the one before: the edge they share, and its own rotation. Two neighbours that turn the
/// same way have the edge in opposite directions.
struct Step {
  std::uint32_t edge = kNewStrip, rotation = 0;
};

Step step_between(const VertexNumbers& before, const VertexNumbers& next) {
  for (std::uint32_t edge = 0; edge < 3; ++edge)
    for (std::uint32_t rotation = 0; rotation < 3; ++rotation)
      if (next[rotation] == before[(edge + 1) % 3] && next[(rotation + 1) % 3] == before[edge])
        return {edge + 1, rotation};
  return {};
}

/// Primitive numbers of neighbours in a strip often differ by little, so a number is an offset from the smallest one of
/// the block or, where that is shorter, a difference from the number before.
struct PrimitiveWidths {
  unsigned offset = 0, difference = 0;  ///< bits; difference 0: there are none, and no triangle says which it has

  bool has_difference(std::int64_t from_last) const {
    return difference > 0 && signed_bits_for(from_last) <= difference;
  }
};

std::int64_t from_last(std::span<const PackedTriangle> triangles, std::size_t i) {
  return std::int64_t{triangles[i].primitive & kPrimitiveMask} - (triangles[i - 1].primitive & kPrimitiveMask);
}

/// The widths with which the numbers of all triangles take the fewest bits.
PrimitiveWidths widths_of(std::span<const PackedTriangle> triangles, unsigned offset) {
  PrimitiveWidths best{offset, 0};
  std::size_t fewest = triangles.size() * offset;
  for (unsigned difference = 1; difference < offset; ++difference) {
    const PrimitiveWidths widths{offset, difference};
    std::size_t bits = offset;
    for (std::size_t i = 1; i < triangles.size(); ++i)
      bits += 1 + (widths.has_difference(from_last(triangles, i)) ? difference : offset);
    if (bits < fewest) best = widths, fewest = bits;
  }
  return best;
}

void put_primitives(BitWriter& out, std::span<const PackedTriangle> triangles) {
  std::uint32_t least = kPrimitiveMask, most = 0, not_opaque = 0;
  for (const PackedTriangle& triangle : triangles) {
    least = std::min(least, triangle.primitive & kPrimitiveMask);
    most = std::max(most, triangle.primitive & kPrimitiveMask);
    not_opaque += (triangle.primitive & kNonOpaqueBit) != 0;
  }
  const std::uint32_t opacity = not_opaque == 0                  ? kAllOpaque
                                : not_opaque == triangles.size() ? kNoneOpaque
                                                                 : kSomeOpaque;
  const PrimitiveWidths widths = widths_of(triangles, bits_for(most - least));
  out.put(bits_for(least), kWidthBits);
  out.put(least, bits_for(least));
  out.put(widths.offset, kWidthBits);
  out.put(widths.difference, kWidthBits);
  out.put(opacity, kOpacityBits);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const bool near = i > 0 && widths.has_difference(from_last(triangles, i));
    if (i > 0 && widths.difference > 0) out.put(near, 1);
    if (near)
      out.put(static_cast<std::uint32_t>(from_last(triangles, i)), widths.difference);
    else
      out.put((triangles[i].primitive & kPrimitiveMask) - least, widths.offset);
    if (opacity == kSomeOpaque) out.put(triangles[i].primitive >> kPrimitiveBits, 1);
  }
}

void take_primitives(BitReader& in, std::span<PackedTriangle> triangles) {
  const std::uint32_t least = in.take(in.take(kWidthBits));
  const PrimitiveWidths widths{in.take(kWidthBits), in.take(kWidthBits)};
  const std::uint32_t opacity = in.take(kOpacityBits);
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i > 0 && widths.difference > 0 && in.take(1) == 1)
      last += static_cast<std::uint32_t>(extended(in.take(widths.difference), widths.difference));
    else
      last = least + in.take(widths.offset);
    triangles[i].primitive = last;
    if (opacity == kNoneOpaque || (opacity == kSomeOpaque && in.take(1) == 1)) triangles[i].primitive |= kNonOpaqueBit;
  }
}

void put_topology(BitWriter& out, const Indexed& mesh) {
  const unsigned name = bits_for(static_cast<std::uint32_t>(mesh.vertices.size() - 1));
  std::uint32_t seen = 0;
  const auto put_vertex = [&](std::uint32_t vertex) {
    out.put(vertex == seen, 1);
    if (vertex == seen)
      ++seen;
    else
      out.put(vertex, name);
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const VertexNumbers& corners = mesh.triangles[i];
    const Step step = i == 0 ? Step{} : step_between(mesh.triangles[i - 1], corners);
    if (i > 0) out.put(step.edge, kEdgeBits);
    if (step.edge == kNewStrip) {
      for (const std::uint32_t corner : corners) put_vertex(corner);
    } else {
      out.put(step.rotation, kRotationBits);
      put_vertex(corners[(step.rotation + 2) % 3]);
    }
  }
}

PackedBlock raw_block(std::span<const PackedTriangle> triangles) {
  BitWriter out;
  out.put(1, 1);
  out.put(static_cast<std::uint32_t>(triangles.size() - 1), kCountBits);
  for (const PackedTriangle& triangle : triangles) {
    for (const Coordinates& vertex : triangle.vertex)
      for (const std::uint32_t bits : vertex) out.put(bits, 32);
    out.put(triangle.primitive, 32);
  }
  const auto count = static_cast<std::uint32_t>(triangles.size());
  return {out.bits(), 3 * count, count, true};
}

std::vector<PackedTriangle> decode_raw(BitReader& in) {
  std::vector<PackedTriangle> out(in.take(kCountBits) + 1);
  for (PackedTriangle& triangle : out) {
    for (Coordinates& vertex : triangle.vertex)
      for (std::uint32_t& bits : vertex) bits = in.take(32);
    triangle.primitive = in.take(32);
  }
  return out;
}

std::optional<PackedBlock> on_grid_block(std::span<const PackedTriangle> triangles) {
  const Indexed mesh = indexed(triangles);
  if (mesh.vertices.size() > kMostPackedVertices) return std::nullopt;
  const std::optional<OnGrid> grid = on_grid(mesh.vertices);
  if (!grid) return std::nullopt;
  BitWriter out;
  out.put(0, 1);
  out.put(static_cast<std::uint32_t>(triangles.size() - 1), kCountBits);
  out.put(static_cast<std::uint32_t>(mesh.vertices.size() - 1), kCountBits);
  out.put(static_cast<std::uint32_t>(grid->exponent - kLeastExponent), kExponentBits);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const unsigned width = signed_bits_for(grid->anchor[axis]);
    out.put(width, kWidthBits);
    out.put(static_cast<std::uint32_t>(grid->anchor[axis]), width);
    out.put(bits_for(grid->most[axis]), kWidthBits);
  }
  for (const auto& vertex : grid->at)
    for (std::size_t axis = 0; axis < 3; ++axis)
      out.put(static_cast<std::uint32_t>(vertex[axis] - grid->anchor[axis]), bits_for(grid->most[axis]));
  put_primitives(out, triangles);
  put_topology(out, mesh);
  if (out.size() > kPackedBits) return std::nullopt;
  return PackedBlock{out.bits(), static_cast<std::uint32_t>(mesh.vertices.size()),
                     static_cast<std::uint32_t>(triangles.size()), false};
}

}  // namespace

std::optional<PackedBlock> encode_block(std::span<const PackedTriangle> triangles) {
  if (triangles.empty() || triangles.size() > kMostPackedTriangles) return std::nullopt;
  std::optional<PackedBlock> out = on_grid_block(triangles);
  if (!out && triangles.size() <= kMostRawTriangles) out = raw_block(triangles);
  return out;
}

std::vector<PackedTriangle> decode_block(const PackedBits& bits) {
  BitReader in(bits);
  if (in.take(1) == 1) return decode_raw(in);
  std::vector<PackedTriangle> out(in.take(kCountBits) + 1);
  std::vector<Coordinates> vertices(in.take(kCountBits) + 1);
  const int exponent = static_cast<int>(in.take(kExponentBits)) + kLeastExponent;
  std::array<std::int32_t, 3> anchor{};
  std::array<unsigned, 3> width{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const unsigned anchor_width = in.take(kWidthBits);
    anchor[axis] = extended(in.take(anchor_width), anchor_width);
    width[axis] = in.take(kWidthBits);
  }
  for (Coordinates& vertex : vertices)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t at = std::int64_t{anchor[axis]} + in.take(width[axis]);
      vertex[axis] = std::bit_cast<std::uint32_t>(static_cast<float>(std::ldexp(static_cast<double>(at), exponent)));
    }
  take_primitives(in, out);
  const unsigned name = bits_for(static_cast<std::uint32_t>(vertices.size() - 1));
  std::uint32_t seen = 0;
  const auto take_vertex = [&] { return in.take(1) == 1 ? seen++ : in.take(name); };
  VertexNumbers last{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    VertexNumbers corners{};
    const std::uint32_t edge = i == 0 ? kNewStrip : in.take(kEdgeBits);
    if (edge == kNewStrip) {
      for (std::uint32_t& corner : corners) corner = take_vertex();
    } else {
      const std::uint32_t rotation = in.take(kRotationBits);
      corners[rotation] = last[edge % 3];
      corners[(rotation + 1) % 3] = last[edge - 1];
      corners[(rotation + 2) % 3] = take_vertex();
    }
    for (std::size_t j = 0; j < 3; ++j) out[i].vertex[j] = vertices[corners[j] % vertices.size()];
    last = corners;
  }
  return out;
}

void order_in_strips(std::span<PackedTriangle> triangles) {
  const Indexed mesh = indexed(triangles);
  const std::size_t count = triangles.size();
  std::vector<PackedTriangle> ordered;
  std::vector<bool> used(count);
  const auto neighbours = [&](std::size_t of) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i)
      found += !used[i] && i != of && step_between(mesh.triangles[of], mesh.triangles[i]).edge != kNewStrip;
    return found;
  };
  // The triangle with the fewest neighbours left would be hard to come to later.
  const auto choose = [&](const auto& may) {
    std::size_t best = count, fewest = count;
    for (std::size_t i = 0; i < count; ++i) {
      if (used[i] || !may(i)) continue;
      const std::size_t left = neighbours(i);
      if (left < fewest) best = i, fewest = left;
    }
    return best;
  };
  for (std::size_t last = count; ordered.size() < count;) {
    std::size_t next = count;
    if (last < count)
      next = choose(
          [&](std::size_t i) { return step_between(mesh.triangles[last], mesh.triangles[i]).edge != kNewStrip; });
    if (next == count) next = choose([](std::size_t) { return true; });
    used[next] = true;
    ordered.push_back(triangles[next]);
    last = next;
  }
  std::copy(ordered.begin(), ordered.end(), triangles.begin());
}

}  // namespace carousel::accel
