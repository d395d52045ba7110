#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/config/fields/topology.h"
#include "core/config/fields/workload.h"
#include "core/numeric/rng.h"
#include "core/types/ids.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The cycles from one event to the next of a process that has one in each cycle with probability `rate`: a
/// geometric distribution. Products only, no logarithm, whose last bit differs between machines.
class GeometricGap {
 public:
  explicit GeometricGap(double rate);
  /// At least 1; `random`: 64 random bits.
  Cycle operator()(std::uint64_t random) const;

 private:
  static constexpr std::size_t kPowers = 40;
  static constexpr int kStartBits = 8;
  /// The start of the search for the gap of a random number, by its first bits.
  struct Start {
    double power = 1;  // (1 - rate) to the power of `gap`: not less than any such number
    Cycle gap = 0;
    std::size_t levels = 0;  // powers_ that can lead from there to one of these numbers
  };
  void descend(double least, std::size_t levels, double& power, Cycle& gap) const;

  std::array<double, kPowers> powers_{};  // probability of no event in 2^i cycles
  std::array<Start, std::size_t{1} << kStartBits> starts_;
};

/// The gaps between the packets of one source; with bursts, the silences between bursts.
GeometricGap traffic_gap(const TrafficConfig& config);

/// The resources that create packets, and those to which packets without a destination of their own go.
struct TrafficEnds {
  std::vector<std::uint32_t> sources, destinations;
};
TrafficEnds traffic_ends(const TopologyConfig& topology, const TrafficConfig& traffic);

/// The packets that one resource creates: their times and destinations. It knows nothing of the network, so the packets
/// are the same in every network.
///   uniform    to any resource of the destinations, the source included
///   tornado    almost half way round: (k + 1) / 2 - 1 on, of k (as BookSim2's)
///   neighbour  to the next one
///   hotspot    with `hotspot_fraction` to one resource, else uniform
///   bursty     uniform; packets are created cycle after cycle, then none for a while: a two-state Markov chain (as
///              BookSim2's on/off process with a rate of 1 when on)
///   exchange   resources 2 i and 2 i + 1 to each other
class TrafficSource {
 public:
  /// `gap` is that of traffic_gap(). All sources share it and `ends`, which must outlive them.
  TrafficSource(const TrafficConfig& traffic, std::uint64_t seed, std::size_t resources, const TrafficEnds& ends,
                ResourceId id, const GeometricGap& gap);

  /// Creates the next packet.
  void advance();
  /// When it was created; at least 1, and every packet later than the one before.
  Cycle created() const { return created_; }
  ResourceId destination() const;
  /// A random number of the packet's own, for a choice between equally short ways.
  std::uint32_t random() const { return words_[2]; }

 private:
  ResourceId any() const {
    const std::vector<std::uint32_t>& to = ends_->destinations;
    return ResourceId(to[(std::uint64_t{words_[3]} * to.size()) >> 32]);
  }

  TrafficConfig::Pattern pattern_;
  std::uint64_t seed_;
  std::uint32_t id_, resources_;
  ResourceId hotspot_;
  double chance_;  // bursty: that a burst ends; hotspot: that a packet goes there
  const GeometricGap* gap_;
  const TrafficEnds* ends_;
  std::uint64_t index_ = 0;
  PhiloxCounter words_{};
  Cycle created_ = 0;
};

}  // namespace carousel::ringbus::cycle
