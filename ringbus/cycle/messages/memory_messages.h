#pragma once

#include <cstdint>

namespace carousel::ringbus::cycle {

/// A resource asks its cache for lines; `tag` comes back with the answer. Or it writes lines, which has no answer.
struct FetchRequest {
  std::uint64_t first_line = 0;
  std::uint32_t lines = 0;
  std::uint32_t tag = 0;
  std::uint32_t written = 0;  ///< bytes that it writes; 0 when it asks

  /// Address 8, number of lines 4, tag 4, and what is written.
  std::uint64_t bytes() const { return 16 + std::uint64_t{written}; }
};
/// Set in the line number of a request to memory that writes the line, which has no answer.
inline constexpr std::uint64_t kWriteLine = std::uint64_t{1} << 63;
/// All lines of the request are there.
struct FetchAnswer {
  std::uint32_t tag = 0;
};

}  // namespace carousel::ringbus::cycle
