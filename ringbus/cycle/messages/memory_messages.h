#pragma once

#include <cstdint>

namespace carousel::ringbus::cycle {

/// A resource asks its cache for lines; `tag` comes back with the answer.
struct FetchRequest {
  std::uint64_t first_line = 0;
  std::uint32_t lines = 0;
  std::uint32_t tag = 0;

  /// Address 8, number of lines 4, tag 4.
  std::uint64_t bytes() const { return 16; }
};
/// All lines of the request are there.
struct FetchAnswer {
  std::uint32_t tag = 0;
};

}  // namespace carousel::ringbus::cycle
