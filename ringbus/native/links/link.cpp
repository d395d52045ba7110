#include "ringbus/native/links/link.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/config.h"
#include "core/system/error.h"
#include "core/types/added_names.h"
#include "ringbus/native/links/queue_link.h"
#include "ringbus/queues/queue_design.h"
#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus {

std::unique_ptr<Link> make_link(QueueKind kind, std::size_t depth, ResourceId from, ResourceId to) {
  if (const auto* own = added_body<QueueDesign>(kind)) return own->plain_link(depth, from, to);
  return with_queue_type(kind, [&](auto type) -> std::unique_ptr<Link> {
    return std::make_unique<QueueLink<typename decltype(type)::template Of<PacketId>>>(depth, from, to);
  });
}

std::unique_ptr<Link> make_link(const Config& config, std::uint64_t number, ResourceId from, ResourceId to,
                                std::span<Packet> packets) {
  if (const auto* own = added_body<QueueDesign>(config.topology.link.queue))
    return own->link(config, number, from, to, packets);
  return with_queue_type(config.topology.link.queue, [&](auto type) {
    return make_queue_link<decltype(type)::template Of>(config, number, from, to, packets);
  });
}

namespace {

std::pair<Parties, Parties> parties_of(QueueKind kind) {
  if (const auto* own = added_body<QueueDesign>(kind)) return {own->producers, own->consumers};
  return with_queue_type(kind, [](auto type) {
    using Queue = typename decltype(type)::template Of<PacketId>;
    return std::pair<Parties, Parties>(Queue::kProducers, Queue::kConsumers);
  });
}

}  // namespace

void require_parties(QueueKind kind, const std::string& key, Parties producers, Parties consumers) {
  if (queue_fits(kind, producers, consumers)) return;
  const bool too_many_producers = producers == Parties::kMany && parties_of(kind).first == Parties::kOne;
  std::vector<std::string> fitting;
  for (const auto& [name, value] : all_named_values<QueueKind>())
    if (queue_fits(value, producers, consumers)) fitting.push_back(name);
  throw ConfigError(
      key, fmt::format("{} is made for one {} at a time and here are several; expected one of {}", enum_name(kind),
                       too_many_producers ? "producer" : "consumer", fmt::join(fitting, ", ")));
}

bool queue_fits(QueueKind kind, Parties producers, Parties consumers) {
  const auto [most_producers, most_consumers] = parties_of(kind);
  return (producers == Parties::kOne || most_producers == Parties::kMany) &&
         (consumers == Parties::kOne || most_consumers == Parties::kMany);
}

}  // namespace carousel::ringbus
