#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/statistics/counters.h"

namespace carousel {

/// Bytes of a hit in a buffer: distance, where on the primitive, instance and primitive.
inline constexpr std::uint64_t kBufferedHitBytes = 20;
/// Bytes of the light from Gaussians beside a record: three colours, and the share of the light behind them.
inline constexpr std::uint64_t kBlendedLightBytes = 16;

/// The cost of looking for several nearest hits. docs/how-it-works/nearest.md says what each step is.
struct NearestCounts {
  std::uint64_t rays = 0, hits = 0, offered = 0, inserted = 0, evicted = 0, rounds = 0, strays = 0;
  std::uint64_t responses = 0, color_terms = 0, blended = 0;
  std::uint64_t read_bytes = 0, written_bytes = 0;
  std::uint64_t waiting_nodes = 0, waiting_hits = 0, waiting_bytes = 0, waiting_peak_bytes = 0;

  /// All bytes that buffers, and what is set aside for them, have cost.
  std::uint64_t moved_bytes() const { return read_bytes + written_bytes + waiting_bytes; }

  static constexpr auto counters() {
    using C = NearestCounts;
    return std::array{
        Counter{"rays", &C::rays, "rays", "completed rays that looked for several hits"},
        Counter{"hits", &C::hits, "hits", "hits that they have found in the end"},
        Counter{"offered", &C::offered, "hits", "hits that tests have offered to the buffers"},
        Counter{"inserted", &C::inserted, "hits", "those that were put into a buffer"},
        Counter{"evicted", &C::evicted, "hits", "hits that nearer ones have pushed out of a full buffer"},
        Counter{"rounds", &C::rounds, "rounds", "rounds of all rays; at least one a ray"},
        Counter{"strays", &C::strays, "rays",
                "rays that met a hit behind the end of its box, whose further rounds leave nothing out"},
        Counter{"responses", &C::responses, "Gaussians", "Gaussians whose greatest response along a ray was computed"},
        Counter{"color_terms", &C::color_terms, "coefficients",
                "coefficients of harmonics above degree 0, in three channels, of those that the ray met; a direction "
                "that is turned counts as three"},
        Counter{"blended", &C::blended, "Gaussians", "those that gave light to a ray, until it was opaque"},
        Counter{"read_bytes", &C::read_bytes, "bytes", "bytes read from the buffers"},
        Counter{"written_bytes", &C::written_bytes, "bytes", "bytes written to the buffers"},
        Counter{"waiting_nodes", &C::waiting_nodes, "nodes",
                "nodes that were set aside for a later round, with rounds: resume"},
        Counter{"waiting_hits", &C::waiting_hits, "hits", "hits that were set aside likewise"},
        Counter{"waiting_bytes", &C::waiting_bytes, "bytes", "bytes of both that were set aside and taken back"},
        Counter{"waiting_peak_bytes", &C::waiting_peak_bytes, "bytes", "the most that one ray had set aside at a time"},
    };
  }
  friend bool operator==(const NearestCounts&, const NearestCounts&) = default;
};

/// The rays that began a round of this number, and the nodes and leaves that they were tested against in it.
struct RoundVisits {
  std::uint64_t rays = 0, visits = 0;
  friend bool operator==(const RoundVisits&, const RoundVisits&) = default;
};

/// These counts of some rays. A peak is the greatest, not a sum.
struct NearestUse {
  NearestCounts counts;
  std::vector<RoundVisits> rounds;  ///< the first round first

  NearestUse& operator+=(const NearestUse& other) {
    const std::uint64_t peak = std::max(counts.waiting_peak_bytes, other.counts.waiting_peak_bytes);
    counts += other.counts;
    counts.waiting_peak_bytes = peak;
    rounds.resize(std::max(rounds.size(), other.rounds.size()));
    for (std::size_t i = 0; i < other.rounds.size(); ++i) {
      rounds[i].rays += other.rounds[i].rays;
      rounds[i].visits += other.rounds[i].visits;
    }
    return *this;
  }
  friend bool operator==(const NearestUse&, const NearestUse&) = default;
};

}  // namespace carousel
