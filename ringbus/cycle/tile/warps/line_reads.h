#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "ringbus/cycle/shapes/shape_buffer.h"

namespace carousel::ringbus::cycle {

/// The reads of shape data for warps: lanes that ask together get each line once, and the port takes so many lines a
/// cycle. A line goes into the lanes that want it when it has come, so that nobody holds its place in the shape buffer;
/// hence reads that wait for room cannot block one another.
class LineReads {
 public:
  /// A line here is as much as a place of the shape buffer at least.
  LineReads(ShapeBuffer& shapes, const MemoryConfig& config, std::int64_t lines_per_cycle)
      : shapes_(shapes),
        line_bytes_(std::max<std::uint64_t>(fetched_bytes(config), ShapeBuffer::kPlaceBytes)),
        per_cycle_(static_cast<std::uint64_t>(lines_per_cycle)) {}

  /// Asks for what `task` needs. Returns the number of its lines.
  std::uint32_t ask(std::uint32_t task, const ShapeNeed& need) {
    std::uint32_t lines = 0;
    for (std::size_t which = 0; which < need.size(); ++which) {
      const ShapeSpan& span = need[which];
      if (span.bytes == 0) continue;
      const std::uint64_t last = (span.address + span.bytes - 1) / line_bytes_;
      for (std::uint64_t line = span.address / line_bytes_; line <= last; ++line) lines += add(line, task, span.row);
    }
    wanted_ += lines;
    return lines;
  }
  /// Those who ask from now on do so apart.
  void end_group() { group_.clear(); }

  /// From now on the lines of `span` are read while nobody asks for others; the last such span has been.
  void read_ahead(const ShapeSpan& span) {
    ahead_ = span.address / line_bytes_;
    ahead_end_ = (span.address + span.bytes + line_bytes_ - 1) / line_bytes_;
  }
  bool reads_ahead() const { return ahead_ < ahead_end_; }
  /// Looks lines of that span up, as far as the port is idle in this cycle, and reads those that are not there. Nobody
  /// holds them when they have come, so that later ones may replace them.
  void read_idle(Cycle now) {
    if (!reads_ahead()) return;
    begin_cycle(now);
    for (; queue_.empty() && reads_ahead() && in_cycle_ < per_cycle_; ++in_cycle_, ++ahead_) {
      if (shapes_.has(span_of(ahead_))) continue;
      const std::uint32_t user = free_read();
      reads_[user].line = ahead_;
      reads_[user].ahead = true;
      const std::uint64_t before = not_found();
      const bool here = shapes_.take(user, {span_of(ahead_), {}}, now);
      if (not_found() > before) {  // else it is on its way, since somebody has asked for it
        ++read_ahead_;
        early_.insert(ahead_);
      }
      if (here) arrive(user, now);
    }
  }

  /// The time of the next read; kNever if nothing waits for the port.
  Cycle next(Cycle now) const { return queue_.empty() && !reads_ahead() ? kNever : now + 1; }
  /// Reads as many lines as the port takes in this cycle. True if it read any.
  bool read(Cycle now) {
    begin_cycle(now);
    bool any = false;
    for (; !queue_.empty() && in_cycle_ < per_cycle_; ++in_cycle_) {
      const std::uint32_t user = queue_.front();
      queue_.pop_front();
      ++read_;
      any = true;
      const std::uint64_t line = reads_[user].line, before = not_found();
      const bool here = shapes_.take(user, {span_of(line, reads_[user].row), {}}, now);
      if (!early_.empty() && early_.erase(line) > 0) used_ahead_ += not_found() == before;
      if (here) arrive(user, now);
    }
    return any;
  }
  /// Takes the lines that have come meanwhile. True if there were any.
  bool take_ready(Cycle now) {
    if (shapes_.ready().empty()) return false;
    // Places that become free may serve others at once.
    for (std::size_t i = 0; i < shapes_.ready().size(); ++i) arrive(shapes_.ready()[i], now);
    shapes_.ready().clear();
    return true;
  }
  /// Tasks, once for each of their lines that has come. The caller empties it.
  std::vector<std::uint32_t>& here() { return here_; }
  bool idle() const { return reads_under_way_ == 0; }
  std::uint64_t wanted() const { return wanted_; }
  std::uint64_t read() const { return read_; }
  std::uint64_t lines_ahead() const { return read_ahead_; }
  /// Those of them that were there, or on their way, when somebody asked for them.
  std::uint64_t used_ahead() const { return used_ahead_; }

 private:
  struct Read {
    std::uint64_t line = 0;
    bool ahead = false;                                  // nobody has asked for it
    std::uint16_t row = accel::StructureDepths::kNoRow;  // of the first strip for which it was asked
    std::vector<std::uint32_t> tasks;
  };

  ShapeSpan span_of(std::uint64_t line, std::uint16_t row = accel::StructureDepths::kNoRow) const {
    return {line * line_bytes_, static_cast<std::uint32_t>(line_bytes_), 0, row};
  }
  /// Lines that have been asked for and were neither there nor on their way.
  std::uint64_t not_found() const { return shapes_.counts().misses + shapes_.counts().room_waits; }
  void begin_cycle(Cycle now) {
    if (now == at_) return;
    at_ = now;
    in_cycle_ = 0;
  }
  /// False if the task has asked for this line already: a strip and its transform may share one.
  bool add(std::uint64_t line, std::uint32_t task, std::uint16_t row) {
    const auto [at, is_new] = group_.try_emplace(line, 0);
    if (is_new) {
      at->second = free_read();
      reads_[at->second].line = line;
      reads_[at->second].row = row;
      queue_.push_back(at->second);
      ++reads_under_way_;
    }
    std::vector<std::uint32_t>& tasks = reads_[at->second].tasks;
    if (!tasks.empty() && tasks.back() == task) return false;
    tasks.push_back(task);
    return true;
  }
  std::uint32_t free_read() {
    if (free_.empty()) {
      reads_.emplace_back();
      return static_cast<std::uint32_t>(reads_.size() - 1);
    }
    const std::uint32_t user = free_.back();
    free_.pop_back();
    return user;
  }
  void arrive(std::uint32_t user, Cycle now) {
    here_.insert(here_.end(), reads_[user].tasks.begin(), reads_[user].tasks.end());
    reads_[user].tasks.clear();
    if (!std::exchange(reads_[user].ahead, false)) --reads_under_way_;
    shapes_.release(user, now);
    free_.push_back(user);
  }

  ShapeBuffer& shapes_;
  std::uint64_t line_bytes_, per_cycle_;
  std::vector<Read> reads_;  // by user of the shape buffer
  std::vector<std::uint32_t> free_;
  std::deque<std::uint32_t> queue_;                         // reads that wait for the port
  std::unordered_map<std::uint64_t, std::uint32_t> group_;  // by line
  std::vector<std::uint32_t> here_;
  std::size_t reads_under_way_ = 0;
  Cycle at_ = kNever;
  std::uint64_t in_cycle_ = 0, wanted_ = 0, read_ = 0;
  std::uint64_t ahead_ = 0, ahead_end_ = 0;  // lines
  std::unordered_set<std::uint64_t> early_;  // lines that were read ahead and that nobody has asked for since
  std::uint64_t read_ahead_ = 0, used_ahead_ = 0;
};

}  // namespace carousel::ringbus::cycle
