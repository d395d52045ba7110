#pragma once

#include <cstddef>
#include <vector>

namespace carousel {

/// Makes a vector `size` items long. This code stands apart from that around a call, as a vector seldom grows.
template <class T>
[[gnu::cold, gnu::noinline]] void lengthen(std::vector<T>& items, std::size_t size) {
  items.resize(size);
}
/// Makes a vector `size` items long if it is shorter.
template <class T>
void grow_to(std::vector<T>& items, std::size_t size) {
  if (items.size() < size) [[unlikely]]
    lengthen(items, size);
}

}  // namespace carousel
