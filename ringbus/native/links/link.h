#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/config/config.h"
#include "core/statistics/link_fault_counts.h"
#include "core/types/ids.h"
#include "ringbus/packets/packet.h"
#include "ringbus/queues/link_queue.h"
#include "ringbus/results/link_statistics.h"
#include "ringbus/results/occupancy_series.h"

namespace carousel::ringbus {

/// A bounded one-way queue between two neighbours. One thread sends and one receives.
class Link {
 public:
  Link(ResourceId from, ResourceId to) : from_(from), to_(to) {}
  virtual ~Link() = default;

  /// Sends a prefix of `packets`; returns its length.
  std::size_t try_send(std::span<const PacketId> packets) {
    const std::size_t sent = push(packets);
    if (!counts_) return sent;
    sending_.packets += sent;
    sending_.refusals += packets.size() - sent;
    if (sent < packets.size()) {
      ++sending_.full_stalls;
      sending_.occupancy_max = capacity();
    }
    if (sent > 0 && sending_.batches++ % kSendsASample == 0) sample();
    return sent;
  }
  /// Fills a prefix of `packets`; returns its length.
  std::size_t try_receive(std::span<PacketId> packets) {
    const std::size_t count = pull(packets);
    if (!counts_) return count;
    receiving_.receives += count > 0;
    receiving_.empty_stalls += count == 0;
    return count;
  }
  /// Sender only: how many packets a send would surely take.
  virtual std::size_t free_places() = 0;
  virtual std::size_t capacity() const = 0;
  /// Sender only: lets a link do work of its own (see ReliableLink). Returns whether anything moved.
  virtual bool tick() { return false; }
  /// Receiver only: likewise, also when it receives nothing at present.
  virtual void tick_receiver() {}

  ResourceId from() const { return from_; }
  ResourceId to() const { return to_; }
  /// Off: nothing is counted. Before the first send.
  void count(bool on) { counts_ = on; }
  LinkStatistics statistics() const {
    LinkStatistics s = sending_;
    s.receives = receiving_.receives;
    s.empty_stalls = receiving_.empty_stalls;
    return s;
  }
  /// The occupancy seen at samples.
  const OccupancySeries& series() const { return series_; }
  /// Counts of faults; zero on a link that has none.
  virtual LinkFaultCounts faults() const { return {}; }

 private:
  virtual std::size_t push(std::span<const PacketId> packets) = 0;
  virtual std::size_t pull(std::span<PacketId> packets) = 0;

  // To ask how full the queue is takes a cache line from the receiver; at every send that was up to 4 % of a run.
  static constexpr std::uint64_t kSendsASample = 8;
  void sample() {
    const std::uint64_t occupancy = capacity() - free_places();
    sending_.occupancy_max = std::max(sending_.occupancy_max, occupancy);
    sending_.occupancy_sum += occupancy;
    ++sending_.samples;
    series_.add(occupancy);
  }

  ResourceId from_, to_;
  bool counts_ = true;
  // Each end writes its own counts. On one cache line the two ends would take it from each other.
  alignas(128) LinkStatistics sending_;
  OccupancySeries series_;
  struct alignas(128) Receiving {
    std::uint64_t receives = 0, empty_stalls = 0;
  } receiving_;
};

/// A link whose queue is of the kind the configuration names.
std::unique_ptr<Link> make_link(QueueKind kind, std::size_t depth, ResourceId from, ResourceId to);
/// The `number`-th link of a configuration, which may have faults; it then carries copies of `packets` (ReliableLink).
std::unique_ptr<Link> make_link(const Config& config, std::uint64_t number, ResourceId from, ResourceId to,
                                std::span<Packet> packets = {});

/// Tells whether queues of a kind serve so many producers and consumers at a time.
bool queue_fits(QueueKind kind, Parties producers, Parties consumers);
/// Throws a ConfigError at `key` that lists the fitting kinds when this one does not fit.
void require_parties(QueueKind kind, const std::string& key, Parties producers, Parties consumers);

}  // namespace carousel::ringbus
