#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "accel/certificate/property.h"
#include "core/system/executor.h"

namespace carousel::app {

/// All certified properties, in the order of the table.
const std::vector<accel::Property>& certified_properties();

/// The result of one property at one level.
struct LevelResult {
  AccuracyConfig level;
  bool promised = false;    ///< a broken case is a violation, and not only counted
  std::uint64_t cases = 0;  ///< cases to which the property applies
  std::uint64_t broken = 0;
  double worst_error = 0;                     ///< in the property's unit
  std::optional<std::uint64_t> first_broken;  ///< number of the case
};

struct PropertyResult {
  const accel::Property* property = nullptr;
  std::vector<LevelResult> levels;
};

struct Certificate {
  std::uint64_t seed = 0;
  std::uint64_t cases = 0;  ///< cases of each property
  double seconds = 0;
  std::vector<PropertyResult> properties;
  bool incomplete = false;  ///< stopped before its end

  std::uint64_t violations() const;
};

struct CertificateLimits {
  std::optional<std::uint64_t> cases;  ///< cases of each property; if absent, `seconds` count
  double seconds = 10;
};

/// Tries cases 0, 1, ... of every property at `level`, or at all levels, until a limit is reached or `stopped`. For a
/// number of cases everything but `seconds` is the same for any executor. `progress`, which may be empty, is told the
/// part of the work that is done, in [0, 1], and the cases of all properties together.
Certificate certify(std::uint64_t seed, const CertificateLimits& limits, const std::optional<AccuracyConfig>& level,
                    Executor& executor, const std::function<bool()>& stopped,
                    const std::function<void(double part, std::uint64_t cases)>& progress = {});

/// The values of case `number` of a property.
accel::CaseValues certificate_case(const accel::Property& property, std::uint64_t seed, std::uint64_t number);

}  // namespace carousel::app
