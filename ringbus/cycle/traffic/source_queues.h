#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ringbus/cycle/traffic/traffic_plan.h"
#include "ringbus/cycle/traffic/traffic_settings.h"
#include "ringbus/cycle/traffic/traffic_source.h"
#include "ringbus/time/clock.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// The queues of a node's source: one, or one for each way out and one for packets that stay here. A queue has no bound
/// and is first in, first out, and one flit a cycle leaves it.
class SourceQueues {
 public:
  /// The source as one queue sees it: it reads on to the next packet that is its own. All queues read the same packets,
  /// so none of them has to be stored.
  struct Queue {
    TrafficSource source;
    std::uint64_t to_create;  ///< after the packet that it looks at
    bool waiting = false;     ///< it looks at a packet; the packet need not have been created yet
    bool mine = false;        ///< the packet takes the way of this queue
    Topology::Route route{};
    std::size_t exit = 0;
    Cycle ready = 0, free = 0;  ///< not injected before
    Cycle due = kNever;         ///< when it has something to do, if nothing is in its way
  };

  /// Keeps a reference to the topology. `packets`: how many it takes from the source. `ways`: ways out.
  SourceQueues(ResourceId id, const Topology& topology, const TrafficNodeSettings& settings, TrafficSource source,
               std::uint64_t packets, TrafficWindow window, std::size_t ways);

  const std::vector<Queue>& all() const { return queues_; }
  /// The first of the queues' due.
  Cycle due() const { return due_; }
  /// Calls `inject(queue)` for each queue whose packet is due. It may inject the packet, and then calls injected().
  template <class Inject>
  void for_each_due(Cycle now, const Inject& inject) {
    due_ = kNever;
    for (Queue& queue : queues_) {
      while (!queue.mine && queue.due <= now) create(queue);
      if (queue.due <= now) inject(queue);
      due_ = std::min(due_, queue.due);
    }
  }
  /// The first packet of the queue has begun to leave.
  void injected(Queue& queue, Cycle now) {
    queue.free = now + flits_;
    create(queue);
  }

  /// Packets that one queue has not injected, of the queue that has the most.
  std::uint64_t left() const;
  std::uint64_t offered() const { return offered_; }  ///< created within the window
  /// Routers that the packets offered had to visit, first and last included.
  std::uint64_t routers() const { return routers_; }

 private:
  void create(Queue& queue);
  void look_at_next(Queue& queue);

  const Topology& topology_;
  ResourceId id_;
  std::size_t ways_;
  std::uint16_t flits_;
  Cycle inject_cycles_, window_begin_;
  std::vector<Queue> queues_;  // the last of several is for packets that stay here
  Cycle due_ = kNever;
  std::uint64_t offered_ = 0, routers_ = 0;
};

}  // namespace carousel::ringbus::cycle
