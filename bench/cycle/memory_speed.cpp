#include "bench/cycle/memory_speed.h"

#include <fmt/format.h>

#include "ringbus/cycle/memory/memory_trace.h"

namespace carousel::bench {

namespace {

constexpr std::uint32_t kLineBytes = 64;

ringbus::MemoryLog requests_of(const MemoryCase& one) {
  constexpr std::uint64_t kCyclesEach = 4;
  ringbus::MemoryLog log;
  std::uint64_t state = 1;
  for (std::uint64_t i = 0; i < one.requests; ++i) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;  // D. Knuth's MMIX
    const std::uint64_t line = one.random ? state >> 40 : i;
    log.push_back({i * kCyclesEach, line * kLineBytes, kLineBytes, (state >> 33) % 4 == 0});
  }
  return log;
}

}  // namespace

std::vector<MemoryCase> memory_cases(std::uint64_t requests) {
  std::vector<MemoryCase> out;
  for (const auto& [preset, name] : kEnumNames<DramConfig::Preset>) {
    for (const bool random : {true, false}) {
      MemoryCase& one = out.emplace_back();
      one.name = fmt::format("{}, {}", name, random ? "random" : "sequential");
      one.config.engine.kind = EngineKind::kCycle;
      one.config.memory.dram.preset = preset;
      one.random = random;
      one.requests = requests;
    }
  }
  return out;
}

MemorySpeed measure_memory(const MemoryCase& one, int repetitions) {
  const ringbus::MemoryLog requests = requests_of(one);
  MemorySpeed out{one.name, requests.size(), 0, {}};
  std::vector<double> speeds;
  for (int i = 0; i < repetitions; ++i) {
    const Stopwatch stopwatch;
    out.cycles = ringbus::run_memory_trace(one.config.memory, one.config.engine.clock_mhz, requests).cycles;
    speeds.push_back(static_cast<double>(requests.size()) / stopwatch.elapsed().cpu);
  }
  out.requests_per_cpu_second = spread_of(speeds);
  return out;
}

}  // namespace carousel::bench
