#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "core/numeric/divisor.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Set-associative cache of lines, least recently used out first. Holds tags, but no data. A line may have parts
/// (sectors), which come one by one, and parts that have been written since. Addresses are numbers of parts.
class LineCache {
 public:
  /// As many sets as fit into `bytes`, but at least one. A line belongs to the set of its number modulo the sets.
  /// `keeps_writes`: written() may be called.
  LineCache(std::uint64_t bytes, std::uint64_t line_bytes, std::uint64_t ways, std::uint64_t parts = 1,
            bool keeps_writes = false)
      : ways_(ways),
        sets_(std::max<std::uint64_t>(1, bytes / line_bytes / ways)),
        parts_(parts),
        lines_(sets_.value() * ways_, kEmpty),
        states_(parts > 1 || keeps_writes ? sets_.value() * ways_ : 0) {}

  /// Returns whether `part` is there, and makes its line, if it has any part, the last to be replaced.
  bool touch(std::uint64_t part) {
    const std::uint64_t line = line_of(part), first = sets_.remainder(line) * ways_;
    for (std::uint64_t i = 0; i < ways_; ++i) {
      if (lines_[first + i] != line) continue;
      to_front(first, i);
      return states_.empty() || (states_[first].here & bit(part)) != 0;
    }
    return false;
  }
  /// The parts that are there, in each set the line that is replaced next first.
  std::vector<std::uint64_t> lines() const {
    std::vector<std::uint64_t> out;
    for (std::uint64_t set = 0; set < sets_.value(); ++set)
      for (std::uint64_t i = (set + 1) * ways_; i-- > set * ways_;)
        for (std::uint64_t p = 0; p < parts_ && lines_[i] != kEmpty; ++p)
          if (states_.empty() || (states_[i].here >> p & 1) != 0) out.push_back(lines_[i] * parts_ + p);
    return out;
  }
  /// Parts that are not there any more, the last one that was replaced last; as many as there is room for, at most.
  std::vector<std::uint64_t> replaced() const {
    std::vector<std::uint64_t> out;
    std::unordered_set<std::uint64_t> seen;
    for (const std::uint64_t line : lines_) seen.insert(line);
    for (std::size_t k = 0; k < replaced_.size(); ++k) {
      const std::uint64_t line = replaced_[(next_replaced_ + replaced_.size() - 1 - k) % replaced_.size()];
      if (!seen.insert(line).second) continue;
      for (std::uint64_t p = parts_; p-- > 0;) out.push_back(line * parts_ + p);
    }
    std::reverse(out.begin(), out.end());
    return out;
  }
  std::uint64_t room() const { return sets_.value() * ways_ * parts_; }  ///< in parts
  /// Parts of a line that was replaced which had been written: those from `first_part` on whose bits are set.
  struct Replaced {
    std::uint64_t first_part = 0, written = 0;
  };
  /// The part comes; its line replaces another, if none of its parts was there.
  Replaced insert(std::uint64_t part) {
    const std::uint64_t line = line_of(part), first = sets_.remainder(line) * ways_;
    std::uint64_t i = 0;
    while (i + 1 < ways_ && lines_[first + i] != line) ++i;
    const bool replaces = lines_[first + i] != line;
    Replaced out;
    if (replaces && lines_[first + i] != kEmpty) note_replaced(lines_[first + i]);
    if (replaces && !states_.empty()) {
      out = {lines_[first + i] * parts_, states_[first + i].written};
      states_[first + i] = {};
    }
    lines_[first + i] = line;
    to_front(first, i);
    if (!states_.empty()) states_[first].here |= bit(part);
    return out;
  }
  /// Marks all parts as not written, and appends those that were to `parts`.
  void take_written(std::vector<std::uint64_t>& parts) {
    for (std::size_t i = 0; i < states_.size(); ++i)
      for (std::uint64_t p = 0; p < parts_; ++p)
        if ((states_[i].written >> p & 1) != 0) parts.push_back(lines_[i] * parts_ + p);
    for (State& state : states_) state.written = 0;
  }
  /// The part, which has just been touched or inserted, is written.
  void written(std::uint64_t part) { states_[sets_.remainder(line_of(part)) * ways_].written |= bit(part); }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  struct State {
    std::uint64_t here = 0, written = 0;  // a bit for each part
  };
  std::uint64_t line_of(std::uint64_t part) const { return parts_ == 1 ? part : part / parts_; }
  std::uint64_t bit(std::uint64_t part) const { return std::uint64_t{1} << part % parts_; }
  void note_replaced(std::uint64_t line) {
    if (replaced_.size() < lines_.size()) return replaced_.push_back(line);
    replaced_[next_replaced_] = line;
    next_replaced_ = next_replaced_ + 1 == replaced_.size() ? 0 : next_replaced_ + 1;
  }
  template <class T>
  static void shift(T* set, std::uint64_t i) {
    const T front = set[i];
    for (; i > 0; --i) set[i] = set[i - 1];
    set[0] = front;
  }
  void to_front(std::uint64_t first, std::uint64_t i) {
    shift(&lines_[first], i);
    if (!states_.empty()) shift(&states_[first], i);
  }

  std::uint64_t ways_;
  Divisor sets_;
  std::uint64_t parts_;
  std::vector<std::uint64_t> lines_;     // by set, most recently used first
  std::vector<State> states_;            // by line; empty if a line comes as a whole and is never written here
  std::vector<std::uint64_t> replaced_;  // lines, as in a ring once there are as many as there is room for
  std::size_t next_replaced_ = 0;        // where the next one stands then
};

}  // namespace carousel::ringbus::cycle
