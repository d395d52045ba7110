#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "accel/structure/node.h"

namespace carousel::accel {

/// The ranks that build one structure together, and the way between them.
struct BuildRanks {
  std::uint32_t rank = 0, ranks = 1;
  /// Returns every rank's bytes, by rank. Every rank calls, in the same order.
  std::function<std::vector<std::string>(const std::string&)> gather;
};

/// With `scene.placement: partitioned`: which rank has which shapes. The shapes of a rank have consecutive numbers.
/// Nodes above what lies at several ranks have the numbers behind all these, and are at every rank; so are guests,
/// behind them.
struct Partition {
  std::uint32_t rank = 0;
  std::vector<std::uint32_t> node_begin, block_begin;  ///< by rank, and the end
  std::uint32_t above_end = 0;                         ///< the end of the nodes that every rank has, where guests begin

  std::uint32_t ranks() const { return static_cast<std::uint32_t>(node_begin.size() - 1); }
  /// The rank that has a shape; none: every one has it.
  std::optional<std::uint32_t> home(NodeRef ref) const {
    if (ref.is_instance()) return std::nullopt;
    const auto& begin = ref.is_inner() ? node_begin : block_begin;
    const std::uint32_t number = ref.is_inner() ? ref.node() : ref.first_block();
    if (number >= begin.back()) return std::nullopt;
    return static_cast<std::uint32_t>(std::upper_bound(begin.begin(), begin.end(), number) - begin.begin() - 1);
  }
  /// A node that every rank has.
  bool above(NodeRef ref) const { return ref.is_inner() && ref.node() >= node_begin.back() && ref.node() < above_end; }
  bool here(NodeRef ref) const { return home(ref).value_or(rank) == rank; }
};

}  // namespace carousel::accel
