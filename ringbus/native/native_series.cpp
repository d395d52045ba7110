#include "ringbus/native/native_series.h"

#include <algorithm>
#include <span>
#include <string>

#include <fmt/format.h>

namespace carousel::ringbus {

namespace {

using Kind = SeriesRow::Kind;

constexpr std::size_t kPerResource = 3;    // visits, and then, summed over time, held and packets
constexpr std::size_t kFirstResource = 2;  // after completed, and, summed over time, under way

}  // namespace

NativeSeries::NativeSeries(std::size_t wanted, const Config& config)
    : resources_(static_cast<std::size_t>(config.topology.resources)),
      slots_(static_cast<std::size_t>(config.rays.slots_per_resource)),
      carried_(resources_) {
  const std::size_t counters = kFirstResource + kPerResource * resources_;
  samples_ = CounterSamples(most_samples(wanted, counters + 2), counters,
                            std::chrono::duration_cast<std::chrono::microseconds>(kPollInterval).count());
  last_.resize(counters);
  levels_.resize(counters);
}

void NativeSeries::look(std::chrono::nanoseconds since_start, const RayCount& count, const RayControl& control,
                        const Ports& ports) {
  if (!on()) return;
  const std::int64_t now = std::chrono::duration_cast<std::chrono::microseconds>(since_start).count();
  before_ = last_;
  before_at_ = last_at_;
  last_at_ = std::max(static_cast<CounterSamples::Time>(now), before_at_);
  const auto level = [&](std::size_t counter, std::uint64_t value) {
    last_[counter] += levels_[counter] * (last_at_ - before_at_);
    levels_[counter] = value;
  };
  // Relaxed: they are drawn over time.
  last_[0] = count.completed.load(std::memory_order_relaxed);
  const std::int64_t outstanding = count.outstanding.load(std::memory_order_relaxed);
  level(1, static_cast<std::uint64_t>(std::max<std::int64_t>(0, outstanding)));
  for (std::uint32_t r = 0; r < resources_; ++r) {
    const std::size_t first = kFirstResource + kPerResource * r;
    last_[first] = carried_[r] + ports[r]->visits();
    level(first + 1, slots_ - std::min(slots_, control.free_slots(ResourceId(r))));
    level(first + 2, ports[r]->packets_out());
  }
  samples_.until(last_at_, [&](CounterSamples::Time at, std::span<std::uint64_t> row) {
    const double part = static_cast<double>(at - before_at_) / static_cast<double>(last_at_ - before_at_);
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] = before_[i] + static_cast<std::uint64_t>(part * static_cast<double>(last_[i] - before_[i]));
  });
}

void NativeSeries::carry(const Ports& ports) {
  for (std::size_t r = 0; r < resources_; ++r) carried_[r] += ports[r]->visits();
}

TimeSeries NativeSeries::finish() {
  samples_.close(last_at_, [&](CounterSamples::Time, std::span<std::uint64_t> row) {
    std::copy(last_.begin(), last_.end(), row.begin());
  });
  TimeSeries out{"seconds", static_cast<double>(samples_.interval()) * 1e-6,
                 (samples_.end() + samples_.interval() - 1) / samples_.interval()};
  const auto add = [&](SeriesRow&& row, const std::vector<std::size_t>& counters) {
    std::vector<std::uint64_t> sums(out.samples);
    for (const std::size_t counter : counters) samples_.add_to(sums, samples_.interval(), counter);
    const double by = row.kind == Kind::kMean ? static_cast<double>(samples_.interval()) : 1;
    for (const std::uint64_t sum : sums) row.values.push_back(static_cast<double>(sum) / by);
    out.add(std::move(row));
  };
  add({"machine", "rays completed", "rays", Kind::kSum}, {0});
  add({"machine", "rays under way", "rays", Kind::kMean}, {1});
  std::vector<std::size_t> held, packets;
  for (std::size_t r = 0; r < resources_; ++r) {
    held.push_back(kFirstResource + kPerResource * r + 1);
    packets.push_back(held.back() + 1);
  }
  add({"machine", "rays held", "rays", Kind::kMean}, held);
  add({"machine", "packets under way", "packets", Kind::kMean}, packets);
  for (std::size_t r = 0; r < resources_; ++r) {
    const std::string part = fmt::format("resource {}", r);
    const std::size_t first = kFirstResource + kPerResource * r;
    add({part, "visits", "visits", Kind::kSum}, {first});
    add({part, "rays held", "rays", Kind::kMean}, {first + 1});
    add({part, "packets under way", "packets", Kind::kMean}, {first + 2});
  }
  return out;
}

}  // namespace carousel::ringbus
