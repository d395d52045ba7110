#include "ringbus/cycle/memory/dram/dram.h"

#include <algorithm>
#include <numeric>

namespace carousel::ringbus::cycle {

namespace {

constexpr std::uint64_t kPsPerUs = 1'000'000;  // a clock of one MHz has a period of so many picoseconds

}  // namespace

Dram::Dram(const DramConfig& config, std::int64_t clock_mhz)
    : timing_(dram_timing(config)), map_(config, timing_), clock_mhz_(static_cast<std::uint64_t>(clock_mhz)) {
  const std::uint64_t ps = static_cast<std::uint64_t>(timing_.period_ps) * clock_mhz_, common = std::gcd(ps, kPsPerUs);
  factor_ = ps / common;
  divisor_ = kPsPerUs / common;
  for (std::int64_t i = 0; i < config.channels; ++i)
    channels_.emplace_back(timing_, static_cast<std::size_t>(config.queue));
}

void Dram::push(std::uint64_t address, std::uint64_t bytes, bool write, std::uint64_t tag, DramCycle now) {
  constexpr std::uint64_t kUnit = DramTiming::kTransactionBytes;
  std::uint64_t index = transfers_.size();
  if (free_.empty()) {
    transfers_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  const std::uint64_t begin = address / kUnit, end = ceil_div(address + bytes, kUnit);
  transfers_[index] = {tag, static_cast<std::uint32_t>(end - begin)};
  for (std::uint64_t transaction = begin; transaction < end; ++transaction) {
    const DramPlace place = map_.place(transaction * kUnit);
    channels_[place.channel].push({place.bank, place.row, write, index}, now);
  }
}

DramCycle Dram::next() const {
  DramCycle first = kDramNever;
  for (const DramChannel& channel : channels_) first = std::min(first, channel.next());
  return first;
}

/// The channel whose step is next; null if none has one.
DramChannel* Dram::first() {
  DramChannel* out = nullptr;
  for (DramChannel& channel : channels_)
    if (channel.next() < (out == nullptr ? kDramNever : out->next())) out = &channel;
  return out;
}

void Dram::close(DramCycle end) {
  for (DramChannel& channel : channels_) channel.idle_until(end);
}

Cycle Dram::busy() const {
  const std::uint64_t cycles = ceil_div(served_ * static_cast<std::uint64_t>(timing_.ccd_short),
                                        channels_.size() * std::uint64_t{timing_.pseudo_channels});
  return engine_end(static_cast<DramCycle>(cycles));
}

double Dram::peak_bytes_per_cycle() const {
  return peak_bytes_per_second(timing_) * static_cast<double>(channels_.size()) /
         (1e6 * static_cast<double>(clock_mhz_));
}

std::uint64_t Dram::activations() const {
  std::uint64_t sum = 0;
  for (const DramChannel& channel : channels_) sum += channel.counts().row_misses + channel.counts().row_conflicts;
  return sum;
}

DramCycle Dram::last_taken() const {
  DramCycle last = 0;
  for (const DramChannel& channel : channels_) last = std::max(last, channel.last_taken());
  return last;
}

DramUse Dram::use(DramCycle cycles) const {
  DramUse out;
  out.cycles = static_cast<std::uint64_t>(cycles);
  out.period_ps = static_cast<std::uint64_t>(timing_.period_ps);
  out.peak_bytes_per_second = peak_bytes_per_second(timing_) * static_cast<double>(channels_.size());
  for (const DramChannel& channel : channels_) {
    const std::uint64_t transactions = channel.counts().reads + channel.counts().writes;
    out.channels.push_back({channel.counts(), channel.latencies(), transactions * DramTiming::kTransactionBytes,
                            cycles == 0
                                ? 0.0
                                : static_cast<double>(transactions) * static_cast<double>(timing_.ccd_short) /
                                      (static_cast<double>(timing_.pseudo_channels) * static_cast<double>(cycles))});
  }
  return out;
}

}  // namespace carousel::ringbus::cycle
