#pragma once

#include "core/config/fields/queue_kind.h"
#include "core/system/error.h"
#include "ringbus/queues/atomic_queue_adapter.h"
#include "ringbus/queues/boost_spsc_queue.h"
#include "ringbus/queues/moodycamel_queue.h"
#include "ringbus/queues/mpmc_ring.h"
#include "ringbus/queues/mutex_queue.h"
#include "ringbus/queues/spsc_ring.h"
#include "ringbus/queues/tbb_bounded_queue.h"

namespace carousel::ringbus {

template <template <class> class Queue>
struct QueueType {
  template <class T>
  using Of = Queue<T>;
};

/// Calls `body` with the QueueType that the configuration names: the one table of kinds.
template <class Body>
decltype(auto) with_queue_type(QueueKind kind, Body&& body) {
  switch (kind) {
    case QueueKind::kSpscRing:
      return body(QueueType<SpscRing>{});
    case QueueKind::kMpmcRing:
      return body(QueueType<MpmcRing>{});
    case QueueKind::kTbbBounded:
      return body(QueueType<TbbBoundedQueue>{});
    case QueueKind::kMoodycamel:
      return body(QueueType<MoodycamelQueue>{});
    case QueueKind::kAtomicQueue:
      return body(QueueType<AtomicQueue>{});
    case QueueKind::kBoostSpsc:
      return body(QueueType<BoostSpscQueue>{});
    case QueueKind::kMutex:
      return body(QueueType<MutexQueue>{});
  }
  throw SimulationError("no such queue kind");
}

}  // namespace carousel::ringbus
