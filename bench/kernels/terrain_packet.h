#pragma once

#include <cstddef>
#include <cstdint>

namespace carousel::bench {

// The setting of the benchmarks of single kernels: a small terrain that stays in the caches, and a packet of its rays.
inline constexpr std::int64_t kTriangles = 10'000;
inline constexpr std::uint32_t kImageSide = 64;
inline constexpr std::size_t kRays = 256;  // a packet's worth: 16 KiB of records

}  // namespace carousel::bench
