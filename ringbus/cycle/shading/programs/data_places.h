#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/types/shade_facts.h"
#include "ringbus/results/memory_request.h"

namespace carousel::ringbus::cycle {

// Places in the simulated memory, beyond shapes and spilled entries.
inline constexpr std::uint64_t kRecords = std::uint64_t{1} << 50, kStates = std::uint64_t{1} << 51,
                               kFilm = std::uint64_t{1} << 52, kSky = kFilm + (std::uint64_t{1} << 51);
/// The tables that workers read, by ShadeData.
inline constexpr std::array<std::uint64_t, kShadeData> kTables{
    kSky + (std::uint64_t{1} << 48), kSky + (std::uint64_t{1} << 49), kSky + (std::uint64_t{1} << 50),
    kSky + (std::uint64_t{3} << 49), kSky + (std::uint64_t{13} << 47)};
/// The triangles of a rasteriser's tiles.
inline constexpr std::uint64_t kTileLists = kTables.back() + (std::uint64_t{1} << 46);
static_assert(kTileLists + (std::uint64_t{1} << 46) <= kPageTables);

constexpr std::uint64_t table_of(ShadeData what) {
  return kTables[static_cast<std::size_t>(what)];
}

}  // namespace carousel::ringbus::cycle
