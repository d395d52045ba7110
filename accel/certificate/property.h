#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "accel/certificate/case_random.h"
#include "core/config/fields/accuracy.h"

namespace carousel::accel {

/// Keys of `accuracy` that a property depends on. The value of each, in this order, names a level.
enum class AccuracyKey { kTriangle, kBox, kTransform, kSpawn };

/// Numbers of a case that have a name in its text.
struct CaseField {
  std::string_view name;
  std::size_t count;
  std::size_t most = count;  ///< only of the last field; whole vectors between `count` and this
};

/// All numbers of a case, field after field.
using CaseValues = std::vector<float>;

/// The result of a case at one level.
struct Judgement {
  bool applies = false;  ///< the property applies to this case; if not, the other members have no meaning
  bool broken = false;
  double error = 0;  ///< in the property's unit
};

/// The judgement of one case in words.
struct CaseStory {
  std::string kernel;  ///< the answer of the level's own arithmetic
  std::string exact;   ///< the answer of exact arithmetic
};

/// Something that the levels of accuracy promise, or that is only counted of them, with the cases that try it.
struct Property {
  std::string_view name;
  std::uint32_t number;         ///< distinguishes its random numbers; never reused
  std::string_view says;        ///< in one line
  std::string_view error_unit;  ///< unit of Judgement::error; empty when there is none
  std::vector<AccuracyKey> keys;
  std::vector<CaseField> fields;

  /// True if the level promises the property; if not, violations are only counted.
  bool (*promised)(const AccuracyConfig& level);
  CaseValues (*make)(CaseRandom& random);
  /// One judgement a level. Any finite or infinite values are allowed. `story` is null, or receives the last level's
  /// text.
  void (*judge)(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                CaseStory* story);
};

/// The levels with every combination of the property's keys; other keys have their defaults.
std::vector<AccuracyConfig> levels_of(const Property& property);
/// As in "watertight/conservative".
std::string level_name(const Property& property, const AccuracyConfig& level);

}  // namespace carousel::accel
