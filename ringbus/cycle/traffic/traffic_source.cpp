#include "ringbus/cycle/traffic/traffic_source.h"

#include <string>

#include "core/config/graph/ring.h"

namespace carousel::ringbus::cycle {

namespace {

using Pattern = TrafficConfig::Pattern;

// The words of a packet: 0 and 1 the time since the last one, 2 chances, 3 the destination.
constexpr std::uint32_t kTrafficBlock = 0x74726166;

double unit(std::uint32_t word) {
  return word * 0x1p-32;
}

}  // namespace

// The gap is longer than g with the probability (1 - rate)^g, so it is one more than the longest g whose power is not
// less than a random number in (0, 1].

GeometricGap::GeometricGap(double rate) {
  double power = 1 - rate;
  for (double& p : powers_) {
    p = power;
    power *= power;
  }
  for (std::size_t i = 0; i < starts_.size(); ++i) {
    Start& start = starts_[i];
    const double size = static_cast<double>(starts_.size()), least = static_cast<double>(i) / size;
    descend(static_cast<double>(i + 1) / size, kPowers, start.power, start.gap);
    // The numbers of the first part have no common least but the smallest there is.
    const double reach = i == 0 ? 0x1p-53 : least;
    while (start.levels < kPowers && start.power * powers_[start.levels] >= reach) ++start.levels;
  }
}

void GeometricGap::descend(double least, std::size_t levels, double& power, Cycle& gap) const {
  for (std::size_t i = levels; i-- > 0;) {
    const double further = power * powers_[i];
    const bool take = further >= least;
    power = take ? further : power;
    gap += static_cast<Cycle>(take) << i;
  }
}

Cycle GeometricGap::operator()(std::uint64_t random) const {
  const Start& start = starts_[random >> (64 - kStartBits)];
  double power = start.power;
  Cycle gap = start.gap;
  descend((static_cast<double>(random >> 11) + 1) * 0x1p-53, start.levels, power, gap);
  return gap + 1;
}

GeometricGap traffic_gap(const TrafficConfig& config) {
  if (config.pattern != Pattern::kBursty) return GeometricGap(config.rate);
  // Bursts of B packets and silences of S cycles have the rate B / (B + S).
  return GeometricGap(config.rate / (static_cast<double>(config.burst_packets) * (1 - config.rate)));
}

TrafficEnds traffic_ends(const TopologyConfig& topology, const TrafficConfig& traffic) {
  std::string error;
  return {config::named_resources(topology, traffic.sources, error),
          config::named_resources(topology, traffic.destinations, error)};
}

TrafficSource::TrafficSource(const TrafficConfig& traffic, std::uint64_t seed, std::size_t resources,
                             const TrafficEnds& ends, ResourceId id, const GeometricGap& gap)
    : pattern_(traffic.pattern),
      seed_(seed),
      id_(id.value),
      resources_(static_cast<std::uint32_t>(resources)),
      hotspot_(static_cast<std::uint32_t>(traffic.hotspot)),
      chance_(pattern_ == Pattern::kBursty ? 1 / static_cast<double>(traffic.burst_packets) : traffic.hotspot_fraction),
      gap_(&gap),
      ends_(&ends) {}

void TrafficSource::advance() {
  words_ = random_block({seed_, id_, static_cast<std::uint32_t>(index_), static_cast<std::uint32_t>(index_ >> 32)},
                        kTrafficBlock);
  const bool silence = pattern_ != Pattern::kBursty || index_ == 0 || unit(words_[2]) < chance_;
  // After a burst's last packet come a silence of at least a cycle and the next one's first packet.
  const Cycle gap = silence ? (*gap_)(std::uint64_t{words_[0]} << 32 | words_[1]) : 0;
  created_ += pattern_ == Pattern::kBursty ? gap + 1 : gap;
  ++index_;
}

ResourceId TrafficSource::destination() const {
  switch (pattern_) {
    case Pattern::kTornado:
      return ResourceId((id_ + (resources_ + 1) / 2 - 1) % resources_);
    case Pattern::kNeighbour:
      return ResourceId((id_ + 1) % resources_);
    case Pattern::kHotspot:
      return unit(words_[2]) < chance_ ? hotspot_ : any();
    case Pattern::kExchange:
      return ResourceId(id_ ^ 1u);
    case Pattern::kUniform:
    case Pattern::kBursty:
      break;
  }
  return any();
}

}  // namespace carousel::ringbus::cycle
