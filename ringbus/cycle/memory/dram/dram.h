#pragma once

#include <cstdint>
#include <vector>

#include "core/config/fields/dram.h"
#include "ringbus/cycle/memory/dram/dram_channel.h"
#include "ringbus/cycle/memory/dram/dram_map.h"
#include "ringbus/results/dram_use.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// DRAM with banks: its channels, each with a controller of its own (DramChannel), and the address mapping. Transfers
/// of any length come as transactions of 32 bytes; a transfer is done with the last of them.
///
/// Its clock runs beside the engine's. Cycle k of DRAM begins at k periods; what comes in cycle c of the engine comes
/// with the first DRAM cycle that does not begin before c.
class Dram {
 public:
  Dram(const DramConfig& config, std::int64_t clock_mhz);

  /// A transfer comes in `now`; `tag` is given back with it.
  void push(std::uint64_t address, std::uint64_t bytes, bool write, std::uint64_t tag, DramCycle now);
  /// The next cycle in which anything is done for a transfer; kDramNever if there is none.
  DramCycle next() const;
  /// Everything before `end`, in the order of time. Calls `body(tag, done)` for each read whose last transaction is
  /// issued, with the end of its data; these ends do not decrease.
  template <class Body>
  void run(DramCycle end, const Body& body) {
    for (DramChannel* channel = first(); channel != nullptr && channel->next() < end; channel = first()) {
      const DramChannel::Issued issued = channel->step();
      if (!issued.served) continue;
      ++served_;
      Transfer& transfer = transfers_[issued.request.tag];
      if (--transfer.missing > 0) continue;
      free_.push_back(issued.request.tag);
      if (!issued.request.write) body(transfer.tag, issued.done);
    }
  }
  /// The run is over at `end`: refreshes up to there are counted.
  void close(DramCycle end);

  /// The DRAM cycle in which things of the engine's cycle come.
  DramCycle of_engine(Cycle cycle) const { return static_cast<DramCycle>(ceil_div(cycle * divisor_, factor_)); }
  /// The engine's cycle in which a DRAM cycle begins.
  Cycle engine_of(DramCycle cycle) const { return static_cast<Cycle>(cycle) * factor_ / divisor_; }
  /// The first cycle of the engine that does not begin before this DRAM cycle does.
  Cycle engine_end(DramCycle cycle) const { return ceil_div(static_cast<Cycle>(cycle) * factor_, divisor_); }

  std::uint64_t served_bytes() const { return served_ * DramTiming::kTransactionBytes; }
  /// Cycles of the engine for which the data wires of all channels were busy, the last one rounded up.
  Cycle busy() const;
  double peak_bytes_per_cycle() const;
  /// How many rows all channels have activated so far.
  std::uint64_t activations() const;
  /// The DRAM cycle in which the last transaction took a place.
  DramCycle last_taken() const;
  /// After a run of so many DRAM cycles.
  DramUse use(DramCycle cycles) const;

 private:
  struct Transfer {
    std::uint64_t tag = 0;
    std::uint32_t missing = 0;  // transactions
  };
  DramChannel* first();

  DramTiming timing_;
  DramMap map_;
  std::uint64_t clock_mhz_, factor_, divisor_;  // engine cycles to a DRAM cycle: factor / divisor
  std::vector<DramChannel> channels_;
  std::vector<Transfer> transfers_;
  std::vector<std::uint64_t> free_;  // unused places in transfers_
  std::uint64_t served_ = 0;         // transactions
};

}  // namespace carousel::ringbus::cycle
