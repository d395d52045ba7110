#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/config/fields/testers.h"
#include "core/config/fields/topology.h"
#include "core/statistics/distributor_counts.h"
#include "core/statistics/intersection_counts.h"
#include "ringbus/cycle/testers/ray_stages.h"
#include "ringbus/cycle/testers/unit_bank.h"

namespace carousel::ringbus::cycle {

/// Testers for all kinds of shapes behind a distributor, and the decision point that takes their results (US 9633468,
/// intersection testing resources with a queue each, and "a maximum number of out of order tests").
///
/// A packet's shapes go to all testers at once over a bus as wide as a link, packet after packet. Its ray IDs are
/// handed out in the packet's order, each to the tester that has the ray; if that has no place, the distributor waits.
/// A tester reads the record of a ray in the cycle after its ID has come, takes up a ray when the last test of the one
/// before has begun, and its results leave in order. IDs, shapes, results and free places take a link's latency. The
/// decision point takes results of older packets first.
///
/// Everything is first come, first served, and nothing that a packet does delays an older one. So the times of a packet
/// are known when it begins, and test() says them at once.
class Distributor {
 public:
  /// `testers`: at the levels of accuracy.
  Distributor(const TestersConfig& testers, const RayStages& stages, const LinkConfig& link);

  /// The rays of the next packet. `at`: their IDs and shapes are at the distributor; not before the last packet's.
  /// `slots`: in ray memory. `counts`: tests of all of them, which are taken as evenly spread over the rays. `overlap`:
  /// of the testers' banks. Sets `decided` to the cycles in which the results have passed the decision point, ray by
  /// ray.
  void test(Cycle at, std::span<const std::uint32_t> slots, const IntersectionCounts& counts, std::uint64_t shape_bytes,
            BankOverlap& overlap, std::vector<Cycle>& decided);
  /// Results have gone on together from the decision point.
  void part_went_on(std::size_t rays) {
    ++counts_.parts;
    counts_.results += rays;
  }

  /// As UnitBank's. Tracks from `track` on: tester by tester one a kind of unit.
  void record(SliceLog& slices, std::uint32_t track);
  void close(Cycle end);

  const DistributorCounts& counts() const { return counts_; }

  /// The units of a kind in all testers: the mean of their busy cycles, as UnitBank says them.
  class Units {
   public:
    Units(Distributor& of, UnitKind kind) : of_(of), kind_(kind) {}
    Cycle busy() const;
    Cycle busy_before(Cycle now) const;
    /// Part of the units that had a test, over the busy cycles of all testers.
    double fill() const;

   private:
    Distributor& of_;
    UnitKind kind_;
  };
  Units units(UnitKind kind) { return {*this, kind}; }
  /// Calls `call` with each bank of each tester.
  template <class Call>
  void each_bank(const Call& call) const {
    for (const OneTester& tester : testers_)
      for (const auto [kind, bank] : tester.units) call(bank);
  }

 private:
  /// The times of the last events of one kind, as many as there are places. A place is taken again when the event of
  /// the one that had it before is over.
  class Places {
   public:
    explicit Places(std::int64_t places) : left_(static_cast<std::size_t>(places)) {}
    /// When the next one finds a place: 0 if there has always been one.
    Cycle free_at() const { return left_[next_]; }
    /// It takes the place until `left`.
    void take(Cycle left) {
      left_[next_] = left;
      next_ = next_ + 1 == left_.size() ? 0 : next_ + 1;
    }

   private:
    std::vector<Cycle> left_;
    std::size_t next_ = 0;
  };
  struct OneTester {
    PerUnit<UnitBank> units;
    Places queue, results;
    Cycle free_at = 0;       // it may take up the next ray
    Cycle last_result = 0;   // has left
    Cycle last_decided = 0;  // likewise, has passed the decision point
  };

  Cycle hand_out(OneTester& to, std::uint64_t& in_cycle);
  Cycle decide(Cycle at);

  RayStages stages_;
  std::uint64_t ids_per_cycle_, results_per_cycle_, bytes_per_cycle_;
  Cycle latency_;
  std::vector<OneTester> testers_;
  Places window_;            // packets: done
  Cycle next_hand_out_ = 0;  // the earliest
  Cycle bus_free_ = 0;
  Cycle older_done_ = 0;                 // all packets so far have been decided
  Cycle decisions_begin_ = 0;            // the cycle of decisions_[0]
  std::deque<std::uint32_t> decisions_;  // results taken by cycle
  DistributorCounts counts_;
};

}  // namespace carousel::ringbus::cycle
