#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/config.h"
#include "core/ids.h"
#include "ringbus/queues/link_queue.h"
#include "ringbus/packet.h"

namespace carousel::ringbus {

/// What a link's sender saw of it. Kept by the sending resource's thread; read when the engine has stopped.
struct LinkStatistics {
  std::uint64_t packets = 0;         ///< sent
  std::uint64_t refusals = 0;        ///< sends the full queue refused, in packets and attempts
  std::uint64_t occupancy_max = 0;   ///< packets waiting, seen at sends
  std::uint64_t occupancy_sum = 0;   ///< over `samples`
  std::uint64_t samples = 0;
};

/// A bounded one-way queue between two neighbours. One thread sends and one receives.
class Link {
 public:
  Link(ResourceId from, ResourceId to) : from_(from), to_(to) {}
  virtual ~Link() = default;

  /// Sends a prefix of `packets`; returns its length.
  std::size_t try_send(std::span<const PacketId> packets) {
    const std::size_t sent = push(packets);
    statistics_.packets += sent;
    statistics_.refusals += packets.size() - sent;
    if (sent > 0) {
      const std::uint64_t occupancy = capacity() - free_places();
      statistics_.occupancy_max = std::max(statistics_.occupancy_max, occupancy);
      statistics_.occupancy_sum += occupancy;
      ++statistics_.samples;
    }
    return sent;
  }
  /// Fills a prefix of `packets`; returns its length.
  virtual std::size_t try_receive(std::span<PacketId> packets) = 0;
  /// Sender only: how many packets a send would surely take.
  virtual std::size_t free_places() = 0;
  virtual std::size_t capacity() const = 0;

  ResourceId from() const { return from_; }
  ResourceId to() const { return to_; }
  const LinkStatistics& statistics() const { return statistics_; }

 private:
  virtual std::size_t push(std::span<const PacketId> packets) = 0;

  ResourceId from_, to_;
  LinkStatistics statistics_;
};

/// A link whose queue is of the kind the configuration names.
std::unique_ptr<Link> make_link(QueueKind kind, std::size_t depth, ResourceId from, ResourceId to);

/// Whether queues of a kind serve so many producers and consumers at a time.
bool queue_fits(QueueKind kind, Parties producers, Parties consumers);
/// Throws a ConfigError at `key` that lists the kinds that do when this one does not.
void require_parties(QueueKind kind, const std::string& key, Parties producers, Parties consumers);

}  // namespace carousel::ringbus
