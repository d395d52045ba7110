#pragma once

#include <algorithm>
#include <cstdint>

#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus {

/// The clocks of a machine: nodes and links have a frequency in MHz, or 0, which is the clock of the resources.
class MachineClocks {
 public:
  /// `core_mhz`: engine.clock_mhz; `synchroniser_cycles`: clocks.synchroniser_cycles.
  MachineClocks(std::int64_t core_mhz, std::int64_t synchroniser_cycles)
      : core_(core_mhz), synchroniser_(synchroniser_cycles) {}

  /// A part of the machine goes by this clock.
  void use(std::int64_t mhz) { fastest_ = std::max(fastest_, of(mhz)); }
  /// The frequency itself.
  std::int64_t of(std::int64_t mhz) const { return mhz == 0 ? core_ : mhz; }
  /// From the cycles of one to those of another, with the synchroniser between them.
  ClockRatio between(std::int64_t from, std::int64_t to) const { return {of(from), of(to), synchroniser_}; }
  /// From the cycles of the resources to those of another.
  ClockRatio from_core(std::int64_t to) const { return between(0, to); }
  /// From the cycles of one to those of the fastest clock in use, by which windows of time go: any latency of a cycle
  /// or more is at least a cycle of it.
  ClockRatio to_fastest(std::int64_t from) const { return {of(from), std::max(fastest_, of(from)), 0}; }

 private:
  std::int64_t core_, synchroniser_;
  std::int64_t fastest_ = 0;
};

}  // namespace carousel::ringbus
