#pragma once

#include <cstdint>
#include <string>

namespace carousel::ringbus::stress {

/// What a queue did wrong.
struct Violations {
  std::uint64_t lost = 0;       ///< pushed, never popped
  std::uint64_t doubled = 0;    ///< popped again
  std::uint64_t reordered = 0;  ///< popped after a later message of the same producer
  std::uint64_t corrupted = 0;  ///< the payload is not what was pushed, or nobody pushed it
  std::uint64_t bounds = 0;     ///< took more or fewer than its capacity, or refused without need, with one thread
  bool stuck = false;           ///< nothing moved for too long, or a call did not return
  std::string detail;           ///< the first of them, told

  bool any() const { return lost + doubled + reordered + corrupted + bounds > 0 || stuck; }
  /// "lost 3, torn 1"; empty when nothing is wrong.
  std::string names() const;
  Violations& operator+=(const Violations& o);
};

}  // namespace carousel::ringbus::stress
