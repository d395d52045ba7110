#pragma once

#include <string>
#include <vector>

#include "core/types/nearest_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// Rounds of one number.
struct NearestRound {
  std::uint64_t round = 0;
  RoundVisits visits;
};

template <class V>
void describe(V& v, const NearestRound& r) {
  v.field("round", r.round, "round", "the number of the round; 0 is the first");
  v.field("rays", r.visits.rays, "rays", "rays that had such a round");
  v.field("visits", r.visits.visits, "nodes", "tests of a ray against the shapes of a node or a leaf in it");
}

/// The section says what rays that look for several nearest hits have found, and its cost.
struct Nearest {
  std::uint64_t nearest = 0, buffer = 0, visits = 0, buffer_bytes = 0;
  NearestCounts counts;
  std::vector<NearestRound> rounds;
  std::string digest;
};

template <class V>
void describe(V& v, const Nearest& r) {
  v.field("nearest", r.nearest, "hits", "hits that a ray looks for");
  v.field("buffer", r.buffer, "hits", "hits that its buffer holds at once");
  v.field("buffer_bytes", r.buffer_bytes, "bytes", "bytes of the buffers of all slots");
  v.field("hits_per_ray", ratio(r.counts.hits, r.counts.rays), "hits/ray", "hits of such a ray in the mean");
  v.field("visits", r.visits, "nodes", "tests of such a ray against the shapes of a node or a leaf, in all rounds");
  describe(v, r.counts);
  v.section("by_round", r.rounds, "each round");
  v.field("digest", r.digest, "",
          "128 bits over all their hits, by the bits of the ray and the rank of the hit, in any order of rays. Hits of "
          "Gaussians are not in it: they are blended, and the digest of the picture tells of them");
}

}  // namespace carousel::report
