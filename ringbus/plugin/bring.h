#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/config/fields/collections.h"
#include "core/config/fields/graph.h"
#include "core/config/fields/queue_kind.h"
#include "core/config/fields/rays.h"
#include "core/config/fields/testers.h"
#include "core/config/fields/workload.h"
#include "core/plugin/plugin.h"
#include "core/types/dispatch_rule.h"
#include "core/types/prefetcher_offer.h"
#include "core/types/router_rule.h"
#include "core/types/workload_offer.h"
#include "ringbus/native/links/queue_link.h"
#include "ringbus/queues/queue_design.h"
#include "ringbus/rays/placement_rule.h"
#include "ringbus/resource/collections/issue_policy.h"
#include "ringbus/stress/queue_under_test.h"

// What a plugin calls to hand over its parts (docs/guides/plugins.md). Each has a name of a-z, 0-9 and _, which is new.

namespace carousel::ringbus {

/// A queue for links, for the way to shading and back, and for the laboratory: a template that satisfies LinkQueue, as
/// in bring_queue<MyQueue>(parts, "my_queue").
template <template <class> class Queue>
void bring_queue(PluginParts& parts, std::string name) {
  QueueDesign design;
  design.producers = Queue<PacketId>::kProducers;
  design.consumers = Queue<PacketId>::kConsumers;
  design.index = [](std::size_t capacity) -> std::unique_ptr<IndexQueue> {
    return std::make_unique<IndexQueueOf<Queue<std::uint32_t>>>(capacity);
  };
  design.plain_link = [](std::size_t depth, ResourceId from, ResourceId to) -> std::unique_ptr<Link> {
    return std::make_unique<QueueLink<Queue<PacketId>>>(depth, from, to);
  };
  design.link = make_queue_link<Queue>;
  design.under_test = stress::queue_under_test<Queue>;
  parts.add<QueueKind>(std::move(name), std::make_shared<QueueDesign>(design));
}

/// A policy of collections; `policy.policy` is ignored.
inline void bring_policy(PluginParts& parts, std::string name, const IssuePolicy& policy) {
  parts.add<Policy>(std::move(name), policy.bucket ? std::make_shared<IssuePolicy>(policy) : nullptr);
}

/// A dispatch of new rays.
inline void bring_placement(PluginParts& parts, std::string name, const PlacementRule& rule) {
  parts.add<Placement>(std::move(name), rule.choose ? std::make_shared<PlacementRule>(rule) : nullptr);
}

/// A router: the ways of packets through a drawn network.
inline void bring_router(PluginParts& parts, std::string name, const RouterRule& rule) {
  parts.add<Routing>(std::move(name), rule.choose ? std::make_shared<RouterRule>(rule) : nullptr);
}

/// A dispatch: the choice of a resource among the packets that wait.
inline void bring_dispatch(PluginParts& parts, std::string name, const DispatchRule& rule) {
  parts.add<Dispatch>(std::move(name), rule.choose ? std::make_shared<DispatchRule>(rule) : nullptr);
}

/// A workload with its options.
inline void bring_workload(PluginParts& parts, std::string name, WorkloadOffer offer) {
  const bool any = static_cast<bool>(offer.make);
  parts.add<OwnWorkload>(std::move(name), any ? std::make_shared<WorkloadOffer>(std::move(offer)) : nullptr);
}

/// A prefetcher: a part with a clock of its own. Both functions of the offer are needed.
inline void bring_prefetcher(PluginParts& parts, std::string name, PrefetcherOffer offer) {
  const bool any = offer.make && offer.table_bytes;
  parts.add<PrefetchRule>(std::move(name), any ? std::make_shared<PrefetcherOffer>(std::move(offer)) : nullptr);
}

}  // namespace carousel::ringbus
