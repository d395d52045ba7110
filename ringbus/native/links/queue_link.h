#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "core/config/config.h"
#include "ringbus/native/links/link.h"
#include "ringbus/native/links/reliable_link.h"
#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// A link that is a queue of one design.
template <class Queue>
class QueueLink final : public Link {
  static_assert(LinkQueue<Queue, PacketId>);

 public:
  QueueLink(std::size_t depth, ResourceId from, ResourceId to) : Link(from, to), queue_(depth) {}
  std::size_t free_places() override { return queue_.free_places(); }
  std::size_t capacity() const override { return queue_.capacity(); }

 private:
  std::size_t push(std::span<const PacketId> packets) override { return queue_.try_push_n(packets); }
  std::size_t pull(std::span<PacketId> packets) override { return queue_.try_pop_n(packets); }
  Queue queue_;
};

/// Makes the `number`-th link of a configuration. With faults it carries copies of `packets` (ReliableLink).
using LinkMaker = std::function<std::unique_ptr<Link>(const Config& config, std::uint64_t number, ResourceId from,
                                                      ResourceId to, std::span<Packet> packets)>;

/// A LinkMaker for any template that satisfies LinkQueue: make_queue_link<MyQueue>. `topology.link.queue` is ignored.
template <template <class> class Queue>
std::unique_ptr<Link> make_queue_link(const Config& config, std::uint64_t number, ResourceId from, ResourceId to,
                                      std::span<Packet> packets) {
  const LinkConfig& link = config.topology.link;
  if (!config.faults.links.any())
    return std::make_unique<QueueLink<Queue<PacketId>>>(static_cast<std::size_t>(link.depth), from, to);
  return std::make_unique<ReliableLink<Queue>>(reliable_link_settings(link, config.faults, config.engine.clock_mhz),
                                               number, from, to, packets);
}

}  // namespace carousel::ringbus
