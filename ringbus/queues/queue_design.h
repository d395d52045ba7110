#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/types/ids.h"
#include "ringbus/queues/index_queue.h"
#include "ringbus/queues/link_queue.h"

namespace carousel {
struct Config;
}

namespace carousel::ringbus {

class Link;
struct Packet;
namespace stress {
struct QueueUnderTest;
}

/// A design of queue that a plugin brings: a LinkQueue (link_queue.h), which the program knows by what makes one for
/// each of its places. ringbus/plugin/bring.h fills it in from the queue's template.
struct QueueDesign {
  Parties producers = Parties::kOne, consumers = Parties::kOne;
  std::unique_ptr<IndexQueue> (*index)(std::size_t capacity) = nullptr;
  std::unique_ptr<Link> (*plain_link)(std::size_t depth, ResourceId from, ResourceId to) = nullptr;
  /// As a LinkMaker (ringbus/native/links/queue_link.h).
  std::unique_ptr<Link> (*link)(const Config& config, std::uint64_t number, ResourceId from, ResourceId to,
                                std::span<Packet> packets) = nullptr;
  stress::QueueUnderTest (*under_test)(std::string name) = nullptr;
};

}  // namespace carousel::ringbus
