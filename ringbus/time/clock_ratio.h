#pragma once

#include <cstdint>
#include <numeric>

#include "ringbus/time/clock.h"

namespace carousel::ringbus {

/// Two clocks, of the resources and of the network between them, or any other pair of a near and a far one. They start
/// with a common edge, and their edges are counted: as the ratio of their frequencies is a ratio of integers, the edge
/// of one clock that follows an edge of the other is known exactly, however long a run takes.
///
/// What crosses from one clock to the other is taken over at the next edge of that one, which may be the same moment,
/// and then goes through a synchroniser, so many cycles of it. Equal clocks have neither.
class ClockRatio {
 public:
  ClockRatio() = default;
  /// In MHz, from 1 on. Cycle counts up to 2^63 / 100,000 can be converted.
  ClockRatio(std::int64_t core, std::int64_t network, std::int64_t synchroniser_cycles) {
    const std::int64_t common = std::gcd(core, network);
    core_ = static_cast<std::uint64_t>(core / common);
    network_ = static_cast<std::uint64_t>(network / common);
    synchroniser_ = core == network ? 0 : static_cast<Cycle>(synchroniser_cycles);
  }

  /// The first edge of the network's clock that is not before an edge of the resources', and the other way. Divisions
  /// are slow, and most clocks are equal.
  Cycle to_network(Cycle core) const { return equal() ? core : ceil_div(core * network_, core_); }
  Cycle to_core(Cycle network) const { return equal() ? network : ceil_div(network * core_, network_); }
  /// The last edge of the resources' clock that is not after an edge of the network's.
  Cycle before(Cycle network) const { return network * core_ / network_; }
  /// The last edge of the network's clock that is not after an edge of the resources'.
  Cycle floor_to_network(Cycle core) const { return core * network_ / core_; }
  /// Of a time that is counted in the network's cycles, the part before `end` of the resources: of so many cycles that
  /// ended by then, and, if `under_way`, of the one that has begun.
  Cycle part_before(Cycle ended, bool under_way, Cycle end) const {
    const Cycle begun = under_way ? end * network_ - floor_to_network(end) * core_ : 0;
    return (ended * core_ + begun) / network_;
  }
  /// What goes by until `core` at `each` in a cycle of the network, rounded down.
  std::uint64_t passed(Cycle core, std::uint64_t each) const {
    const Cycle whole = floor_to_network(core);
    return whole * each + (core * network_ - whole * core_) * each / core_;
  }
  bool equal() const { return core_ == network_; }
  /// The network's cycles in a cycle of the resources.
  double network_per_core() const { return static_cast<double>(network_) / static_cast<double>(core_); }

  /// The first edge of the resources' clock from which on something that leaves it `wait` cycles later is there by the
  /// network's at `edge` at the earliest.
  Cycle first_for(Cycle edge, Cycle wait) const {
    if (edge <= synchroniser_) return 0;
    // The edge before is too early for all that leave by its own time.
    const Cycle after = (edge - synchroniser_ - 1) * core_ / network_ + 1;
    return after > wait ? after - wait : 0;
  }

  /// When something that a resource sends is there by the clock of the network, and the other way.
  Cycle enter(Cycle core) const { return to_network(core) + synchroniser_; }
  Cycle leave(Cycle network) const { return to_core(network) + synchroniser_; }

 private:
  std::uint64_t core_ = 1, network_ = 1;  // without a common divisor
  Cycle synchroniser_ = 0;
};

}  // namespace carousel::ringbus
