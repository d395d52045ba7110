#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>

#include "ringbus/results/counter_samples.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus::cycle {

/// The time of a link on which parcels travel: one behind the other without a gap, in the order in which they come, as
/// many in a cycle as fit into the link's width. A packet begins and ends with a cycle.
///
/// Cycles are those of the link's clock, but for what is counted of it, which is told in cycles of the resources.
class LinkTime {
 public:
  explicit LinkTime(std::uint64_t bytes_per_cycle, const ClockRatio& from_core = {})
      : width_(bytes_per_cycle), from_core_(from_core) {}

  /// What is read over time, at most so often, from now on.
  enum class Counter : std::uint8_t { kBusy, kBytes, kEnd };
  void sample(std::size_t most) { samples_ = CounterSamples(most, static_cast<std::size_t>(Counter::kEnd)); }
  void close(Cycle end) {
    samples_.close(end, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  }
  const CounterSamples& samples() const { return samples_; }

  /// The cycles in which the first and the last byte of something leave.
  struct Passage {
    Cycle head = 0, tail = 0;
  };
  /// A parcel of `bytes` may leave at `ready`, not before any that came earlier.
  Passage parcel(std::uint64_t bytes, Cycle ready) {
    look_at(ready);
    const std::uint64_t begin = std::max(taken_, ready * width_);
    taken_ = begin + std::max<std::uint64_t>(1, bytes);
    bytes_ += bytes;
    ++parcels_;
    note(begin, ready);
    return {begin / width_, ceil_div(taken_, width_) - 1};
  }
  /// Likewise for a packet that occupies the link for so many cycles. Returns the cycle in which it begins.
  Cycle packet(Cycle cycles, Cycle ready) {
    look_at(ready);
    const Cycle begin = std::max(ceil_div(taken_, width_), ready);
    taken_ = (begin + cycles) * width_;
    note(begin * width_, ready);
    return begin;
  }

  std::uint64_t parcels() const { return parcels_; }
  std::uint64_t bytes() const { return bytes_; }  ///< of parcels
  /// Cycles before `end` in which the link moved something; not before the last of it began.
  Cycle busy(Cycle end = kNever) const {
    if (from_core_.equal()) return moved(end);
    if (end == kNever) return from_core_.before(moved(end));
    const Cycle edge = from_core_.floor_to_network(end), ended = moved(edge);
    return from_core_.part_before(ended, moved(edge + 1) > ended, end);
  }
  /// What waited for the link.
  Occupancy queue() const { return {from_core_.before(queue_.packet_cycles), queue_.most}; }

 private:
  /// To be called before anything happens at `now`.
  void look_at(Cycle now) {
    if (!from_core_.equal()) [[unlikely]]
      now = from_core_.before(now);
    if (samples_.due(now)) [[unlikely]]
      samples_.until(now, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  }
  void read(Cycle at, std::span<std::uint64_t> row) const {
    row[static_cast<std::size_t>(Counter::kBusy)] = busy(at);
    row[static_cast<std::size_t>(Counter::kBytes)] = bytes_;
  }
  /// As busy(), by the link's clock.
  Cycle moved(Cycle end) const { return busy_to_ <= end ? busy_ : busy_ - std::min(busy_, busy_to_ - end); }
  void note(std::uint64_t begin, Cycle ready) {
    const Cycle first = begin / width_, end = ceil_div(taken_, width_);
    busy_ += end - std::min(end, std::max(first, busy_to_));
    busy_to_ = end;
    while (!waiting_.empty() && waiting_.front() <= ready) waiting_.pop_front();
    if (first <= ready) return;
    queue_.packet_cycles += first - ready;
    waiting_.push_back(first);
    queue_.most = std::max<std::uint64_t>(queue_.most, waiting_.size());
  }

  std::uint64_t width_;
  ClockRatio from_core_;
  std::uint64_t taken_ = 0;  // up to this byte of time, of which a cycle has width_
  std::uint64_t parcels_ = 0, bytes_ = 0;
  Cycle busy_ = 0, busy_to_ = 0;
  std::deque<Cycle> waiting_;  // when those that wait begin
  Occupancy queue_;
  CounterSamples samples_;
};

}  // namespace carousel::ringbus::cycle
