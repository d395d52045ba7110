#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/fields/memory.h"
#include "ringbus/cycle/shapes/cache/line_cache.h"

namespace carousel::ringbus::cycle {

/// The tags of a cache. With `memory.l2_ray_ways` so many ways of each set hold spilled entries, records and states of
/// paths, and the other ways hold shapes: each part replaces only its own lines.
class TagArray {
 public:
  explicit TagArray(const MemoryConfig& config);

  /// Returns whether the line is there, and makes it the last to be replaced.
  bool touch(std::uint64_t line) { return ways_of(line).touch(line); }
  /// The line comes. Returns the lines that had been written and that it replaces.
  LineCache::Replaced insert(std::uint64_t line) { return ways_of(line).insert(line); }
  /// The line, which has just been touched or inserted, is written.
  void written(std::uint64_t line) { ways_of(line).written(line); }

  /// The lines that are there, those of shapes first.
  std::vector<std::uint64_t> lines() const;
  /// Returns the lines that were replaced last, as many as there is room for at most, and after them lines().
  std::vector<std::uint64_t> recent() const;
  std::uint64_t room() const { return ways_.room() + (ray_ways_ ? ray_ways_->room() : 0); }  ///< for lines
  /// Marks all lines as not written, and returns those that were, in the order of their addresses.
  std::vector<std::uint64_t> take_written();

 private:
  LineCache& ways_of(std::uint64_t line) { return ray_ways_ && line >= first_ray_line_ ? *ray_ways_ : ways_; }

  LineCache ways_;
  std::optional<LineCache> ray_ways_;
  std::uint64_t first_ray_line_;
};

}  // namespace carousel::ringbus::cycle
