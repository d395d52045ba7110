#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "accel/structure/node.h"

namespace carousel::accel {

/// What the ranks that build one structure together have to know of one another.
struct BuildRanks {
  std::uint32_t rank = 0, ranks = 1;
  /// Returns every rank's bytes, by rank. Every rank calls, in the same order.
  std::function<std::vector<std::string>(const std::string&)> gather;
};

/// With `scene.placement: partitioned`: which rank has which shapes. A mesh's structure is at one rank as a whole, and
/// the shapes of a rank have consecutive numbers. The top level has the numbers behind them, and is on every rank.
struct Partition {
  std::uint32_t rank = 0;
  std::vector<std::uint32_t> node_begin, block_begin;  ///< by rank, and the end

  std::uint32_t ranks() const { return static_cast<std::uint32_t>(node_begin.size() - 1); }
  /// The rank that has a shape; none: every one has it.
  std::optional<std::uint32_t> home(NodeRef ref) const {
    if (ref.is_instance()) return std::nullopt;
    const auto& begin = ref.is_inner() ? node_begin : block_begin;
    const std::uint32_t number = ref.is_inner() ? ref.node() : ref.first_block();
    if (number >= begin.back()) return std::nullopt;
    return static_cast<std::uint32_t>(std::upper_bound(begin.begin(), begin.end(), number) - begin.begin() - 1);
  }
  bool here(NodeRef ref) const { return home(ref).value_or(rank) == rank; }
};

}  // namespace carousel::accel
