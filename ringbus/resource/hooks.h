#pragma once

#include "ringbus/packets/events.h"
#include "ringbus/resource/visit/memory_blocks.h"
#include "ringbus/resource/visit/subtree_tracer.h"
#include "ringbus/resource/visit/transform_account.h"

namespace carousel::ringbus {

/// An engine's own parts that a resource calls. Nothing is owned, and each pointer may be null.
struct ResourceHooks {
  EventSink* events = nullptr;              ///< is told of everything that happens
  SubtreeTracer* subtree_tracer = nullptr;  ///< traces treelets
  TransformAccount* transforms = nullptr;   ///< counts transforms instead of the kernels
  const MemoryBlocks* blocks = nullptr;     ///< key collections, with `collections.key: block`
  bool spills_take_time = false;            ///< the engine empties CollectionStore::spills()
  bool hold_any_hit_rays = false;  ///< a ray that makes an any-hit call waits for release() before it may complete
};

}  // namespace carousel::ringbus
