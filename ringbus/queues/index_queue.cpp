#include "ringbus/queues/index_queue.h"

#include "core/types/added_names.h"
#include "ringbus/queues/queue_design.h"
#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus {

std::unique_ptr<IndexQueue> make_index_queue(QueueKind kind, std::size_t capacity) {
  if (const auto* own = added_body<QueueDesign>(kind)) return own->index(capacity);
  return with_queue_type(kind, [&](auto type) -> std::unique_ptr<IndexQueue> {
    return std::make_unique<IndexQueueOf<typename decltype(type)::template Of<std::uint32_t>>>(capacity);
  });
}

}  // namespace carousel::ringbus
