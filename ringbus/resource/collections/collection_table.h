#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "accel/structure/node.h"

namespace carousel::ringbus {

/// Finds the collection of a node, or of one of the shapes of its strip: a hash table with linear probing and
/// backward-shift deletion (Knuth, TAOCP 3, section 6.4, algorithm R), which leaves no tombstones. Keys are compared
/// whole.
class CollectionTable {
 public:
  CollectionTable() : cells_(64) {}

  std::optional<std::uint32_t> find(accel::NodeKey key, std::uint8_t shape = 0) const {
    const std::uint64_t bits = key.bits();
    for (std::size_t i = home(bits); cells_[i].used; i = (i + 1) & (cells_.size() - 1))
      if (cells_[i].key == bits && cells_[i].shape == shape) return cells_[i].value;
    return std::nullopt;
  }
  /// The key must be absent.
  void insert(accel::NodeKey key, std::uint32_t value, std::uint8_t shape = 0) {
    if (2 * (size_ + 1) > cells_.size()) grow();
    place({key.bits(), value, shape, true});
    ++size_;
  }
  /// The key must be present.
  void erase(accel::NodeKey key, std::uint8_t shape = 0) {
    const std::size_t mask = cells_.size() - 1;
    std::size_t hole = home(key.bits());
    while (cells_[hole].key != key.bits() || cells_[hole].shape != shape) hole = (hole + 1) & mask;
    for (std::size_t i = (hole + 1) & mask; cells_[i].used; i = (i + 1) & mask) {
      // A cell may move into the hole unless its home lies behind the hole.
      if (((i - home(cells_[i].key)) & mask) < ((i - hole) & mask)) continue;
      cells_[hole] = cells_[i];
      hole = i;
    }
    cells_[hole].used = false;
    --size_;
  }
  std::size_t size() const { return size_; }

 private:
  struct Cell {
    std::uint64_t key = 0;
    std::uint32_t value = 0;
    std::uint8_t shape = 0;
    bool used = false;
  };
  std::size_t home(std::uint64_t key) const {
    // Fibonacci hashing; the high bits are the mixed ones.
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ull) >> 32) & (cells_.size() - 1);
  }
  void place(const Cell& cell) {
    std::size_t i = home(cell.key);
    while (cells_[i].used) i = (i + 1) & (cells_.size() - 1);
    cells_[i] = cell;
  }
  void grow() {
    std::vector<Cell> old(2 * cells_.size());
    old.swap(cells_);
    for (const Cell& cell : old)
      if (cell.used) place(cell);
  }

  std::vector<Cell> cells_;
  std::size_t size_ = 0;
};

}  // namespace carousel::ringbus
