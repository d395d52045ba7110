#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace carousel {

/// An allocator whose elements, made without arguments, have no value until they are written: for big arrays that
/// several threads write, each a part, and for places that may never be used, which then take no memory.
template <class T, class Base = std::allocator<T>>
struct UninitialisedAllocator : Base {
  static_assert(std::is_trivially_copyable_v<T>);
  using value_type = T;
  template <class U>
  struct rebind {
    using other = UninitialisedAllocator<U, typename std::allocator_traits<Base>::template rebind_alloc<U>>;
  };

  UninitialisedAllocator() = default;
  template <class U, class B>
  UninitialisedAllocator(const UninitialisedAllocator<U, B>& other) : Base(static_cast<const B&>(other)) {}

  template <class U>
  void construct(U*) {}
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    std::construct_at(at, std::forward<Args>(args)...);
  }
};

}  // namespace carousel
