#pragma once

#include <cstdint>

#include "core/config/fields/dram.h"

namespace carousel::ringbus::cycle {

/// A point of a DRAM's time, or a length of it, in cycles of its command clock.
using DramCycle = std::int64_t;
inline constexpr DramCycle kDramNever = std::int64_t{1} << 62;

/// A kind of DRAM: the organisation of a channel and its times, in cycles of the command clock, as the standards name
/// them. A time that follows a command counts from the cycle in which that command is issued.
struct DramTiming {
  std::int64_t period_ps = 1;
  std::uint32_t pseudo_channels = 1, groups = 1, banks = 1;  ///< groups of each pseudo-channel, banks of each group
  std::uint32_t row_bytes = 32;
  DramCycle cl = 0, cwl = 0, bl = 0;      ///< a read's and a write's command to its data, and the data's length
  DramCycle rcd_read = 0, rcd_write = 0;  ///< activate to read and write of the row
  DramCycle rp = 0, ras = 0, rc = 0;      ///< precharge to activate, activate to precharge and to activate
  DramCycle ccd_short = 0, ccd_long = 0;  ///< read to read, and write to write: of a pseudo-channel, of a group
  DramCycle rrd_short = 0, rrd_long = 0;  ///< activate to activate, likewise
  DramCycle faw = 0;                      ///< a pseudo-channel activates four rows at most within it
  DramCycle rtp = 0, wr = 0;              ///< read to precharge, and a write's last data to precharge
  DramCycle wtr_short = 0, wtr_long = 0;  ///< a write's last data to a read
  DramCycle read_to_write = 0;            ///< read to write of a pseudo-channel
  DramCycle refi = 0, rfc = 0;            ///< refresh to refresh, and the time of one
  DramCycle ppd = 1;                      ///< precharge to precharge
  DramCycle activate_cycles = 1;          ///< cycles of the command bus that an activate takes
  bool two_buses = false;                 ///< rows and columns have a command bus each
  /// An activate is two commands, the second at most so long behind the first. 0 if it is one command.
  DramCycle aad = 0;
  /// The data clock runs for so long behind data, and takes a command to start again. 0 if it always runs.
  DramCycle clock_post = 0;

  std::uint32_t all_banks() const { return pseudo_channels * groups * banks; }
  std::uint32_t columns() const { return row_bytes / kTransactionBytes; }

  static constexpr std::uint32_t kTransactionBytes = 32;  ///< that a read or a write moves
};

/// The times of a preset that has banks, with the period and the refresh that the configuration names.
DramTiming dram_timing(const DramConfig& config);

/// The most that a channel moves, in bytes a second: a transaction every ccd_short of each pseudo-channel.
double peak_bytes_per_second(const DramTiming& timing);

}  // namespace carousel::ringbus::cycle
