#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>

namespace carousel::ringbus::cycle {

/// The lines that a memory has read: a bit each, in pages, since some lie far from the others.
class TouchedLines {
 public:
  /// Returns whether it is new.
  bool insert(std::uint64_t line) {
    if (const std::uint64_t number = line / kPageLines; last_ == nullptr || number != last_number_) {
      std::unique_ptr<Page>& page = pages_[number];
      if (!page) page = std::make_unique<Page>();
      last_ = page.get();
      last_number_ = number;
    }
    std::uint64_t& word = (*last_)[line % kPageLines / 64];
    const std::uint64_t bit = std::uint64_t{1} << line % 64;
    const bool is_new = (word & bit) == 0;
    word |= bit;
    return is_new;
  }

 private:
  static constexpr std::uint64_t kPageLines = 4096;
  using Page = std::array<std::uint64_t, kPageLines / 64>;
  std::unordered_map<std::uint64_t, std::unique_ptr<Page>> pages_;
  Page* last_ = nullptr;
  std::uint64_t last_number_ = 0;
};

}  // namespace carousel::ringbus::cycle
