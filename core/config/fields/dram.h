#pragma once

#include <cstdint>
#include <optional>

#include "core/config/fields/field.h"

namespace carousel {

struct DramConfig {
  enum class Preset { kPipe, kGddr6, kHbm2, kLpddr5 } preset = Preset::kPipe;
  enum class Mapping {
    kRowBankColumnGroup,
    kRowBankGroupColumn,
    kRowColumnBankGroup
  } mapping = Mapping::kRowBankColumnGroup;
  std::int64_t channels = 2, interleave_bytes = 256, queue = 32;
  std::optional<std::int64_t> period_ps, refresh_cycles;  ///< absent: those of the preset
  bool refresh = true;
};

template <>
inline constexpr auto kEnumNames<DramConfig::Preset> = [] {
  using enum DramConfig::Preset;
  return names<DramConfig::Preset>(
      {{kPipe, "pipe"}, {kGddr6, "gddr6_14"}, {kHbm2, "hbm2_2"}, {kLpddr5, "lpddr5_6400"}});
}();

template <>
inline constexpr auto kEnumNames<DramConfig::Mapping> = [] {
  using enum DramConfig::Mapping;
  return names<DramConfig::Mapping>({{kRowBankColumnGroup, "row_bank_column_group"},
                                     {kRowBankGroupColumn, "row_bank_group_column"},
                                     {kRowColumnBankGroup, "row_column_bank_group"}});
}();

namespace config {

template <class V>
void describe(V& v, DramConfig& c) {
  v.choice(
      "preset", c.preset,
      "The memory is a pipe of one bandwidth and latency, or has the channels, banks and times of a kind of DRAM.");
  v.field("channels", c.channels, IntRange{1, 64}, "channels", "The number of channels.")
      .relax("memory_bandwidth", Better::kTwice);
  v.field("interleave_bytes", c.interleave_bytes, IntRange{32, 65536}, "bytes",
          "The size of the blocks of memory that the channels hold in turn.");
  v.choice("mapping", c.mapping,
           "The order of an address's parts within a channel, from its highest bits to its lowest.");
  v.field("queue", c.queue, IntRange{1, 1024}, "requests",
          "The number of reads, and likewise of writes, from which a channel chooses its next command.")
      .relax("dram_queue", Better::kTwice);
  v.field_or_auto("period_ps", c.period_ps, IntRange{100, 100'000}, "ps",
                  "The period of the DRAM's clock. With auto it is the preset's.");
  v.field("refresh", c.refresh, "", "The banks are refreshed.");
  // Less than the interval between refreshes, 3,125 cycles and more (ringbus/cycle/memory/dram/dram_timing.cpp).
  v.field_or_auto("refresh_cycles", c.refresh_cycles, IntRange{1, 3'000}, "DRAM cycles",
                  "The time of a refresh. With auto it is the preset's.");
}

}  // namespace config
}  // namespace carousel
