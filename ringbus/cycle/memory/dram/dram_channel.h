#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/numeric/latency_histogram.h"
#include "core/statistics/dram_counts.h"
#include "ringbus/cycle/memory/dram/dram_command_buses.h"
#include "ringbus/cycle/memory/dram/dram_queue.h"
#include "ringbus/cycle/memory/dram/dram_timing.h"
#include "ringbus/time/fifo.h"

namespace carousel::ringbus::cycle {

/// A channel of DRAM and its controller, command by command (S. Rixner et al., Memory access scheduling, ISCA 2000:
/// first ready, first come first served, with rows that stay open).
///
/// In each cycle, in this order:
/// 1. A request that has come takes a place, reads before writes, if its kind has one (`memory.dram.queue`) free.
/// 2. The next command is chosen. A request needs a read or a write if its row is open, an activate if its bank has
///    none open, and else a precharge. The oldest request whose next command can be issued now issues it. A request
///    that has activated its row leaves its place, and goes before those that still have one; its row is not closed
///    before it has been served. With two command buses the oldest row command and the oldest column command are
///    issued; a row is not precharged in the cycle in which a request of it is served.
/// 3. A refresh that is due: no request is begun, all rows are closed at once as soon as those that have been activated
///    are served, and then nothing is activated for rfc cycles.
///
/// LPDDR5 has two further commands. Its activate is two commands (DramTiming::aad): the first begins all times, the
/// second opens the row. The second is issued in the first cycle in which nothing else can be, or at the latest that is
/// allowed; until then no other activate is issued, and no row of its bank is closed. And its data clock stops
/// (DramTiming::clock_post): a read or a write then waits for a command that starts it, and follows directly behind.
///
/// Reads are served until no read is left or three quarters of the writes' places are taken, and then writes until a
/// quarter is taken, if reads wait, or none.
///
/// Only a command, a refresh or another kind changes what can be issued when, so the next command is chosen behind
/// those, for the first cycle in which there is one; a request that comes in between is compared with it. Cycles in
/// which nothing is issued and nothing comes are skipped.
class DramChannel {
 public:
  DramChannel(const DramTiming& timing, std::size_t places);

  /// The request comes in cycle `now`, which is not before any step that was made.
  void push(const DramRequest& request, DramCycle now);
  /// The next cycle in which a step does anything for a request; kDramNever if it holds none.
  DramCycle next() const { return held_ == 0 ? kDramNever : next_; }
  /// The command that the step in next() issued.
  struct Issued {
    bool served = false;
    DramRequest request;  ///< that was served
    DramCycle done = 0;   ///< the end of its last data
  };
  Issued step();
  /// Nothing comes any more before `now`: refreshes go on without requests.
  void idle_until(DramCycle now);

  const DramCounts& counts() const { return counts_; }
  /// Latencies of reads, in DRAM cycles: from the taking of a place to the end of the data.
  const LatencyHistogram& latencies() const { return latencies_; }
  /// The cycle in which the last request took a place.
  DramCycle last_taken() const { return last_taken_; }

 private:
  static constexpr std::uint64_t kClosed = ~std::uint64_t{0};
  struct Bank {
    std::uint64_t row = kClosed;
    DramCycle activate = 0, precharge = 0;
    std::array<DramCycle, 2> column{};  // read, write: the earliest cycle of each command
    std::uint32_t group = 0, pseudo = 0;
  };
  struct Group {
    DramCycle activate = 0, gate = 0;  // gate: activate_gate() when the next commands were chosen
    std::uint32_t pseudo = 0;
    std::array<DramCycle, 2> column{};
  };
  struct Pseudo {
    DramCycle activate = 0;
    std::array<DramCycle, 2> column{};
    std::array<DramCycle, 4> last{};  // the earliest activates by the four-activate window, in turn
    std::uint32_t turn = 0;
  };
  struct Arrival {
    DramRequest request;
    DramCycle at = 0;
  };
  /// The command that is issued next, on one of the buses.
  struct Plan {
    DramCycle at = kDramNever;
    std::uint64_t order = 0;
    std::uint32_t index = 0, bank = 0;  // bank of the request, and its place, if it has one
    bool active = false;                // it has none: `index` is that in active_
    bool write = false;                 // the kind of the request, if it has a place
  };
  using Entry = DramQueue::Entry;
  /// A request whose row has had the first of two activate commands.
  struct HalfActive {
    Entry entry;
    DramCycle latest = 0;  // latest cycle of the second command
  };
  enum class Refresh { kNone, kClose, kRefresh };

  /// Gives one request a place, if one has arrived and a place is free, and returns it; null otherwise.
  const DramRequest* take_arrivals(DramCycle now);
  bool next_kind() const;
  DramCycle column_time(std::uint32_t bank, bool write) const;
  DramCycle activate_gate(const Group& group) const;
  void plan(DramCycle from);
  void plan_columns(DramCycle from);
  void plan_rows(DramCycle from);
  void plan_behind(DramCycle from, bool column, bool row);
  void consider_active(std::uint32_t index, DramCycle from);
  void consider(std::uint32_t bank, DramCycle now);
  void consider_column(std::uint32_t bank, DramCycle from);
  void consider_row(std::uint32_t bank, DramCycle from);
  void first_row(std::uint64_t banks, DramCycle from, Plan& row) const;
  void set_row(std::uint32_t bank, std::uint64_t row);
  void refresh(DramCycle now, DramCycle& wake);
  bool further_command(bool column, bool row, DramCycle now);
  Issued issue_column(const Plan& column, DramCycle now);
  void issue_row(const Plan& row, DramCycle now);
  void open_for(const Entry& entry);

  DramTiming timing_;
  std::size_t places_, high_, low_;
  std::array<Fifo<Arrival>, 2> arrivals_;  // reads, writes that have no place
  std::array<DramQueue, 2> queues_;        // reads, writes
  std::vector<Entry> active_;              // have activated their rows, at most one of each bank
  std::uint64_t activated_ = 0;            // their banks, a bit each
  std::uint64_t open_ = 0;                 // banks with an open row, likewise
  std::vector<Bank> banks_;
  std::vector<Group> groups_;
  std::vector<Pseudo> pseudos_;
  std::optional<HalfActive> half_;
  std::optional<Plan> behind_clock_;  // is issued in the next cycle: the data clock has been started for it
  DramCycle clock_stops_ = 0;         // when the data clock stops
  DramCommandBuses buses_;
  DramCycle precharge_ = 0;  // the earliest of any bank
  DramCycle refresh_due_;
  Refresh refresh_ = Refresh::kNone;
  bool writing_ = false;
  Plan column_, row_;
  bool planned_writes_ = false;  // the kind of requests of which these are
  std::size_t held_ = 0;         // requests
  DramRequest arrived_;          // that took a place last
  DramCycle now_ = 0, next_ = 0, last_taken_ = 0;
  DramCounts counts_;
  LatencyHistogram latencies_;
};

}  // namespace carousel::ringbus::cycle
