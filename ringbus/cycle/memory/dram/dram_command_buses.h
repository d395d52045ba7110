#pragma once

#include "ringbus/cycle/memory/dram/dram_timing.h"

namespace carousel::ringbus::cycle {

/// The wires over which a channel's commands go: one bus for all of them, or one for rows and one for columns (HBM).
class DramCommandBuses {
 public:
  explicit DramCommandBuses(bool two) : two_(two) {}

  /// The first cycle in which an activate, a precharge or a refresh may be sent.
  DramCycle row_free() const { return row_free_; }
  /// The first cycle in which a read or a write may be sent.
  DramCycle column_free() const { return column_free_; }

  /// The command that is being sent takes the bus up to cycle `until`, which is free again.
  void use_row(DramCycle until) {
    row_free_ = until;
    if (!two_) column_free_ = until;
  }
  void use_column(DramCycle until) {
    column_free_ = until;
    if (!two_) row_free_ = until;
  }

 private:
  bool two_;
  DramCycle row_free_ = 0, column_free_ = 0;
};

}  // namespace carousel::ringbus::cycle
