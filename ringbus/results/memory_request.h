#pragma once

#include <cstdint>
#include <vector>

namespace carousel::ringbus {

/// All addresses of the simulated memory lie below: shapes and spilled entries, records of rays, states of paths, the
/// film (cycle/shading/ray_data.cpp), page tables of shared caches.
inline constexpr std::uint64_t kMemoryEnd = std::uint64_t{1} << 53;
inline constexpr std::uint64_t kPageTables = kMemoryEnd - (std::uint64_t{1} << 48);

/// A request to the memory behind the caches, when it arrives there.
struct MemoryRequest {
  std::uint64_t cycle = 0;  ///< cycle of the engine
  std::uint64_t address = 0;
  std::uint32_t bytes = 0;
  bool write = false;
  friend bool operator==(const MemoryRequest&, const MemoryRequest&) = default;
};
/// In the order in which they arrived.
using MemoryLog = std::vector<MemoryRequest>;

}  // namespace carousel::ringbus
