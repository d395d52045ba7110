#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/cycle/memory/dram/dram_timing.h"

namespace carousel::ringbus::cycle {

/// A read or a write of one transaction.
struct DramRequest {
  std::uint32_t bank = 0;
  std::uint64_t row = 0;
  bool write = false;
  std::uint64_t tag = 0;
};

/// The requests of one kind that have a place in a channel's controller, in a line for each bank.
///
/// All requests of a bank that are for its open row wait for the same cycle, and so do all others of that bank. So the
/// controller looks at two of each bank only: the oldest of both. A channel has at most 64 banks.
class DramQueue {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  struct Entry {
    DramRequest request;
    DramCycle taken = 0;
    std::uint64_t order = 0;  // grows from one taken request to the next
    std::uint32_t before = kNone, behind = kNone;
    bool counted = false;  // as a hit, a miss or a conflict
  };
  struct Line {
    std::uint32_t first = kNone, last = kNone;
    std::uint32_t hit = kNone, other = kNone;      // the oldest of the open row, and of any other
    std::uint64_t hit_order = 0, other_order = 0;  // orders of these two
  };

  explicit DramQueue(std::uint32_t banks) : lines_(banks) {}

  std::size_t size() const { return size_; }
  /// Banks that have requests of their open row, and of any other, a bit each.
  std::uint64_t hits() const { return hits_; }
  std::uint64_t others() const { return others_; }
  /// Requests that have taken a place so far.
  std::uint64_t taken() const { return taken_; }
  const Line& line(std::uint32_t bank) const { return lines_[bank]; }
  Entry& entry(std::uint32_t index) { return entries_[index]; }

  void push(const DramRequest& request, DramCycle now, std::uint64_t open_row);
  /// Takes an entry out.
  Entry take(std::uint32_t index, std::uint64_t open_row);
  /// The bank, which had no open row, has this one now.
  void open_row(std::uint32_t bank, std::uint64_t row);
  /// It has none any more.
  void close_row(std::uint32_t bank);

 private:
  void find_hit(std::uint32_t bank, std::uint32_t from, std::uint64_t open_row);
  void find_other(std::uint32_t bank, std::uint32_t from, std::uint64_t open_row);

  std::vector<Entry> entries_;
  std::vector<std::uint32_t> free_;  // unused places in entries_
  std::vector<Line> lines_;
  std::uint64_t hits_ = 0, others_ = 0, taken_ = 0;
  std::size_t size_ = 0;
};

}  // namespace carousel::ringbus::cycle
