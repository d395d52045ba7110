#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace carousel::scene {

/// The opacity of a piece of a triangle: every hit there stops the ray, none does, or the any-hit call decides.
enum class OpacityState : std::uint8_t { kTransparent, kOpaque, kUnknown };

/// Micro-triangles of a triangle of `level`: 4^level, in rows of equal v. A row's lower ones touch the edge v = 0 of
/// their row with a side, its upper ones with a corner.
struct MicroGrid {
  int level = 0;

  std::uint32_t side() const { return 1u << level; }
  std::uint32_t count() const { return 1u << 2 * level; }
  /// The number of a micro-triangle: `u` and `v` count the steps from the first corner.
  std::uint32_t number(std::uint32_t u, std::uint32_t v, bool upper) const {
    return v * (2 * side() - v) + 2 * u + (upper ? 1 : 0);
  }
  /// That of a point of the triangle, which lies within 2^-22 of its micro-triangle. Preconditions: u >= 0, v >= 0,
  /// u + v <= kMostSum.
  std::uint32_t number_at(float u, float v) const {
    const float steps = static_cast<float>(side()), x = u * steps, y = v * steps;  // exact
    const std::uint32_t iv = std::min(static_cast<std::uint32_t>(y), side() - 1), last = side() - 1 - iv;
    const std::uint32_t iu = std::min(static_cast<std::uint32_t>(x), last);
    const bool upper = iu < last && (x - static_cast<float>(iu)) + (y - static_cast<float>(iv)) > 1.0f;
    return number(iu, iv, upper);
  }
  /// Hits may lie beyond the edge u + v = 1 by the rounding of the intersection.
  static constexpr float kMostSum = 1.0f + 0x1p-22f;
};

/// Opacity micromaps of the triangles of a scene that may be non-opaque, as in VK_EXT_opacity_micromap: a triangle that
/// is opaque, transparent or unknown throughout is told by its index alone, and others have a state for each of their
/// micro-triangles. With two states only triangles that are known throughout have one. Any thread may read.
struct OpacityMicromaps {
  static constexpr std::uint32_t kIndexBytes = 4;
  // Entries beside numbers of maps.
  static constexpr std::uint32_t kAllTransparent = 0xffffffff, kAllOpaque = 0xfffffffe, kAllUnknown = 0xfffffffd,
                                 kNoIndex = 0xfffffffc;  ///< the triangle is opaque, and never looked up

  MicroGrid grid;
  std::uint32_t bits = 2;               ///< of a state in the machine's memory
  std::vector<std::uint32_t> mesh_of;   ///< by instance
  std::vector<std::uint64_t> first_of;  ///< by mesh, and the end: its triangles in `entries`, all or none
  std::vector<std::uint32_t> entries;   ///< by triangle
  std::vector<std::uint8_t> states;     ///< OpacityStates, four a byte from the lowest bits on, map by map
  std::uint64_t opaque = 0, transparent = 0, unknown = 0;                    ///< triangles without a map
  std::uint64_t micro_opaque = 0, micro_transparent = 0, micro_unknown = 0;  ///< of all maps

  /// A map of level 0 would have one state, which its entry tells.
  std::uint64_t maps() const { return 4 * states.size() / grid.count(); }
  /// Bytes of a map in the machine's memory.
  std::uint32_t map_bytes() const { return std::max(1u, grid.count() * bits / 8); }
  /// Of all indices and maps.
  std::uint64_t size_bytes() const {
    return kIndexBytes * (opaque + transparent + unknown + maps()) + maps() * map_bytes();
  }
  /// Bytes that the machine reads with a triangle: its index, and its map if it has one.
  std::uint32_t bytes_of(std::uint32_t mesh, std::uint32_t triangle) const {
    const std::uint32_t entry = entry_of(mesh, triangle);
    return entry == kNoIndex ? 0 : kIndexBytes + (entry < kNoIndex ? map_bytes() : 0);
  }
  /// Of a hit on a triangle that may be non-opaque, `u` and `v` as in Hit.
  OpacityState state(std::uint32_t instance, std::uint32_t triangle, float u, float v) const {
    const std::uint32_t entry = entry_of(mesh_of[instance], triangle);
    if (entry == kAllOpaque) return OpacityState::kOpaque;
    if (entry == kAllTransparent) return OpacityState::kTransparent;
    if (entry >= kNoIndex || !(u >= 0 && v >= 0 && u + v <= MicroGrid::kMostSum)) return OpacityState::kUnknown;
    const std::size_t at = std::size_t{entry} * grid.count() + grid.number_at(u, v);
    return static_cast<OpacityState>(states[at / 4] >> 2 * (at % 4) & 3);
  }

 private:
  std::uint32_t entry_of(std::uint32_t mesh, std::uint32_t triangle) const {
    const std::uint64_t first = first_of[mesh];
    return first == first_of[mesh + 1] ? kNoIndex : entries[first + triangle];
  }
};

}  // namespace carousel::scene
