#include "ringbus/native/links/link.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/config/config.h"
#include "core/system/error.h"
#include "core/types/enum_names.h"
#include "ringbus/native/links/queue_link.h"
#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus {

std::unique_ptr<Link> make_link(QueueKind kind, std::size_t depth, ResourceId from, ResourceId to) {
  return with_queue_type(kind, [&](auto type) -> std::unique_ptr<Link> {
    return std::make_unique<QueueLink<typename decltype(type)::template Of<PacketId>>>(depth, from, to);
  });
}

std::unique_ptr<Link> make_link(const Config& config, std::uint64_t number, ResourceId from, ResourceId to,
                                std::span<Packet> packets) {
  return with_queue_type(config.topology.link.queue, [&](auto type) {
    return make_queue_link<decltype(type)::template Of>(config, number, from, to, packets);
  });
}

void require_parties(QueueKind kind, const std::string& key, Parties producers, Parties consumers) {
  with_queue_type(kind, [&](auto type) {
    using Queue = typename decltype(type)::template Of<PacketId>;
    const auto refuse = [&](const char* who) {
      std::vector<std::string_view> fitting;
      for (const auto& entry : kEnumNames<QueueKind>)
        if (queue_fits(entry.value, producers, consumers)) fitting.push_back(entry.name);
      throw ConfigError(key, fmt::format("{} is made for one {} at a time and here are several; expected one of {}",
                                         enum_name(kind), who, fmt::join(fitting, ", ")));
    };
    if (producers == Parties::kMany && Queue::kProducers == Parties::kOne) refuse("producer");
    if (consumers == Parties::kMany && Queue::kConsumers == Parties::kOne) refuse("consumer");
  });
}

bool queue_fits(QueueKind kind, Parties producers, Parties consumers) {
  return with_queue_type(kind, [&](auto type) {
    using Queue = typename decltype(type)::template Of<PacketId>;
    return (producers == Parties::kOne || Queue::kProducers == Parties::kMany) &&
           (consumers == Parties::kOne || Queue::kConsumers == Parties::kMany);
  });
}

}  // namespace carousel::ringbus
