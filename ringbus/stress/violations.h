#pragma once

#include <cstdint>
#include <string>

namespace carousel::ringbus::stress {

/// Counts a queue's errors.
struct Violations {
  std::uint64_t lost = 0;       ///< pushed and never popped
  std::uint64_t doubled = 0;    ///< popped again
  std::uint64_t reordered = 0;  ///< popped after a later message of the same producer
  std::uint64_t corrupted = 0;  ///< popped with contents that nobody pushed
  std::uint64_t bounds =
      0;               ///< with one thread: took more or fewer messages than its capacity, or refused without need
  bool stuck = false;  ///< nothing moved for too long, or a call did not return
  std::string detail;  ///< a sentence about the first of them

  bool any() const { return lost + doubled + reordered + corrupted + bounds > 0 || stuck; }
  /// "lost 3, torn 1"; empty when nothing is wrong.
  std::string names() const;
  Violations& operator+=(const Violations& o);
};

}  // namespace carousel::ringbus::stress
