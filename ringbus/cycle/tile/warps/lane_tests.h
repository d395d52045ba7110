#pragma once

#include <algorithm>
#include <cstdint>
#include <queue>
#include <vector>

#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/warps/line_reads.h"

namespace carousel::ringbus::cycle {

/// The strips that lanes of warps ask for, from their lines to the last answer of the test units, which all lanes
/// share.
class LaneTests {
 public:
  LaneTests(ShapeBuffer& shapes, const MemoryConfig& memory, std::int64_t lines_per_cycle, Tester& tester)
      : reads_(shapes, memory, lines_per_cycle), tester_(tester) {}

  /// The ray in `slot` asks for a strip, which has a byte at least. Its lines are shared with those of the others that
  /// ask before end_group().
  void ask(std::uint32_t slot, accel::NodeKey strip, const ShapeNeed& need) {
    std::uint32_t task = static_cast<std::uint32_t>(tasks_.size());
    if (free_.empty()) {
      tasks_.emplace_back();
    } else {
      task = free_.back();
      free_.pop_back();
    }
    tasks_[task] = {slot, 0, strip};
    tasks_[task].lines = reads_.ask(task, need);
  }
  void end_group() { reads_.end_group(); }

  /// Reads lines, and starts the tests whose last line has come: `test(slot, strip)` gives what is to be tested.
  /// True if any line has come or has been asked for.
  template <class Run>
  bool read_and_start(Cycle now, const Run& test) {
    bool any = reads_.take_ready(now);
    any |= reads_.read(now);
    for (const std::uint32_t task : reads_.here()) {
      Task& of = tasks_[task];
      if (--of.lines > 0) continue;
      const Cycle done = tester_.ray(tester_.read(now, 1), test(of.slot, of.strip));
      tests_.push({done, next_turn_++, task});
    }
    reads_.here().clear();
    return any;
  }
  /// Ends the tests that are done: `tested(slot, strip)`. True if there were any.
  template <class Tested>
  bool end(Cycle now, const Tested& tested) {
    bool any = false;
    for (; !tests_.empty() && tests_.top().done <= now; any = true) {
      const std::uint32_t task = tests_.top().task;
      tests_.pop();
      free_.push_back(task);
      tested(tasks_[task].slot, tasks_[task].strip);
    }
    return any;
  }

  /// The time of the next read or answer, after `now`.
  Cycle next(Cycle now) const { return std::min(reads_.next(now), tests_.empty() ? kNever : tests_.top().done); }
  /// As LineReads says.
  void read_ahead(const ShapeSpan& span) { reads_.read_ahead(span); }
  void read_idle(Cycle now) { reads_.read_idle(now); }
  bool testing() const { return !tests_.empty(); }
  std::size_t in_test() const { return tests_.size(); }
  bool reading() const { return !reads_.idle(); }
  const LineReads& reads() const { return reads_; }

 private:
  struct Task {
    std::uint32_t slot = 0, lines = 0;  // lines that have not come
    accel::NodeKey strip;
  };
  /// Of tests that end at one time, the one that began first goes on first.
  struct Test {
    Cycle done = 0;
    std::uint64_t turn = 0;
    std::uint32_t task = 0;
    bool operator>(const Test& o) const { return done != o.done ? done > o.done : turn > o.turn; }
  };

  LineReads reads_;
  Tester& tester_;
  std::vector<Task> tasks_;
  std::vector<std::uint32_t> free_;
  std::priority_queue<Test, std::vector<Test>, std::greater<>> tests_;
  std::uint64_t next_turn_ = 0;
};

}  // namespace carousel::ringbus::cycle
