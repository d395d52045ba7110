#pragma once

#include <cstdint>

namespace carousel::ringbus::cycle {

/// Nodes that hold the lines of memory in turn, so many lines each. A node numbers its own lines from zero, so that it
/// can use all of its sets, banks and rows.
class LineTurns {
 public:
  LineTurns() = default;
  /// Both are positive.
  LineTurns(std::uint64_t nodes, std::uint64_t lines) : nodes_(nodes), lines_(lines) {}

  std::uint64_t nodes() const { return nodes_; }
  std::uint64_t node_of(std::uint64_t line) const { return line / lines_ % nodes_; }
  /// The line's number at its node.
  std::uint64_t local(std::uint64_t line) const { return line / lines_ / nodes_ * lines_ + line % lines_; }
  /// The inverse of local(), for the lines of `node`.
  std::uint64_t global(std::uint64_t node, std::uint64_t local) const {
    return (local / lines_ * nodes_ + node) * lines_ + local % lines_;
  }

 private:
  std::uint64_t nodes_ = 1, lines_ = 1;
};

}  // namespace carousel::ringbus::cycle
