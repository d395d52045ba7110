#pragma once

#include <cstdint>
#include <utility>

namespace carousel::config {

/// How the search for the bottleneck makes a part better by a number of the configuration. A key whose value is one of
/// a list names the value instead.
enum class Better : std::uint8_t {
  kTwice,       ///< twice as many, or as wide
  kTwiceOrOne,  ///< likewise, and 1 where there was none
  kHalf,        ///< half the time, at least one cycle
};

/// The rest of what the row of a key says to the search. All keys with one class are relaxed together.
struct Relaxed {
  int times = 6;              ///< how often tester_limited() relaxes it; 0: it is part of the test, or a choice
  bool keeps_shapes = false;  ///< more room for shapes, which fills long after the machine is full of rays
};
inline constexpr int kStorageTimes = 2;  ///< for storage, which the host has to hold too

/// The value that `field`, `field_or_auto`, `choice` and `section_or_number` of a visitor return, so that a row goes
/// on:
///   .relax(class, Better or value, [Relaxed, condition])   the search relaxes the key, where the condition holds
///   .only(engine, words, [values])                         the other engine does not have these values, or any but the
///                                                          default; the words say in messages what it lacks
/// This type ignores both; visitors that need them return a type of their own.
struct Row {
  template <class... Rest>
  constexpr Row relax(const Rest&...) const {
    return {};
  }
  template <class... Rest>
  constexpr Row only(const Rest&...) const {
    return {};
  }
};

/// The base of a visitor V that asks for the values alone: its on_field() and the others return nothing.
template <class V>
class RowVisitor {
 public:
  template <class... Args>
  Row field(Args&&... args) {
    self().on_field(std::forward<Args>(args)...);
    return {};
  }
  template <class... Args>
  Row field_or_auto(Args&&... args) {
    self().on_field_or_auto(std::forward<Args>(args)...);
    return {};
  }
  template <class... Args>
  Row choice(Args&&... args) {
    self().on_choice(std::forward<Args>(args)...);
    return {};
  }
  template <class... Args>
  Row section_or_number(Args&&... args) {
    self().on_section_or_number(std::forward<Args>(args)...);
    return {};
  }

 private:
  V& self() { return static_cast<V&>(*this); }
};

}  // namespace carousel::config
