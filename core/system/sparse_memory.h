#pragma once

#include <cstddef>
#include <utility>

namespace carousel {

/// Addresses for an array of which only parts are in this process. The rest has no memory behind it and is not counted
/// against a limit of data (RLIMIT_DATA, `ulimit -d`); whoever touches it is ended by a signal.
class SparseMemory {
 public:
  SparseMemory() = default;
  /// Throws std::bad_alloc where so many addresses cannot be had.
  explicit SparseMemory(std::size_t bytes);
  ~SparseMemory();
  SparseMemory(SparseMemory&& other) noexcept { *this = std::move(other); }
  SparseMemory& operator=(SparseMemory&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }

  std::byte* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }

  /// Puts memory, of zeros at first, behind `bytes` addresses of such an array, in whole pages. Returns how much that
  /// came to. Throws std::bad_alloc. Any thread may call.
  static std::size_t fill(std::byte* begin, std::size_t bytes);

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace carousel
