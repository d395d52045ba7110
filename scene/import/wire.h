#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/types/vec.h"

namespace carousel::scene {

// How a module hands a scene to the program: the members of a struct one after another, as its function
//   template <class Wire> void describe(Wire& wire, T& value)
// lists them. Numbers are little-endian; a list begins with its length. Writer and reader follow the same function.

/// Values that are their bytes: numbers, and vectors and arrays of them. Not bool and enumerations, for which few bytes
/// are valid.
template <class T>
inline constexpr bool kPlain = std::is_arithmetic_v<T> && !std::same_as<T, bool>;
template <glm::length_t N, class T, glm::qualifier Q>
inline constexpr bool kPlain<glm::vec<N, T, Q>> = kPlain<T>;
template <class T, std::size_t N>
inline constexpr bool kPlain<std::array<T, N>> = kPlain<T>;

/// Appends values to bytes.
class WireWriter {
 public:
  explicit WireWriter(std::string& out) : out_(out) {}

  template <class... T>
  void operator()(T&... values) {
    (write(values), ...);
  }
  /// An enumeration whose last value is `last`.
  template <class E>
  void choice(E& value, E) {
    auto number = static_cast<std::uint8_t>(value);
    write(number);
  }

 private:
  template <class T>
  void write(T& value) {
    if constexpr (kPlain<T>) {
      raw(&value, sizeof value);
    } else if constexpr (std::same_as<T, bool>) {
      std::uint8_t number = value ? 1 : 0;
      write(number);
    } else {
      describe(*this, value);
    }
  }
  void write(std::string& text) {
    length(text.size());
    out_ += text;
  }
  template <class T>
  void write(std::vector<T>& list) {
    length(list.size());
    if constexpr (kPlain<T>)
      raw(list.data(), list.size() * sizeof(T));
    else
      for (T& each : list) write(each);
  }
  template <class T>
  void write(std::optional<T>& value) {
    bool there = value.has_value();
    write(there);
    if (there) write(*value);
  }
  void length(std::uint64_t count) { raw(&count, sizeof count); }
  void raw(const void* from, std::size_t size) {
    if (size > 0) out_.append(static_cast<const char*>(from), size);
  }

  std::string& out_;
};

/// Reads them back, from bytes that may hold anything. Its functions throw std::runtime_error where the bytes end early
/// or hold no such value, and what `take` throws, which is asked before memory is allocated.
class WireReader {
 public:
  WireReader(std::span<const unsigned char> bytes, const std::function<void(std::uint64_t)>& take)
      : rest_(bytes), take_(take) {}

  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  template <class E>
  void choice(E& value, E last) {
    std::uint8_t number = 0;
    read(number);
    if (number > static_cast<std::uint8_t>(last)) throw std::runtime_error("an enumeration has no such value");
    value = static_cast<E>(number);
  }
  bool at_end() const { return rest_.empty(); }

 private:
  template <class T>
  void read(T& value) {
    if constexpr (kPlain<T>) {
      raw(&value, sizeof value);
    } else if constexpr (std::same_as<T, bool>) {
      std::uint8_t number = 0;
      read(number);
      value = number != 0;
    } else {
      describe(*this, value);
    }
  }
  void read(std::string& text) {
    text.resize(length(1));
    raw(text.data(), text.size());
  }
  template <class T>
  void read(std::vector<T>& list) {
    if constexpr (kPlain<T>) {
      list.resize(length(sizeof(T)));
      raw(list.data(), list.size() * sizeof(T));
    } else {
      const std::size_t count = length(1);  // each takes a byte at least
      take_(count * (sizeof(T) - 1));
      list.resize(count);
      for (T& each : list) read(each);
    }
  }
  template <class T>
  void read(std::optional<T>& value) {
    bool there = false;
    read(there);
    if (there) read(value.emplace());
  }
  std::size_t length(std::size_t each) {
    std::uint64_t count = 0;
    raw(&count, sizeof count);
    if (count > rest_.size() / each) throw std::runtime_error("a list is cut off");
    take_(count * each);
    return static_cast<std::size_t>(count);
  }
  void raw(void* to, std::size_t size) {
    if (size > rest_.size()) throw std::runtime_error("the bytes end early");
    if (size > 0) std::memcpy(to, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }

  std::span<const unsigned char> rest_;
  const std::function<void(std::uint64_t)>& take_;
};

}  // namespace carousel::scene
