#pragma once

#include <nlohmann/json.hpp>

#include "bench/common/results.h"
#include "bench/common/stopwatch.h"

namespace carousel::bench {

// JSON shared by all benchmarks.

inline nlohmann::ordered_json json_of(const Spread& s) {
  return {{"median", s.median}, {"min", s.min}, {"max", s.max}};
}

inline nlohmann::ordered_json json_of(const MachineInfo& m) {
  return {{"cpu", m.cpu},           {"threads", m.threads},       {"caches", m.caches}, {"commit", m.commit},
          {"compiler", m.compiler}, {"build_type", m.build_type}, {"simd", m.simd},     {"date", m.date}};
}

}  // namespace carousel::bench
