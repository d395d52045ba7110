#include "ringbus/stress/queue_under_test.h"

#include "core/config/fields/queue_kind.h"
#include "core/types/enum_names.h"
#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus::stress {

QueueUnderTest built_in_queue(QueueKind kind) {
  return with_queue_type(
      kind, [&](auto type) { return queue_under_test<decltype(type)::template Of>(std::string(enum_name(kind))); });
}

}  // namespace carousel::ringbus::stress
