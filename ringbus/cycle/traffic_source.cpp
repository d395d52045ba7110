#include "ringbus/cycle/traffic_source.h"

namespace carousel::ringbus::cycle {

namespace {

using Pattern = TrafficConfig::Pattern;

// The words of a packet: 0 and 1 the time since the last one, 2 chances, 3 the destination.
constexpr std::uint32_t kTrafficBlock = 0x74726166;

double unit(std::uint32_t word) { return word * 0x1p-32; }

/// Of the process that the gaps come from: every packet, or with bursts the ends of the silences.
double gap_rate(const TrafficConfig& config) {
  if (config.pattern != Pattern::kBursty) return config.rate;
  // Bursts of B packets and silences of S cycles have the rate B / (B + S).
  const double burst = static_cast<double>(config.burst_packets);
  return config.rate / (burst * (1 - config.rate));
}

}  // namespace

GeometricGap::GeometricGap(double rate) {
  double power = 1 - rate;
  do {
    powers_[used_++] = power;
    power *= power;
  } while (used_ < kPowers && power > 0x1p-66);
}

Cycle GeometricGap::operator()(std::uint64_t random) const {
  // The gap is longer than g with the probability (1 - rate)^g: the longest g whose power reaches a random number in
  // (0, 1] is found bit by bit.
  const double least = (static_cast<double>(random >> 11) + 1) * 0x1p-53;
  double reached = 1;
  Cycle gap = 0;
  for (std::size_t i = used_; i-- > 0;) {
    const double further = reached * powers_[i];
    const bool take = further >= least;
    reached = take ? further : reached;
    gap += static_cast<Cycle>(take) << i;
  }
  return gap + 1;
}

TrafficSource::TrafficSource(const TrafficConfig& config, std::uint64_t seed, ResourceId id, std::size_t resources)
    : pattern_(config.pattern),
      seed_(seed),
      id_(id.value),
      resources_(static_cast<std::uint32_t>(resources)),
      hotspot_(static_cast<std::uint32_t>(config.hotspot)),
      chance_(pattern_ == Pattern::kBursty ? 1 / static_cast<double>(config.burst_packets) : config.hotspot_fraction),
      gap_(gap_rate(config)) {}

void TrafficSource::advance() {
  words_ = random_block({seed_, id_, static_cast<std::uint32_t>(index_), static_cast<std::uint32_t>(index_ >> 32)},
                        kTrafficBlock);
  const bool silence = pattern_ != Pattern::kBursty || index_ == 0 || unit(words_[2]) < chance_;
  // After a burst's last packet come a silence of at least a cycle and the next one's first packet.
  const Cycle gap = silence ? gap_(std::uint64_t{words_[0]} << 32 | words_[1]) : 0;
  created_ += pattern_ == Pattern::kBursty ? gap + 1 : gap;
  ++index_;
}

ResourceId TrafficSource::destination() const {
  switch (pattern_) {
    case Pattern::kTornado: return ResourceId((id_ + (resources_ + 1) / 2 - 1) % resources_);
    case Pattern::kNeighbour: return ResourceId((id_ + 1) % resources_);
    case Pattern::kHotspot: return unit(words_[2]) < chance_ ? hotspot_ : any();
    case Pattern::kUniform:
    case Pattern::kBursty: break;
  }
  return any();
}

}  // namespace carousel::ringbus::cycle
