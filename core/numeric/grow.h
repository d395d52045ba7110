#pragma once

#include <cstddef>
#include <vector>

namespace carousel {

/// Makes a vector so long, if it is shorter. What makes it longer is kept out of the code around a call: a vector that
/// has grown to the numbers that occur never does so again.
template <class T>
[[gnu::cold, gnu::noinline]] void lengthen(std::vector<T>& items, std::size_t size) {
  items.resize(size);
}
template <class T>
void grow_to(std::vector<T>& items, std::size_t size) {
  if (items.size() < size) [[unlikely]]
    lengthen(items, size);
}

}  // namespace carousel
