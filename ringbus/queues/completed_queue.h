#pragma once

#include "core/types/workload.h"
#include "ringbus/queues/pooled_queue.h"

namespace carousel::ringbus {

/// Brings completed rays from any resource to any shader worker, a batch of some hundred at a time. A resource that is
/// refused adds to its batch until there is a place.
using CompletedQueue = PooledQueue<HitBatch>;

}  // namespace carousel::ringbus
