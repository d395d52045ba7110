#include "ringbus/native/link.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/config/config.h"
#include "core/system/error.h"
#include "core/types/enum_names.h"
#include "ringbus/native/reliable_link.h"
#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus {

namespace {

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

}  // namespace

std::unique_ptr<Link> make_link(QueueKind kind, std::size_t depth, ResourceId from, ResourceId to) {
  return with_queue_type(kind, [&](auto type) -> std::unique_ptr<Link> {
    return std::make_unique<QueueLink<typename decltype(type)::template Of<PacketId>>>(depth, from, to);
  });
}

std::unique_ptr<Link> make_link(const Config& config, std::uint64_t number, ResourceId from, ResourceId to,
                                std::span<Packet> packets) {
  const LinkConfig& link = config.topology.link;
  if (!config.faults.links.any()) return make_link(link.queue, static_cast<std::size_t>(link.depth), from, to);
  const ReliableLinkSettings settings = reliable_link_settings(link, config.faults, config.engine.clock_mhz);
  return with_queue_type(link.queue, [&](auto type) -> std::unique_ptr<Link> {
    return std::make_unique<ReliableLink<decltype(type)::template Of>>(settings, number, from, to, packets);
  });
}

void require_parties(QueueKind kind, const std::string& key, Parties producers, Parties consumers) {
  with_queue_type(kind, [&](auto type) {
    using Queue = typename decltype(type)::template Of<PacketId>;
    const auto refuse = [&](const char* who) {
      std::vector<std::string_view> fitting;
      for (const auto& entry : kEnumNames<QueueKind>)
        if (queue_fits(entry.value, producers, consumers)) fitting.push_back(entry.name);
      ConfigIssue issue;
      issue.key_path = key;
      issue.message = fmt::format("{} is made for one {} at a time and here are several; expected one of {}",
                                  enum_name(kind), who, fmt::join(fitting, ", "));
      throw ConfigError({issue});
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
