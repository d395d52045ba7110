#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "ringbus/cycle/time/clock.h"

namespace carousel::ringbus::cycle {

/// Set-associative cache of lines, least recently used out first. Holds tags, but no data.
class LineCache {
 public:
  /// As many sets as fit into `bytes`, but at least one. A line belongs to the set of its number modulo the sets.
  LineCache(std::uint64_t bytes, std::uint64_t line_bytes, std::uint64_t ways)
      : ways_(ways), sets_(std::max<std::uint64_t>(1, bytes / line_bytes / ways)), lines_(sets_ * ways_, kEmpty) {}

  /// Returns whether `line` is there, and makes it the last to be replaced.
  bool touch(std::uint64_t line) {
    std::uint64_t* set = set_of(line);
    for (std::uint64_t i = 0; i < ways_; ++i) {
      if (set[i] != line) continue;
      for (; i > 0; --i) set[i] = set[i - 1];
      set[0] = line;
      return true;
    }
    return false;
  }
  /// The lines that are there, in each set the one that is replaced next first.
  std::vector<std::uint64_t> lines() const {
    std::vector<std::uint64_t> out;
    for (std::uint64_t set = 0; set < sets_; ++set)
      for (std::uint64_t i = ways_; i-- > 0;)
        if (lines_[set * ways_ + i] != kEmpty) out.push_back(lines_[set * ways_ + i]);
    return out;
  }
  void insert(std::uint64_t line) {
    if (touch(line)) return;
    std::uint64_t* set = set_of(line);
    for (std::uint64_t i = ways_ - 1; i > 0; --i) set[i] = set[i - 1];
    set[0] = line;
  }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  std::uint64_t* set_of(std::uint64_t line) { return &lines_[line % sets_ * ways_]; }

  std::uint64_t ways_, sets_;
  std::vector<std::uint64_t> lines_;  // by set, most recently used first
};

}  // namespace carousel::ringbus::cycle
