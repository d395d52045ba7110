#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carousel::ringbus::cycle {

/// How many of the rays of a test share a place at most. 0: there are no such places.
struct RayPlaces {
  std::uint64_t cell = 0;  ///< test cells, each of which tests one ray at a time
  std::uint64_t bank = 0;  ///< banks of ray memory, each port of which reads one record a cycle
};

/// The test cells and the banks of ray memory that hold the slots in turn. US 9633468: a test cell is given rays of its
/// own bank; where it is given others, conflicts of a bank are handled one after another; a bank has one port to the
/// tests of boxes and one to those of primitives.
class PlaceCounter {
 public:
  PlaceCounter(std::int64_t cells, std::int64_t banks)
      : cells_(static_cast<std::uint32_t>(cells)), banks_(static_cast<std::uint32_t>(banks)) {}

  RayPlaces of(std::span<const std::uint32_t> slots) { return {most_in(slots, cells_), most_in(slots, banks_)}; }

 private:
  std::uint64_t most_in(std::span<const std::uint32_t> slots, std::uint32_t places) {
    if (places == 0) return 0;
    counts_.assign(places, 0);
    std::uint64_t most = 0;
    for (const std::uint32_t slot : slots) most = std::max(most, ++counts_[slot % places]);
    return most;
  }

  std::uint32_t cells_, banks_;
  std::vector<std::uint64_t> counts_;  // scratch
};

}  // namespace carousel::ringbus::cycle
