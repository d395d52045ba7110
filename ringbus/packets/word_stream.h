#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "core/system/error.h"

namespace carousel::ringbus {

/// Appends values to a list of words, each value in words of its own, for a reader of the same build on a machine of
/// the same byte order.
class WordWriter {
 public:
  /// Keeps a reference.
  explicit WordWriter(std::vector<std::uint64_t>& words) : words_(words) {}

  template <class T>
  void part(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof value);
  }
  template <class T>
  void part(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    words_.push_back(values.size());
    append(values.data(), values.size() * sizeof(T));
  }

 private:
  void append(const void* from, std::size_t bytes) {
    if (bytes == 0) return;
    const std::size_t at = words_.size();
    words_.resize(at + (bytes + 7) / 8);
    std::memcpy(words_.data() + at, from, bytes);
  }
  std::vector<std::uint64_t>& words_;
};

/// Reads what a WordWriter wrote, in the same order. Throws a SimulationError where there are too few words.
class WordReader {
 public:
  explicit WordReader(std::span<const std::uint64_t> words) : left_(words) {}

  template <class T>
  void part(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    take(&value, sizeof value);
  }
  template <class T>
  void part(std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::uint64_t size = 0;
    part(size);
    if (size > left_.size_bytes() / sizeof(T)) too_short();
    values.resize(size);
    take(values.data(), size * sizeof(T));
  }
  bool at_end() const { return left_.empty(); }

 private:
  [[noreturn]] static void too_short() { throw SimulationError("a message between resources is cut short"); }
  void take(void* to, std::size_t bytes) {
    if (bytes == 0) return;
    const std::size_t words = (bytes + 7) / 8;
    if (words > left_.size()) too_short();
    std::memcpy(to, left_.data(), bytes);
    left_ = left_.subspan(words);
  }
  std::span<const std::uint64_t> left_;
};

}  // namespace carousel::ringbus
