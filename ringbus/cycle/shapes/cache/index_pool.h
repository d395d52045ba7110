#pragma once

#include <cstdint>
#include <vector>

namespace carousel::ringbus::cycle {

/// Things that are named by index. An index that has been given back is taken again, the last one first, so nothing is
/// allocated once the pool has grown.
template <class T>
class IndexPool {
 public:
  T& operator[](std::uint32_t index) { return things_[index]; }
  const T& operator[](std::uint32_t index) const { return things_[index]; }
  std::uint32_t take(const T& thing) {
    if (free_.empty()) {
      things_.push_back(thing);
      return static_cast<std::uint32_t>(things_.size() - 1);
    }
    const std::uint32_t index = free_.back();
    free_.pop_back();
    things_[index] = thing;
    return index;
  }
  /// The thing stays readable until the index is taken again.
  void give_back(std::uint32_t index) { free_.push_back(index); }

 private:
  std::vector<T> things_;
  std::vector<std::uint32_t> free_;
};

}  // namespace carousel::ringbus::cycle
