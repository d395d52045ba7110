#pragma once

#include <cstdint>
#include <string>

#include "core/config/load/load.h"
#include "ringbus/cycle/memory/memory_trace.h"
#include "ringbus/results/memory_request.h"

namespace carousel::ringbus {

/// A channel as the patterns see it.
struct ChannelShape {
  std::uint64_t pseudo_channels = 1, groups = 4, banks = 4, columns = 64, rows = 16384;
  bool ranks = false;  ///< the standard has ranks, of which a channel has one; it is drawn, too
};
inline constexpr ChannelShape kGddr6Shape{}, kHbm2Shape{.pseudo_channels = 2, .columns = 32},
    kLpddr5Shape{.rows = 32768, .ranks = true};

/// One channel whose clock is the engine's.
inline Config dram_config(const std::string& preset, const std::string& more = "") {
  return load_config({"engine: {kind: cycle, clock_mhz: 1000}\nworkload: {memory_trace: a.csv}\n"
                      "memory: {dram: {preset: " +
                          preset + ", channels: 1, period_ps: 1000, mapping: row_bank_group_column" + more + "}}\n",
                      "dram.yaml"})
      .config;
}

inline MemoryTraceResult run_dram(const std::string& preset, const std::string& more, const MemoryLog& requests) {
  const Config config = dram_config(preset, more);
  return run_memory_trace(config.memory, config.engine.clock_mhz, requests);
}

/// Ramulator's clock shows 1 in its first cycle, and its first refresh is due when it shows nREFI.
inline constexpr std::uint64_t kRamulatorBegins = 1;

/// Reads of 32 bytes, one every `gap` cycles from `begin` on, as those of tests/data/dram-ramulator21.csv:
/// `sequential`, `random_32`, `strip_B` and `hot_70`. For one channel with `mapping: row_bank_group_column`.
inline MemoryLog pattern_of(const std::string& name, const ChannelShape& shape, std::uint64_t reads, std::uint64_t gap,
                            std::uint64_t begin = kRamulatorBegins) {
  MemoryLog out;
  const auto add = [&](std::uint64_t pseudo, std::uint64_t group, std::uint64_t bank, std::uint64_t row,
                       std::uint64_t column) {
    const std::uint64_t place =
        (((row * shape.banks + bank) * shape.groups + group) * shape.pseudo_channels + pseudo) * shape.columns + column;
    out.push_back({begin + out.size() * gap, 32 * place, 32, false});
  };
  if (name == "sequential") {
    for (std::uint64_t i = 0; i < reads; ++i) {
      std::uint64_t rest = i;
      const auto take = [&rest](std::uint64_t parts) {
        const std::uint64_t part = rest % parts;
        rest /= parts;
        return part;
      };
      const std::uint64_t pseudo = take(shape.pseudo_channels), group = take(shape.groups),
                          column = take(shape.columns), bank = take(shape.banks);
      add(pseudo, group, bank, rest, column);
    }
    return out;
  }
  std::uint64_t x = 1;
  const auto draw = [&x](std::uint64_t n) {
    x = 6364136223846793005u * x + 1442695040888963407u;
    return (x >> 33) % n;
  };
  const bool hot = name == "hot_70";
  const std::uint64_t unit = hot ? 8 : std::stoull(name.substr(name.find('_') + 1)) / 32;
  while (out.size() < reads) {
    const bool near = hot && draw(10) < 7;
    if (shape.ranks) draw(1);
    const std::uint64_t pseudo = shape.pseudo_channels > 1 ? draw(shape.pseudo_channels) : 0,
                        group = draw(shape.groups), bank = draw(shape.banks), row = draw(near ? 4 : shape.rows),
                        column = draw(shape.columns / unit) * unit;
    for (std::uint64_t i = 0; i < unit && out.size() < reads; ++i) add(pseudo, group, bank, row, column + i);
  }
  return out;
}

}  // namespace carousel::ringbus
