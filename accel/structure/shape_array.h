#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "core/system/huge_pages.h"
#include "core/system/sparse_memory.h"
#include "core/system/uninitialised.h"

namespace carousel::accel {

/// An array of nodes or blocks. As a rule it is a vector; with `scene.placement: partitioned` it has gaps, the shapes
/// of other ranks, which have numbers here but no memory. So a number means one shape on all ranks, and reading one
/// that is here costs what it costs in a vector.
template <class T>
class ShapeArray {
 public:
  using value_type = T;
  /// A run of elements that are here.
  struct Part {
    std::size_t begin, end;
  };

  ShapeArray() = default;
  ShapeArray(ShapeArray&& other) noexcept { *this = std::move(other); }
  ShapeArray& operator=(ShapeArray&& other) noexcept {
    if (this == &other) return *this;
    dense_ = std::move(other.dense_);
    sparse_ = std::move(other.sparse_);
    gaps_ = std::move(other.gaps_);
    data_ = std::exchange(other.data_, nullptr);
    size_ = std::exchange(other.size_, 0);
    filled_ = std::exchange(other.filled_, 0);
    return *this;
  }
  /// Preconditions: no gaps.
  ShapeArray(const ShapeArray& other) : dense_(other.dense_) { sync(); }
  ShapeArray& operator=(const ShapeArray& other) {
    if (this != &other) *this = ShapeArray(other);  // leaves nothing of gaps that were here
    return *this;
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  /// Preconditions: no gaps.
  const T& at(std::size_t i) const { return dense_.at(i); }
  void assign(std::size_t size, const T& value) {
    dense_.assign(size, value);
    sync();
  }
  T& back() { return data_[size_ - 1]; }
  // Over all elements: for arrays without gaps.
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

  void reserve(std::size_t size) {
    if (sparse_.bytes() > 0) return;
    dense_.reserve(size);
    sync();
  }
  void resize(std::size_t size) {
    dense_.resize(size, T());
    sync();
  }
  /// To a larger size. The new elements have no value, and wait for any threads to write them. Where they are the
  /// first, some more may follow without a move.
  void grow(std::size_t size) {
    if (sparse_.bytes() == 0) {
      if (dense_.capacity() == 0) dense_.reserve(size + size / 64 + 8);
      dense_.resize(size);
      sync();
    } else {
      fill_to(size);
      size_ = size;
    }
  }
  void shrink_to_fit() {
    dense_.shrink_to_fit();
    sync();
  }
  void push_back(const T& value) { emplace_back() = value; }
  T& emplace_back() {
    if (sparse_.bytes() == 0) {
      dense_.push_back(T());
      sync();
    } else {
      fill_to(size_ + 1);
      new (data_ + size_++) T();
    }
    return back();
  }

  /// Before the first element: from here on the array may have gaps, and holds `most` elements at most.
  void allow_gaps(std::size_t most) {
    sparse_ = SparseMemory(most * sizeof(T));
    data_ = reinterpret_cast<T*>(sparse_.data());
  }
  /// The next elements are not here.
  void skip(std::size_t count) {
    if (count == 0) return;
    gaps_.push_back({size_, size_ + count});
    size_ += count;
    filled_ = std::max(filled_, size_);
  }
  std::vector<Part> parts() const {
    std::vector<Part> out;
    std::size_t begin = 0;
    for (const Part& gap : gaps_) {
      if (begin < gap.begin) out.push_back({begin, gap.begin});
      begin = gap.end;
    }
    if (begin < size_) out.push_back({begin, size_});
    return out;
  }
  /// Elements that are here.
  std::size_t here() const {
    std::size_t out = size_;
    for (const Part& gap : gaps_) out -= gap.end - gap.begin;
    return out;
  }
  /// Addresses behind the elements, for `room()` more of them; they have no memory yet.
  T* beyond() { return data_ + size_; }
  std::size_t room() const { return sparse_.bytes() / sizeof(T) - size_; }

 private:
  static constexpr std::size_t kAtOnce = 256;  // elements that get memory together

  void sync() {
    data_ = dense_.data();
    size_ = dense_.size();
  }
  void fill_to(std::size_t size) {
    if (size <= filled_) return;
    if (size > size_ + room()) throw std::bad_alloc();
    const std::size_t to = std::min(filled_ + std::max(size - filled_, kAtOnce), size_ + room());
    SparseMemory::fill(reinterpret_cast<std::byte*>(data_ + filled_), (to - filled_) * sizeof(T));
    filled_ = to;
  }

  std::vector<T, UninitialisedAllocator<T, HugePageAllocator<T>>> dense_;
  SparseMemory sparse_;
  std::vector<Part> gaps_;
  T* data_ = nullptr;
  std::size_t size_ = 0, filled_ = 0;
};

}  // namespace carousel::accel
