#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "core/config/fields/row.h"
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
//   list(key, vector of struct, meaning)
//   choices(key, vector of enum, meaning)
//   texts(key, vector of texts, meaning)
//   effects, workload, vary(key, value, meaning)   the three with a syntax of their own
// A row goes on with what else is known of its key (core/config/fields/row.h).

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

}  // namespace carousel::config
