#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/types/enum_names.h"

namespace carousel::config {

// Each file of this folder is one section of the configuration, and the only description of it: the enums with their
// spellings, the struct with its defaults, and a function `describe` that shows a visitor each key with its range,
// unit and meaning. Reader, writer, schema and documentation are visitors. A visitor V offers
//   field(key, value, [range,] unit, meaning)   integers, reals, colours; texts and switches without a range
//   field_or_auto(key, optional integer, real or vector, range, unit, meaning)
//   choice(key, enum or optional enum, meaning)
//   section(key, struct or optional struct, meaning)
//   section_or_number(key, struct, meaning)     a bare number stands for {units: number}
//   section_or_choice(key, struct, meaning)     a bare word stands for {hits: word}
//   section_or_text(key, struct, meaning)       a bare word stands for {default: word}
//   list(key, vector of struct, meaning)
//   choices(key, vector of enum, meaning)
//   texts(key, vector of texts, meaning)
//   effects, workload, vary(key, value, meaning)   the three with a syntax of their own
//   others(map of name to integer or real, range, unit, meaning)   numbers under any other name; the last row of its
//                                               section
//   members(map of name to struct, meaning)     sections under any name; the only row of its section
//   own_key(row of kOwnKeys, optional integer)             a number in which a resource differs
// A row goes on with what else is known of its key (Row).

/// A closed range.
struct IntRange {
  std::int64_t min, max;
};

/// A closed range, or without its lower end.
struct RealRange {
  double min, max;
  bool above_min = false;
};

inline constexpr std::int64_t kMaxResources = 256;
inline constexpr std::int64_t kMaxSlots = 1 << 22;
// A ray ID is 32 bits: the resource's number and the slot's have to fit.
static_assert(std::bit_width(std::uint64_t(kMaxResources - 1)) + std::bit_width(std::uint64_t(kMaxSlots - 1)) <= 32);

inline constexpr IntRange kSeed{0, std::numeric_limits<std::int64_t>::max()};
inline constexpr IntRange kCycles{1, 1'000'000};

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
  /// A row of kOwnKeys (own_keys.h): a number of one resource, or auto.
  template <class Key, class T>
  Row own_key(const Key& row, T& value) {
    self().on_field_or_auto(row.name, value, row.range, row.unit, row.meaning);
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
