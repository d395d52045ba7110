#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The testers behind a distributor, and what kept them from working.
struct DistributorCounts {
  std::uint64_t packets = 0, ids = 0, handing_out = 0, queue_full = 0, tester_busy = 0, held_back = 0, results_full = 0,
                ahead = 0, undecided = 0, results = 0, parts = 0, shape_bytes = 0, shapes_taken = 0;

  static constexpr auto counters() {
    using C = DistributorCounts;
    return std::array{
        Counter{"packets", &C::packets, "packets", "packets whose rays were handed to the testers"},
        Counter{"ids", &C::ids, "rays", "ray IDs handed to them"},
        Counter{"handing_out", &C::handing_out, "cycles", "the distributor handed out ray IDs"},
        Counter{"queue_full", &C::queue_full, "cycles",
                "the distributor waited for a place in the queue of the tester whose ray was next"},
        Counter{"tester_busy", &C::tester_busy, "tester-cycles", "a tester had a ray, of all testers together"},
        Counter{"held_back", &C::held_back, "tester-cycles",
                "a tester could have begun a ray but for an older packet (testers.distributor.out_of_order)"},
        Counter{"results_full", &C::results_full, "tester-cycles",
                "a tester could have begun a ray but for its results, which waited for the decision point"},
        Counter{"ahead", &C::ahead, "rays", "rays whose tests began while an older packet was in test"},
        Counter{"undecided", &C::undecided, "result-cycles", "results waited for the decision point"},
        Counter{"results", &C::results, "results", "results that have gone on to collections or to shading"},
        Counter{"parts", &C::parts, "parts",
                "in which the results of packets went on; as many as packets, unless stragglers are forwarded"},
        Counter{"shape_bytes", &C::shape_bytes, "bytes", "shapes that went to the testers, once for all of them"},
        Counter{"shapes_taken", &C::shapes_taken, "bytes", "shapes that had come when the tests of a packet began",
                Shown::kNever},
    };
  }
  friend bool operator==(const DistributorCounts&, const DistributorCounts&) = default;
};

}  // namespace carousel
