#include "ringbus/cycle/traffic/source_queues.h"

#include <utility>

namespace carousel::ringbus::cycle {

SourceQueues::SourceQueues(ResourceId id, const Topology& topology, const TrafficNodeSettings& settings,
                           TrafficSource source, std::uint64_t packets, TrafficWindow window, std::size_t ways)
    : topology_(topology),
      id_(id),
      ways_(ways),
      flits_(settings.flits),
      inject_cycles_(settings.inject_cycles),
      window_begin_(window.begin),
      queues_(settings.shared_queue ? 1 : ways + 1, {std::move(source), packets}) {
  for (Queue& queue : queues_) {
    create(queue);
    due_ = std::min(due_, queue.due);
  }
}

void SourceQueues::create(Queue& queue) {
  constexpr int kAhead = 64;  // packets of other queues that it reads past before they have been created
  look_at_next(queue);
  for (int i = 0; i < kAhead && queue.waiting && !queue.mine; ++i) look_at_next(queue);
  queue.due = !queue.waiting ? kNever : queue.mine ? queue.ready : queue.source.created();
}

void SourceQueues::look_at_next(Queue& queue) {
  queue.waiting = queue.to_create > 0;
  if (!queue.waiting) return;
  --queue.to_create;
  queue.source.advance();
  const ResourceId to = queue.source.destination();
  queue.route = topology_.route(id_, to, queue.source.random());
  queue.exit = topology_.direct() ? topology_.out_port_to(id_, to) : queue.route.direction;
  queue.mine = queues_.size() == 1 ||
               static_cast<std::size_t>(&queue - queues_.data()) == (queue.route.hops == 0 ? ways_ : queue.exit);
  if (!queue.mine) return;
  queue.ready = std::max(queue.source.created() + inject_cycles_, queue.free);
  if (queue.source.created() < window_begin_) return;
  ++offered_;
  routers_ += queue.route.hops + 1u;
}

std::uint64_t SourceQueues::left() const {
  std::uint64_t left = 0;
  for (const Queue& queue : queues_)
    if (queue.waiting) left = std::max(left, queue.to_create + 1);
  return left;
}

}  // namespace carousel::ringbus::cycle
