#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace carousel::ringbus::cycle {

/// A TLB, and the walker that reads the page table for pages that are not in it.
///
/// The walker serves one page at a time, in the order of the first line that asked for each. It reads the levels of the
/// page table one after another, each of 512 entries, and puts the page in place of that used least recently. Who has a
/// translator brings it the entries, and says how a `Line` goes on that has waited.
template <class Line>
class Translator {
 public:
  /// Bytes of an entry of the page table.
  static constexpr std::uint32_t kEntryBytes = 8;
  /// Entries of a level stand from this power of two times its number on.
  static constexpr int kLevelTableBits = 44;

  /// With pages of 0 bytes addresses are physical.
  Translator(std::int64_t page_bytes, std::int64_t entries) : entries_(static_cast<std::size_t>(entries)) {
    if (page_bytes == 0) return;
    page_bits_ = std::countr_zero(static_cast<std::uint64_t>(page_bytes));
    levels_ = static_cast<std::uint32_t>((kAddressBits - page_bits_ + kLevelBits - 1) / kLevelBits);
  }

  bool on() const { return levels_ > 0; }

  enum class Found : std::uint8_t {
    kHere,
    kWaits,  ///< `line` comes back by take()
    kWalks,  ///< likewise, and the walker begins: entry() has to be read
  };
  Found look_up(std::uint64_t address, const Line& line) {
    const std::uint64_t page = address >> page_bits_;
    if (const auto at = std::ranges::find(tlb_, page); at != tlb_.end()) {
      std::rotate(at, at + 1, tlb_.end());
      return Found::kHere;
    }
    const auto walk = std::ranges::find(walks_, page, &Walk::page);
    if (walk != walks_.end()) {
      walk->lines.push_back(line);
      return Found::kWaits;
    }
    walks_.push_back({page, {line}});
    return walks_.size() == 1 ? Found::kWalks : Found::kWaits;
  }

  /// The walker has a page to read for.
  bool walks() const { return !walks_.empty(); }
  /// No level of it has been read.
  bool begins() const { return level_ == 0; }
  /// The entry that the walker reads, from the start of the page table.
  std::uint64_t entry() const {
    const std::uint64_t number = walks_.front().page >> (kLevelBits * static_cast<int>(levels_ - 1 - level_));
    return (std::uint64_t{level_} << kLevelTableBits) + number * kEntryBytes;
  }
  /// The entry has come. Returns the lines that waited for the page if it was the last level. While walks(), entry()
  /// then has to be read.
  std::optional<std::vector<Line>> take() {
    if (++level_ < levels_) return std::nullopt;
    level_ = 0;
    Walk done = std::move(walks_.front());
    walks_.pop_front();
    if (tlb_.size() == entries_) tlb_.erase(tlb_.begin());
    tlb_.push_back(done.page);
    return std::move(done.lines);
  }

 private:
  static constexpr int kAddressBits = 48, kLevelBits = 9;

  struct Walk {
    std::uint64_t page;
    std::vector<Line> lines;  // that wait for it
  };

  std::size_t entries_;
  int page_bits_ = 0;
  std::uint32_t levels_ = 0;        // of the page table; 0: addresses are physical
  std::vector<std::uint64_t> tlb_;  // pages, that used last at the end
  std::deque<Walk> walks_;          // of the first one the walker reads level_
  std::uint32_t level_ = 0;
};

}  // namespace carousel::ringbus::cycle
