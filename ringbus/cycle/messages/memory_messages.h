#pragma once

#include <cstdint>

#include "core/config/fields/memory.h"

namespace carousel::ringbus::cycle {

/// The bytes that come from memory at a time: a line, or with `memory.l2_sector_bytes` a part of it. Messages count in
/// these, and call each a line.
inline std::uint64_t fetched_bytes(const MemoryConfig& config) {
  return static_cast<std::uint64_t>(config.l2_sector_bytes.value_or(config.line_bytes));
}

/// A resource asks its cache for lines; `tag` comes back with the answer. Or it writes lines, which has no answer.
struct FetchRequest {
  std::uint64_t first_line = 0;
  std::uint32_t lines = 0;
  std::uint32_t tag = 0;
  std::uint32_t written = 0;  ///< bytes that it writes; 0 when it asks
  std::uint32_t skipped = 0;  ///< bytes of the first line before those that it writes
  std::uint32_t wanted = 0;   ///< with `others`: the bytes that it asks for, behind the skipped ones
  bool ends_by_flag = false;  ///< it names no number of lines: the cache finds the end of the strip
  std::uint64_t others = 0;   ///< clients of the cache that get the same bytes without asking, a bit each

  /// Address 8, number of lines 4 or a strip's stride 2, tag 4, a mask of 8 where there are others, and what is
  /// written.
  std::uint64_t bytes() const { return (ends_by_flag ? 14 : 16) + std::uint64_t{written} + (others != 0 ? 8 : 0); }
};
/// Set in the line number of a request to memory that writes the line, which has no answer.
inline constexpr std::uint64_t kWriteLine = std::uint64_t{1} << 63;
/// Set besides when all of the line is written, in a request of a resource's own cache to the L2.
inline constexpr std::uint64_t kWholeLine = std::uint64_t{1} << 62;
/// Shapes that come to a resource because another has asked for them (`memory.fetch: multicast`).
struct PushedShapes {
  std::uint64_t address = 0;
  std::uint32_t size = 0;
  std::uint64_t bytes() const { return size; }
};
/// All lines of the request are there.
struct FetchAnswer {
  std::uint32_t tag = 0;
};

}  // namespace carousel::ringbus::cycle
