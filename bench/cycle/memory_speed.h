#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/cycle/cycle_results.h"
#include "core/config/config.h"

namespace carousel::bench {

/// The memory alone, whose speed is measured: a line of 64 bytes every four cycles, a
/// quarter of them written.
struct MemoryCase {
  std::string name;
  Config config;
  bool random = true;  ///< their addresses; otherwise one line behind the other
  std::uint64_t requests = 0;
};
std::vector<MemoryCase> memory_cases(std::uint64_t requests);

MemorySpeed measure_memory(const MemoryCase& one, int repetitions);

}  // namespace carousel::bench
