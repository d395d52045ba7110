#pragma once

#include <algorithm>
#include <cstdint>

#include "ringbus/cycle/memory/dram/dram_timing.h"

namespace carousel::ringbus::cycle {

/// The place of a transaction: its channel, the number of its bank within the channel (pseudo-channel, group and bank,
/// the pseudo-channel highest), and the row. The column within the row costs nothing and is left out.
struct DramPlace {
  std::uint32_t channel = 0, bank = 0;
  std::uint64_t row = 0;
  friend bool operator==(const DramPlace&, const DramPlace&) = default;
};

/// Addresses into places (`memory.dram.mapping`, `interleave_bytes`). Channels hold blocks of the address space in
/// turn. The mapping's name lists the parts of what is left within a channel from the highest to the lowest;
/// "group" stands for the group above the pseudo-channel. Rows are not bounded.
class DramMap {
 public:
  DramMap(const DramConfig& config, const DramTiming& timing)
      : mapping_(config.mapping),
        channels_(static_cast<std::uint64_t>(config.channels)),
        block_(static_cast<std::uint64_t>(config.interleave_bytes) / DramTiming::kTransactionBytes),
        pseudo_(timing.pseudo_channels),
        groups_(timing.groups),
        banks_(timing.banks),
        columns_(timing.columns()) {}

  DramPlace place(std::uint64_t address) const {
    const std::uint64_t transaction = address / DramTiming::kTransactionBytes, block = transaction / block_;
    rest_ = block / channels_ * block_ + transaction % block_;
    DramPlace out;
    out.channel = static_cast<std::uint32_t>(block % channels_);
    std::uint64_t bank = 0, group = 0, pseudo = 0;
    switch (mapping_) {
      case DramConfig::Mapping::kRowBankColumnGroup:
        pseudo = take(pseudo_), group = take(groups_), take(columns_), bank = take(banks_);
        break;
      case DramConfig::Mapping::kRowBankGroupColumn:
        take(columns_), pseudo = take(pseudo_), group = take(groups_), bank = take(banks_);
        break;
      case DramConfig::Mapping::kRowColumnBankGroup:
        pseudo = take(pseudo_), group = take(groups_), bank = take(banks_), take(columns_);
        break;
    }
    out.bank = static_cast<std::uint32_t>((pseudo * groups_ + group) * banks_ + bank);
    out.row = rest_;
    return out;
  }

 private:
  std::uint64_t take(std::uint64_t parts) const {
    const std::uint64_t part = rest_ % parts;
    rest_ /= parts;
    return part;
  }

  DramConfig::Mapping mapping_;
  std::uint64_t channels_, block_, pseudo_, groups_, banks_, columns_;
  mutable std::uint64_t rest_ = 0;
};

}  // namespace carousel::ringbus::cycle
